"""Base-colour textures of a glTF file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import unquote

import numpy as np

from apd_viewer.files.formats.texture_images import image_beside, read_image, textured
from apd_viewer.files.gltf.accessors import array_of
from apd_viewer.files.gltf.containers import embedded
from apd_viewer.files.gltf.scene import one, whole

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.mesh.texture import Texture


class Piece(NamedTuple):
    """Triangles of one primitive, in the order of the mesh."""

    first: int  # vertex
    triangles: int
    part: dict[str, Any]


def texture_of(
    document: dict[str, Any], buffers: list[bytes], pieces: list[Piece], mesh: Mesh
) -> Texture | None:
    """Texture of all pieces of a mesh; None without one."""
    uv, uv_of, image_of, done = [np.empty((0, 2))], [], [], 0
    names: list[int] = []
    for piece in pieces:
        F = mesh.F[done : done + piece.triangles] - piece.first
        done += piece.triangles
        image, coordinates = _image_of(document, piece.part)
        own = _coordinates(document, buffers, coordinates) if coordinates is not None else None
        if image is None or own is None:
            uv_of.append(np.full(F.shape, -1))
            image_of.append(np.full(len(F), -1))
            continue
        if image not in names:
            names.append(image)
        uv_of.append(F + sum(map(len, uv)))
        image_of.append(np.full(len(F), names.index(image)))
        uv.append(own)
    if not names:
        return None
    images = [_image(document, buffers, k, mesh) for k in names]
    return textured(np.vstack(uv), np.vstack(uv_of), np.concatenate(image_of), images)


def _image_of(document: dict[str, Any], part: dict[str, Any]) -> tuple[int | None, int | None]:
    """Image of a primitive, and the accessor of its coordinates."""
    if "material" not in part:
        return None, None
    found = one(document, "materials", part["material"]).get("pbrMetallicRoughness", {})
    found = found.get("baseColorTexture") if isinstance(found, dict) else None
    if not isinstance(found, dict):
        return None, None
    source = one(document, "textures", found.get("index")).get("source")
    return source, part["attributes"].get(f"TEXCOORD_{whole(found, 'texCoord', 0)}")


def _coordinates(document: dict[str, Any], buffers: list[bytes], accessor: int) -> np.ndarray:
    """Texture coordinates (n, 2) of an accessor, upwards."""
    array = array_of(document, buffers, accessor, 2)
    uv = array / (np.iinfo(array.dtype).max if array.dtype.kind == "u" else 1.0)
    return np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])


def _image(document: dict[str, Any], buffers: list[bytes], k: int, mesh: Mesh) -> np.ndarray:
    """Image (h, w, 3) of the file, or of one beside it."""
    told = one(document, "images", k)
    name = str(told.get("name") or told.get("uri", ""))[:40] or f"{k + 1}"
    if "bufferView" in told:
        view = one(document, "bufferViews", told["bufferView"])
        start, length = whole(view, "byteOffset", 0), whole(view, "byteLength")
        one(document, "buffers", view.get("buffer"))
        return read_image(bytes(buffers[view["buffer"]][start : start + length]), name)
    uri = str(told.get("uri", ""))
    if uri.startswith("data:"):
        return read_image(embedded(uri), name)
    return image_beside(unquote(uri), mesh.path)
