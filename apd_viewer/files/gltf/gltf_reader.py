"""glTF reader: triangles of a scene, transformed by its nodes and instances.

Section 3.7 of the specification of glTF 2.0, and its extension EXT_mesh_gpu_instancing.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.files.formats.polygon_mesh import ParsedMesh
from apd_viewer.files.gltf import accessors, scene
from apd_viewer.files.gltf.gltf_file import GltfFile, VertexBlock, with_offset
from apd_viewer.files.gltf.primitive_textures import PrimitiveTriangles
from apd_viewer.files.gltf.weight_keys import keyed_documents
from apd_viewer.files.storage.regular_files import LARGEST_FILE, too_large_error
from apd_viewer.language import tr

MOST_VERTICES = LARGEST_FILE // 24  # 24 bytes per vertex: three doubles


def read_gltf(content: bytes, path: Path) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of the scene in a GLB or glTF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    text, document, buffers = _parsed(content, path)
    drawn, world = _full_scene(document, buffers), scene.world_matrices(document)
    file = GltfFile(content, path.suffix.lower(), text, document, buffers, drawn.blocks, drawn.pieces)
    remarks = [*_instance_remarks(drawn.blocks)]
    if scene.has_other_scenes(document, world):
        remarks.append(tr("The file has several scenes; only the default scene is read."))
    return ParsedMesh(np.vstack(drawn.V), np.vstack(drawn.F), file, tuple(remarks), "m")


def keyed_positions(content: bytes, path: Path) -> Iterator[np.ndarray]:
    """Positions (n, 3) at each key of the animation of morph weights, if there is one.

    Raises
    ------
    ValueError
        If the file cannot be understood.
    """
    _, document, buffers = _parsed(content, path)
    for each in keyed_documents(document, buffers):
        yield np.vstack(_full_scene(each, buffers).V)


def _parsed(content: bytes, path: Path) -> tuple[str, dict[str, Any], list[bytes]]:
    """Text, document and buffers of a file."""
    is_binary = path.suffix.lower() == ".glb"
    said, blob = scene.glb_chunks(content) if is_binary else (content, None)
    text, document = scene.parse_document(said)
    check_supported(document)
    return text, document, scene.read_buffers(document, blob, path)


def _full_scene(document: dict[str, Any], buffers: list[bytes]) -> _Scene:
    """Scene with all its mesh instances."""
    drawn = _Scene(document, buffers)
    for place in mesh_instances(document, buffers, scene.world_matrices(document)):
        drawn.add(place)
    return drawn


def _instance_remarks(blocks: list[VertexBlock]) -> Iterator[str]:
    most = max(Counter(block.position for block in blocks).values(), default=0)
    if most > 1:
        yield tr(
            "The file shows one mesh in {n:,} places; a shape in which they differ can only be exported to "
            "another format."
        ).format(n=most)


class _Scene:
    """Vertices and triangles of all mesh instances of a scene, concatenated."""

    def __init__(self, document: dict[str, Any], buffers: list[bytes]) -> None:
        self._document, self._buffers = document, buffers
        self.V, self.F = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
        self.blocks: list[VertexBlock] = []
        self.pieces: list[PrimitiveTriangles] = []
        self._count = 0

    def add(self, place: GltfInstance) -> None:
        """Append the triangles of a mesh instance in world coordinates."""
        blocks: dict[object, VertexBlock] = {}
        for part in scene.mesh_primitives(self._document, place.mesh):
            if (mode := part.get("mode", accessors.TRIANGLES)) not in (
                accessors.TRIANGLES,
                accessors.STRIP,
                accessors.FAN,
            ):
                continue
            block = self._block(place, part)
            shares = block.matrix is place.matrix and block.position_shift is None
            key = block.position if shares else json.dumps([part["attributes"], part.get("targets")])
            if key not in blocks:
                blocks[key] = block
                self._add_block(block)
            block = blocks[key]
            F = _outward_triangles(
                accessors.primitive_triangles(self._document, self._buffers, part, mode), block.matrix
            )
            self.F.append(F + block.first_vertex)
            self.pieces.append(PrimitiveTriangles(block.first_vertex, len(F), part))

    def _block(self, place: GltfInstance, primitive: dict[str, Any]) -> VertexBlock:
        """Vertex block of a primitive, following the vertices added so far."""
        given = self._document, self._buffers, primitive
        position, normal = (
            scene.whole_number(primitive["attributes"], "POSITION"),
            primitive["attributes"].get("NORMAL"),
        )
        entry = scene.document_entry(self._document, "accessors", position)
        packed = [name for name in COMPRESSED if extension_fields(primitive, name) is not None]
        if packed and "bufferView" not in entry:
            raise compressed_error(packed[0])
        if self._count + scene.whole_number(entry, "count") > MOST_VERTICES:
            raise too_large_error(tr("all its instances"))
        return VertexBlock(
            self._count,
            position,
            None if normal is None else scene.whole_number(primitive["attributes"], "NORMAL"),
            primitive["attributes"],
            place.vertex_matrices(*given),
            place.morph_displacement(*given, "POSITION"),
            None if normal is None else place.morph_displacement(*given, "NORMAL"),
        )

    def _add_block(self, block: VertexBlock) -> None:
        local = accessors.accessor_numbers(self._document, self._buffers, block.position)
        self.blocks.append(block)
        self.V.append(scene.transformed_positions(block.matrix, with_offset(local, block.position_shift)))
        self._count += len(local)


def _outward_triangles(F: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Triangles (t, 3), reversed where the matrix of their vertices mirrors them."""
    with np.errstate(all="ignore"):  # invalid positions are rejected later
        mirrors = np.linalg.det(matrix[..., :3, :3]) < 0.0
    if mirrors.ndim:
        mirrors = mirrors[F[:, 0]]
    return np.where(mirrors[..., None], F[:, [0, 2, 1]], F)


_ABSENT = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.ones(3)  # default translation, rotation and scale


class GltfInstance(NamedTuple):
    """Instance of a mesh at a node, with its matrix, joints and morph weights.

    Attributes
    ----------
    matrix : (4, 4) float array
        Matrix to world coordinates.
    joints : (j, 4, 4) float array or None
        Matrices of a skin, from the bind pose to world coordinates.
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
        """World matrix (4, 4) of a primitive's vertices, or (n, 4, 4) if skinned.

        With a skin, the matrix of the node itself has no effect.
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
        """Weighted sum (n, 3) of an attribute's morph targets; None if there are none."""
        total = None
        for target, weight in zip(scene.list_field(primitive, "targets"), self.weights, strict=False):
            if not isinstance(target, dict):
                raise ValueError(tr("a morph target has no attributes"))
            if weight and name in target:
                more = weight * accessors.accessor_numbers(document, buffers, target[name])
                if len(more) != scene.whole_number(
                    scene.document_entry(document, "accessors", primitive["attributes"].get(name)), "count"
                ):
                    raise ValueError(tr("a morph target has another number of vertices than its mesh"))
                total = more if total is None else total + more
        return total


def mesh_instances(
    document: dict[str, Any], buffers: list[Any], world: dict[int, np.ndarray]
) -> Iterator[GltfInstance]:
    """Mesh instances of a scene, ordered by mesh, node and instance."""
    shown = [
        (scene.whole_number(document["nodes"][k], "mesh"), k) for k in world if "mesh" in document["nodes"][k]
    ]
    for mesh, k in sorted(shown):
        node = document["nodes"][k]
        weights = _weights(node if "weights" in node else scene.document_entry(document, "meshes", mesh))
        joints = _joints(document, buffers, node["skin"], world) if "skin" in node else None
        instances = extension_fields(node, "EXT_mesh_gpu_instancing")
        if instances is None:
            yield GltfInstance(mesh, world[k], joints, weights)
            continue
        for each in _instances(document, buffers, instances):
            yield GltfInstance(mesh, world[k] @ each, joints, weights)


_LARGEST_WEIGHT = 1e100  # a longer integer would not fit a double


def _weights(entry: dict[str, Any]) -> list[float]:
    found = scene.list_field(entry, "weights")
    if not all(isinstance(weight, int | float) and abs(weight) <= _LARGEST_WEIGHT for weight in found):
        raise ValueError(tr("a weight of a morph target is not a number"))
    return found


def _instances(document: dict[str, Any], buffers: list[Any], entry: dict[str, Any]) -> Iterator[np.ndarray]:
    """Matrices (4, 4) of the instances of a node."""
    given = entry.get("attributes")
    names: dict[str, Any] = given if isinstance(given, dict) else {}
    columns = [
        accessors.accessor_numbers(document, buffers, names[name], width) if name in names else None
        for name, width in (("TRANSLATION", 3), ("ROTATION", 4), ("SCALE", 3))
    ]
    counts = {len(column) for column in columns if column is not None}
    if len(counts) != 1:
        raise ValueError(tr("the attributes of its instances are missing, or differ in number"))
    for k in range(counts.pop()):
        own = (usual if column is None else column[k] for column, usual in zip(columns, _ABSENT, strict=True))
        with np.errstate(all="ignore"):  # invalid positions are rejected later
            yield scene.trs_matrix(*own)


def _joints(
    document: dict[str, Any], buffers: list[Any], skin: object, world: dict[int, np.ndarray]
) -> np.ndarray:
    """Joint matrices (j, 4, 4) of a skin, from its bind pose to the world."""
    entry = scene.document_entry(document, "skins", skin)
    names = scene.list_field(entry, "joints")
    if not names or not all(isinstance(name, int) and name in world for name in names):
        raise ValueError(tr("a joint of its skin is not in the scene"))
    joints = np.array([world[name] for name in names])
    if "inverseBindMatrices" not in entry:
        return joints
    inverse = accessors.accessor_numbers(document, buffers, entry["inverseBindMatrices"], 16)
    if len(inverse) < len(joints):
        raise ValueError(tr("its skin has fewer matrices than joints"))
    with np.errstate(all="ignore"):  # invalid positions are rejected later
        return joints @ inverse[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)


def _influences(
    document: dict[str, Any], buffers: list[Any], attributes: dict[str, Any]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Joint indices (n,) and weights (n,) of all vertices, one influence at a time."""
    count, k = (
        scene.whole_number(scene.document_entry(document, "accessors", attributes.get("POSITION")), "count"),
        0,
    )
    while f"JOINTS_{k}" in attributes:
        J = accessors.accessor_array(document, buffers, attributes[f"JOINTS_{k}"], 4)
        W = accessors.accessor_numbers(document, buffers, attributes.get(f"WEIGHTS_{k}"), 4)
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
# Extensions that are read, or concern only appearance, lights and metadata.
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
_OF_MATERIALS = "KHR_materials_"  # prefix of extensions about appearance, all harmless


def check_supported(document: dict[str, Any]) -> None:
    """Raise ValueError on an unknown version or required extension."""
    asset = document.get("asset")
    told = asset if isinstance(asset, dict) else {}
    version = str(told.get("minVersion", told.get("version", "2.0")))
    if version.partition(".")[0] != "2" or ("minVersion" in told and version != "2.0"):
        raise ValueError(tr("it is version {version}; only version 2 is supported").format(version=version))
    for name in map(str, scene.list_field(document, "extensionsRequired")):
        if name in COMPRESSED:
            raise compressed_error(name)
        if name not in _READ | _HARMLESS and not name.startswith(_OF_MATERIALS):
            raise ValueError(tr("it requires {extension}, which is not supported").format(extension=name))


def compressed_error(extension: str) -> ValueError:
    """Error for geometry compressed by an extension."""
    return ValueError(
        tr("it is compressed ({extension}), which is not supported").format(extension=extension)
    )


def extension_fields(entry: dict[str, Any], name: str) -> dict[str, Any] | None:
    """Fields of an entry's extension; None without it."""
    extensions = entry.get("extensions")
    found = extensions.get(name) if isinstance(extensions, dict) else None
    return found if isinstance(found, dict) else None
