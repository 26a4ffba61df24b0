"""Reading and writing of glTF accessors."""

from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.gltf.scene import document_entry, whole_number
from apd_viewer.files.storage.regular_files import LARGEST_FILE, too_large_error
from apd_viewer.language import tr

TRIANGLES, STRIP, FAN = 4, 5, 6  # primitive modes of glTF
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_PARTS = "indices", "values"  # keys of a sparse accessor
_NAMES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def accessor_numbers(
    document: dict[str, Any], buffers: list[Any], accessor: object, width: int = 3
) -> np.ndarray:
    """Numbers (n, width) of an accessor as doubles, normalized integers scaled."""
    array = accessor_array(document, buffers, accessor, width)
    if document_entry(document, "accessors", accessor).get("normalized") and array.dtype.kind in "iu":
        return np.maximum(array / np.iinfo(array.dtype).max, -1.0)
    with np.errstate(invalid="ignore"):  # NaN coordinates are rejected later
        return array.astype(np.float64)


def accessor_colors(document: dict[str, Any], buffers: list[Any], accessor: object) -> np.ndarray:
    """Linear colours (n, 3) of an accessor, from 0 to 1."""
    width = 4 if document_entry(document, "accessors", accessor).get("type") == "VEC4" else 3
    array = accessor_array(document, buffers, accessor, width)[:, :3]
    return array / (np.iinfo(array.dtype).max if array.dtype.kind == "u" else 1.0)


def accessor_array(document: dict[str, Any], buffers: list[Any], accessor: object, width: int) -> np.ndarray:
    """Numbers (count, width) of an accessor: a buffer view, or a copy if sparse."""
    entry = document_entry(document, "accessors", accessor)
    kind, count = _kind(entry), whole_number(entry, "count")
    if entry.get("type") != _NAMES[width]:
        raise ValueError(tr("an accessor has the wrong type"))
    if "bufferView" in entry:
        array = _buffer_numbers(document, buffers, entry, count, width)
    elif count * width * kind.itemsize > LARGEST_FILE:
        raise too_large_error(tr("its sparse accessors"))
    else:
        array = np.zeros((count, width), kind)
    if "sparse" in entry:
        rows, values = _sparse_rows_and_values(document, buffers, entry, width)
        array = array.copy()
        array[rows] = values
    return array


def write_rows(
    document: dict[str, Any], buffers: list[Any], accessor: object, rows: np.ndarray, new: np.ndarray
) -> None:
    """Write the rows of ``new`` (n, 3) selected by the mask ``rows`` (n,).

    Raises
    ------
    InputError
        If one of them is not stored: zero by default.
    """
    entry, rows = document_entry(document, "accessors", accessor), rows.copy()
    if "sparse" in entry:
        those, values = _sparse_rows_and_values(document, buffers, entry, new.shape[1])
        values[rows[those]] = new[those][rows[those]]
        rows[those] = False
    if not rows.any():
        return
    if "bufferView" not in entry:
        raise InputError(tr("The file stores only some of its positions; choose another format."))
    _buffer_numbers(document, buffers, entry, len(new), new.shape[1])[rows] = new[rows]


def _kind(entry: dict[str, Any]) -> np.dtype[Any]:
    code = whole_number(entry, "componentType")
    if code not in _TYPES:
        raise ValueError(tr("an accessor has the wrong type"))
    return np.dtype(_TYPES[code])


def _sparse_rows_and_values(
    document: dict[str, Any], buffers: list[Any], entry: dict[str, Any], width: int
) -> tuple[np.ndarray, np.ndarray]:
    """Sparse row indices (k,) of an accessor, and their buffer values (k, width)."""
    sparse = entry["sparse"]
    if not isinstance(sparse, dict) or not all(isinstance(sparse.get(part), dict) for part in _PARTS):
        raise ValueError(tr("a sparse accessor has no indices or no values"))
    indices, values = (sparse[part] for part in _PARTS)
    count = whole_number(sparse, "count")
    rows = _buffer_numbers(document, buffers, indices, count, 1)[:, 0]
    if rows.dtype.kind != "u":
        raise ValueError(tr("an accessor has the wrong type"))
    if count and rows.max() >= whole_number(entry, "count"):
        raise ValueError(
            tr("a sparse accessor refers to row {row:,} of {count:,}").format(
                row=int(rows.max()), count=entry["count"]
            )
        )
    values = {**values, "componentType": entry["componentType"]}
    return rows, _buffer_numbers(document, buffers, values, count, width)


def _buffer_numbers(
    document: dict[str, Any], buffers: list[Any], entry: dict[str, Any], count: int, width: int
) -> np.ndarray:
    """View (count, width) of buffer numbers, with type and offset from ``entry``."""
    kind, view = _kind(entry), document_entry(document, "bufferViews", entry.get("bufferView"))
    document_entry(document, "buffers", view.get("buffer"))
    buffer = buffers[view["buffer"]]
    start = whole_number(view, "byteOffset", 0) + whole_number(entry, "byteOffset", 0)
    row = kind.itemsize * width
    stride = whole_number(view, "byteStride", 0) or row
    if stride < row or start + stride * max(count - 1, 0) + row * min(count, 1) > len(buffer):
        raise ValueError(tr("it ends within an accessor"))
    return np.ndarray((count, width), kind, buffer, start, (stride, kind.itemsize))


def primitive_triangles(
    document: dict[str, Any], buffers: list[Any], primitive: dict[str, Any], mode: int
) -> np.ndarray:
    """Triangles (t, 3) of a primitive: a list, a strip or a fan."""
    count = whole_number(document_entry(document, "accessors", primitive["attributes"]["POSITION"]), "count")
    corners = np.arange(count)
    if "indices" in primitive:
        indices = accessor_array(document, buffers, primitive["indices"], 1)
        if indices.dtype.kind != "u":
            raise ValueError(tr("its triangles have the wrong type"))
        corners = indices[:, 0].astype(np.int64)
        if len(corners) and corners.max() >= count:
            raise ValueError(
                tr("a triangle refers to vertex {vertex:,} of {count:,}").format(
                    vertex=corners.max(), count=count
                )
            )
    if mode == TRIANGLES:
        if len(corners) % 3:
            raise ValueError(tr("a triangle is incomplete"))
        return corners.reshape(-1, 3)
    k = np.arange(max(len(corners) - 2, 0))
    if mode == FAN:
        return corners[np.column_stack([np.zeros_like(k), k + 1, k + 2])].reshape(-1, 3)
    odd = k % 2
    return corners[np.column_stack([k, k + 1 + odd, k + 2 - odd])].reshape(-1, 3)
