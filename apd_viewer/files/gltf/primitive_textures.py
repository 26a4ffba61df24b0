"""Base-colour textures of a glTF file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import unquote

import numpy as np

from apd_viewer.files.formats.texture_images import joined_texture, read_image, sibling_image
from apd_viewer.files.gltf.accessors import accessor_array
from apd_viewer.files.gltf.scene import data_uri_content, document_entry, whole_number

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.mesh.texture import Texture


class PrimitiveTriangles(NamedTuple):
    """Triangles of one primitive, in the order of the mesh."""

    first_vertex: int  # offset of its vertices in the mesh
    triangle_count: int
    primitive: dict[str, Any]


def primitive_texture(
    document: dict[str, Any], buffers: list[bytes], primitives: list[PrimitiveTriangles], mesh: Mesh
) -> Texture | None:
    """Texture combined from those of all primitives; None if there are no images."""
    uv, uv_of, image_of, done = [np.empty((0, 2))], [], [], 0
    names: list[int] = []
    for piece in primitives:
        F = mesh.F[done : done + piece.triangle_count] - piece.first_vertex
        done += piece.triangle_count
        image, coordinates = _image_of(document, piece.primitive)
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
    return joined_texture(np.vstack(uv), np.vstack(uv_of), np.concatenate(image_of), images)


def _image_of(document: dict[str, Any], primitive: dict[str, Any]) -> tuple[int | None, int | None]:
    """Image index of a primitive, and the accessor of its texture coordinates."""
    if "material" not in primitive:
        return None, None
    found = document_entry(document, "materials", primitive["material"]).get("pbrMetallicRoughness", {})
    found = found.get("baseColorTexture") if isinstance(found, dict) else None
    if not isinstance(found, dict):
        return None, None
    source = document_entry(document, "textures", found.get("index")).get("source")
    return source, primitive["attributes"].get(f"TEXCOORD_{whole_number(found, 'texCoord', 0)}")


def _coordinates(document: dict[str, Any], buffers: list[bytes], accessor: int) -> np.ndarray:
    """Texture coordinates (n, 2) of an accessor, with v pointing up."""
    array = accessor_array(document, buffers, accessor, 2)
    uv = array / (np.iinfo(array.dtype).max if array.dtype.kind == "u" else 1.0)
    return np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])


def _image(document: dict[str, Any], buffers: list[bytes], k: int, mesh: Mesh) -> np.ndarray:
    """Image (h, w, 3) embedded in the file, or from a file beside it."""
    entry = document_entry(document, "images", k)
    name = str(entry.get("name") or entry.get("uri", ""))[:40] or f"{k + 1}"
    if "bufferView" in entry:
        view = document_entry(document, "bufferViews", entry["bufferView"])
        start, length = whole_number(view, "byteOffset", 0), whole_number(view, "byteLength")
        document_entry(document, "buffers", view.get("buffer"))
        return read_image(bytes(buffers[view["buffer"]][start : start + length]), name)
    uri = str(entry.get("uri", ""))
    if uri.startswith("data:"):
        return read_image(data_uri_content(uri), name)
    return sibling_image(unquote(uri), mesh.path)
