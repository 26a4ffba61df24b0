"""Places and poses of glTF meshes: nodes, instances, morph targets and skins.

Section 3.7 of the specification of glTF 2.0, and its extension EXT_mesh_gpu_instancing.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.files.gltf.accessors import accessor_array, accessor_numbers
from apd_viewer.files.gltf.scene import document_entry, list_field, trs_matrix, whole_number
from apd_viewer.language import tr

_ABSENT = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.ones(3)  # translation, rotation and scale


class MeshInstance(NamedTuple):
    """A mesh at the place and in the pose of a node.

    Attributes
    ----------
    mesh : int
    matrix : (4, 4) float array
        To the world.
    joints : (j, 4, 4) float array or None
        Of a skin: from the pose in which it was bound to the world.
    weights : list of float
        Of the morph targets; the default ones.
    """

    mesh: int
    matrix: np.ndarray
    joints: np.ndarray | None
    weights: list[float]

    def vertex_matrices(
        self, document: dict[str, Any], buffers: list[Any], primitive: dict[str, Any]
    ) -> np.ndarray:
        """Matrix (4, 4) of the vertices of a primitive, or one each (n, 4, 4) in a skin.

        In a skin the matrix of the node itself does not count.
        """
        if self.joints is None or "JOINTS_0" not in primitive["attributes"]:
            return self.matrix
        total, weight = np.zeros(()), np.zeros(())
        for J, W in _influences(document, buffers, primitive["attributes"]):
            if J.max(initial=0) >= len(self.joints):
                raise ValueError(tr("a vertex refers to a joint that is missing from its skin"))
            total = total + np.einsum("n,nij->nij", W, self.joints[J])
            weight = weight + W
        return np.divide(
            total,
            weight[:, None, None],
            out=np.broadcast_to(self.matrix, total.shape).copy(),
            where=weight[:, None, None] > 0.0,
        )

    def morph_displacement(
        self, document: dict[str, Any], buffers: list[Any], primitive: dict[str, Any], name: str
    ) -> np.ndarray | None:
        """Sum (n, 3) of the weighted morph targets of an attribute, if there is any."""
        total = None
        for target, weight in zip(list_field(primitive, "targets"), self.weights, strict=False):
            if not isinstance(target, dict):
                raise ValueError(tr("a morph target has no attributes"))
            if weight and name in target:
                more = weight * accessor_numbers(document, buffers, target[name])
                if len(more) != whole_number(
                    document_entry(document, "accessors", primitive["attributes"].get(name)), "count"
                ):
                    raise ValueError(tr("a morph target has another number of vertices than its mesh"))
                total = more if total is None else total + more
        return total


def mesh_instances(
    document: dict[str, Any], buffers: list[Any], world: dict[int, np.ndarray]
) -> Iterator[MeshInstance]:
    """Meshes of a scene in the order of meshes, nodes and instances."""
    shown = [(whole_number(document["nodes"][k], "mesh"), k) for k in world if "mesh" in document["nodes"][k]]
    for mesh, k in sorted(shown):
        node = document["nodes"][k]
        weights = _weights(node if "weights" in node else document_entry(document, "meshes", mesh))
        joints = _joints(document, buffers, node["skin"], world) if "skin" in node else None
        instances = extension_fields(node, "EXT_mesh_gpu_instancing")
        if instances is None:
            yield MeshInstance(mesh, world[k], joints, weights)
            continue
        for each in _instances(document, buffers, instances):
            yield MeshInstance(mesh, world[k] @ each, joints, weights)


def _weights(entry: dict[str, Any]) -> list[float]:
    found = list_field(entry, "weights")
    if not all(isinstance(weight, int | float) for weight in found):
        raise ValueError(tr("a weight of a morph target is not a number"))
    return found


def _instances(document: dict[str, Any], buffers: list[Any], entry: dict[str, Any]) -> Iterator[np.ndarray]:
    """Matrices (4, 4) of the instances of a node."""
    given = entry.get("attributes")
    names: dict[str, Any] = given if isinstance(given, dict) else {}
    columns = [
        accessor_numbers(document, buffers, names[name], width) if name in names else None
        for name, width in (("TRANSLATION", 3), ("ROTATION", 4), ("SCALE", 3))
    ]
    counts = {len(column) for column in columns if column is not None}
    if len(counts) != 1:
        raise ValueError(tr("the attributes of its instances are missing, or differ in number"))
    for k in range(counts.pop()):
        own = (usual if column is None else column[k] for column, usual in zip(columns, _ABSENT, strict=True))
        with np.errstate(all="ignore"):  # absurd positions are refused later
            yield trs_matrix(*own)


def _joints(
    document: dict[str, Any], buffers: list[Any], skin: object, world: dict[int, np.ndarray]
) -> np.ndarray:
    """Matrices (j, 4, 4) of the joints of a skin, from the pose of its binding."""
    told = document_entry(document, "skins", skin)
    names = list_field(told, "joints")
    if not names or not all(isinstance(name, int) and name in world for name in names):
        raise ValueError(tr("a joint of its skin is not in the scene"))
    joints = np.array([world[name] for name in names])
    if "inverseBindMatrices" not in told:
        return joints
    inverse = accessor_numbers(document, buffers, told["inverseBindMatrices"], 16)
    if len(inverse) < len(joints):
        raise ValueError(tr("its skin has fewer matrices than joints"))
    with np.errstate(all="ignore"):  # absurd positions are refused later
        return joints @ inverse[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)


def _influences(
    document: dict[str, Any], buffers: list[Any], attributes: dict[str, Any]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Joints (n,) and weights (n,), those of the vertices one after another."""
    count, k = whole_number(document_entry(document, "accessors", attributes.get("POSITION")), "count"), 0
    while f"JOINTS_{k}" in attributes:
        J = accessor_array(document, buffers, attributes[f"JOINTS_{k}"], 4)
        W = accessor_numbers(document, buffers, attributes.get(f"WEIGHTS_{k}"), 4)
        if not len(J) == len(W) == count or J.dtype.kind != "u":
            raise ValueError(tr("the joints of its vertices are damaged"))
        yield from zip(J.T, W.T, strict=True)
        k += 1


COMPRESSED = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MESHOPT_compression",
)
# Read, or about looks, light and data beside the geometry.
_READ = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing"}
_HARMLESS = {
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_instance_features",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_lights_punctual",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_techniques_webgl",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
}
_OF_MATERIALS = "KHR_materials_"  # all extensions of this name are


def check_supported(document: dict[str, Any]) -> None:
    """Raise ValueError on an unknown version or required extension."""
    asset = document.get("asset")
    told = asset if isinstance(asset, dict) else {}
    version = str(told.get("minVersion", told.get("version", "2.0")))
    if version.partition(".")[0] != "2" or ("minVersion" in told and version != "2.0"):
        raise ValueError(tr("it is version {version}; only version 2 is supported").format(version=version))
    for name in map(str, list_field(document, "extensionsRequired")):
        if name in COMPRESSED:
            raise compressed_error(name)
        if name not in _READ | _HARMLESS and not name.startswith(_OF_MATERIALS):
            raise ValueError(tr("it requires {extension}, which is not supported").format(extension=name))


def compressed_error(extension: str) -> ValueError:
    """Error for geometry packed by an extension."""
    return ValueError(
        tr("it is compressed ({extension}), which is not supported").format(extension=extension)
    )


def extension_fields(entry: dict[str, Any], name: str) -> dict[str, Any] | None:
    """Fields of an entry in an extension; None without any."""
    extensions = entry.get("extensions")
    found = extensions.get(name) if isinstance(extensions, dict) else None
    return found if isinstance(found, dict) else None
