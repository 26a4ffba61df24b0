"""Arrays of a glTF file: chunks, buffers and accessors."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from apd_viewer.files.formats.gltf_scene import a_list, one, whole
from apd_viewer.files.storage.neighbours import LARGEST, content_beside, too_large
from apd_viewer.language import tr

TRIANGLES, STRIP, FAN = 4, 5, 6  # the modes of a primitive
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


_NAMES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


def document_of(said: bytes) -> tuple[str, dict[str, Any]]:
    """JSON as text, and its content."""
    try:
        text = said.decode("utf-8-sig")
        document = json.loads(text)
    except UnicodeDecodeError as error:
        raise ValueError(tr("its text is damaged at byte {at:,}").format(at=error.start)) from None
    except json.JSONDecodeError as error:
        raise ValueError(
            tr("its JSON is damaged at line {line:,}, column {column:,}").format(
                line=error.lineno, column=error.colno
            )
        ) from None
    except ValueError:  # numbers of thousands of digits
        raise ValueError(tr("its JSON has a number out of range")) from None
    except RecursionError:
        raise ValueError(tr("its JSON is nested too deeply")) from None
    if not isinstance(document, dict):
        raise ValueError(tr("its JSON is not a glTF document"))
    return text, document


def chunks_of(content: bytes) -> tuple[bytes, bytes | None]:
    """JSON and binary chunk of a GLB file."""
    if len(content) < 20:
        raise ValueError(tr("it ends too early"))
    magic, version, _, length, kind = struct.unpack_from("<4sIII4s", content)
    if magic != b"glTF" or kind != b"JSON":
        raise ValueError(tr("it does not start with a GLB header"))
    if version != 2:
        raise ValueError(tr("it is version {version}; only version 2 is supported").format(version=version))
    begin = 20 + length
    if begin > len(content):
        raise ValueError(tr("it ends too early"))
    if begin + 8 > len(content):
        return content[20:begin], None
    (size,) = struct.unpack_from("<I", content, begin)
    return content[20:begin], content[begin + 8 : begin + 8 + size]


def buffers_of(document: dict[str, Any], blob: bytes | None, path: Path) -> list[bytes]:
    """Bytes of all buffers; of those outside the file no more than it may hold."""
    found: list[bytes] = []
    for k in range(len(a_list(document, "buffers"))):
        told = one(document, "buffers", k)
        found.append(_buffer_of(told, None if k else blob, path))
        if "uri" in told and sum(map(len, found)) > LARGEST:
            raise too_large(tr("all its buffers"))
        if len(found[-1]) < whole(told, "byteLength", 0):
            raise ValueError(
                tr("a buffer declares {told:,} bytes, but there are {there:,}").format(
                    told=told["byteLength"], there=len(found[-1])
                )
            )
    return found


def embedded(uri: str) -> bytes:
    """Content of a data URI; raises InputError if too large, ValueError if damaged."""
    data = uri.partition(",")[2]
    if len(data) // 4 * 3 > LARGEST:
        raise too_large(uri[:20])
    try:
        return base64.b64decode(data)
    except ValueError:
        raise ValueError(tr("its embedded coordinates are damaged")) from None


def _buffer_of(told: dict[str, Any], blob: bytes | None, path: Path) -> bytes:
    """Bytes of a buffer: the binary chunk, a data URI or a file beside."""
    uri = told.get("uri")
    if uri is None:
        if blob is None:
            raise ValueError(tr("its binary chunk is missing"))
        return blob
    if not isinstance(uri, str):
        raise ValueError(tr("the location of its coordinates is missing"))
    if uri.startswith("data:"):
        return embedded(uri)
    content = content_beside(unquote(uri), path, whole(told, "byteLength") if "byteLength" in told else None)
    if content is None:
        raise ValueError(tr("the file {uri} is missing from its folder").format(uri=uri))
    return content


def positions_of(document: dict[str, Any], buffers: list[Any], accessor: object) -> np.ndarray:
    """The positions (n, 3) of an accessor as they are meant, as doubles."""
    array = array_of(document, buffers, accessor, 3)
    if one(document, "accessors", accessor).get("normalized") and array.dtype.kind in "iu":
        return np.maximum(array / np.iinfo(array.dtype).max, -1.0)
    with np.errstate(invalid="ignore"):  # NaN is refused later
        return array.astype(np.float64)


def colors_of(document: dict[str, Any], buffers: list[Any], accessor: object) -> np.ndarray:
    """Linear colours (n, 3) of an accessor, from 0 to 1."""
    width = 4 if one(document, "accessors", accessor).get("type") == "VEC4" else 3
    array = array_of(document, buffers, accessor, width)[:, :3]
    return array / (np.iinfo(array.dtype).max if array.dtype.kind == "u" else 1.0)


def array_of(document: dict[str, Any], buffers: list[Any], accessor: object, width: int) -> np.ndarray:
    """The numbers of an accessor, (count, width): they lie in the buffer."""
    told = one(document, "accessors", accessor)
    if "sparse" in told or "bufferView" not in told:
        raise ValueError(tr("it has sparse accessors, which are not supported"))
    view = one(document, "bufferViews", told["bufferView"])
    code = whole(told, "componentType")
    if code not in _TYPES or told.get("type") != _NAMES[width]:
        raise ValueError(tr("an accessor has the wrong type"))
    one(document, "buffers", view.get("buffer"))
    kind, count, buffer = np.dtype(_TYPES[code]), whole(told, "count"), buffers[view["buffer"]]
    start = whole(view, "byteOffset", 0) + whole(told, "byteOffset", 0)
    row = kind.itemsize * width
    stride = whole(view, "byteStride", 0) or row
    if stride < row or start + stride * max(count - 1, 0) + row * min(count, 1) > len(buffer):
        raise ValueError(tr("it ends within an accessor"))
    return np.ndarray((count, width), kind, buffer, start, (stride, kind.itemsize))


def triangles_of(document: dict[str, Any], buffers: list[Any], part: dict[str, Any], mode: int) -> np.ndarray:
    """Triangles (t, 3) of a primitive: a list, a strip or a fan."""
    count = whole(one(document, "accessors", part["attributes"]["POSITION"]), "count")
    corners = np.arange(count)
    if "indices" in part:
        indices = array_of(document, buffers, part["indices"], 1)
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
