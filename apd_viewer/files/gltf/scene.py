"""glTF documents: containers, validated lookups and node matrices.

All access to the document is validated against the format, with an error naming the problem.
"""

import base64
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import LARGEST_FILE, sibling_content, too_large_error
from apd_viewer.language import tr

_MOST = 1 << 40  # largest accepted count of bytes or elements


def document_entry(document: dict[str, Any], key: str, k: object) -> dict[str, Any]:
    """Element ``k`` of an array of the document; raises ValueError if missing."""
    things = list_field(document, key)
    if type(k) is not int or not 0 <= k < len(things) or not isinstance(things[k], dict):
        raise ValueError(tr("it refers to an entry that is missing from its {what}").format(what=key))
    return things[k]


def list_field(entry: dict[str, Any], key: str) -> list[Any]:
    """List under a key; raises ValueError if the value is not a list."""
    found = entry.get(key, [])
    if not isinstance(found, list):
        raise ValueError(tr("its {key} are not a list").format(key=key))
    return found


def whole_number(entry: dict[str, Any], key: str, default: int | None = None) -> int:
    """Non-negative integer field; raises ValueError if missing or out of range."""
    number = entry.get(key, default)
    if isinstance(number, float) and number.is_integer():
        number = int(number)
    if type(number) is not int or not 0 <= number <= _MOST:
        raise ValueError(tr("a {key} in it is missing or out of range").format(key=key))
    return number


def mesh_primitives(document: dict[str, Any], mesh: int) -> list[dict[str, Any]]:
    """Primitives of a mesh; raises ValueError if one has no attributes."""
    found = list_field(document_entry(document, "meshes", mesh), "primitives")
    if not all(isinstance(part, dict) and isinstance(part.get("attributes"), dict) for part in found):
        raise ValueError(tr("a mesh primitive has no attributes"))
    return found


def world_matrices(document: dict[str, Any]) -> dict[int, np.ndarray]:
    """World matrices (4, 4) of all nodes of the scene."""
    return _world_matrices(document, _roots(document, document.get("scene", 0)))


def has_other_scenes(document: dict[str, Any], world: dict[int, np.ndarray]) -> bool:
    """True if another scene shows a mesh at a node not in ``world``."""
    others = (
        _world_matrices(document, _roots(document, k)) for k in range(len(list_field(document, "scenes")))
    )
    return any("mesh" in document["nodes"][node] for other in others for node in other if node not in world)


def _world_matrices(document: dict[str, Any], roots: list[Any]) -> dict[int, np.ndarray]:
    """World matrices (4, 4) of the root nodes and all their descendants."""
    found: dict[int, np.ndarray] = {}
    todo = [(root, np.eye(4)) for root in reversed(roots)]
    while todo:
        k, above = todo.pop()
        node = document_entry(document, "nodes", k)
        if k in found:
            raise ValueError(tr("its nodes do not form a tree"))
        with np.errstate(all="ignore"):  # invalid positions are rejected later
            found[k] = above @ _matrix(node)
        todo += [(child, found[k]) for child in reversed(list_field(node, "children"))]
    return found


def _roots(document: dict[str, Any], scene: object) -> list[Any]:
    if document.get("scenes"):
        return list_field(document_entry(document, "scenes", scene), "nodes")
    count = len(list_field(document, "nodes"))
    below = [list_field(document_entry(document, "nodes", k), "children") for k in range(count)]
    children = {child for some in below for child in some if isinstance(child, int)}
    return [k for k in range(count) if k not in children]


def _matrix(node: dict[str, Any]) -> np.ndarray:
    """Matrix (4, 4) from a node to its parent."""
    if "matrix" in node:
        return _numbers(node, "matrix", np.eye(4).ravel()).reshape(4, 4).T
    return trs_matrix(
        _numbers(node, "translation", [0, 0, 0]),
        _numbers(node, "rotation", [0, 0, 0, 1]),
        _numbers(node, "scale", [1, 1, 1]),
    )


def trs_matrix(translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Matrix (4, 4) of translation (3,), quaternion (x, y, z, w) and scale (3,)."""
    M = np.eye(4)
    x, y, z, w = rotation
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    M[:3, :3] = R * scale
    M[:3, 3] = translation
    return M


def _numbers(node: dict[str, Any], key: str, default: Any) -> np.ndarray:
    given = node.get(key, default)
    if given is not default:
        if not isinstance(given, list) or len(given) != len(default):
            raise ValueError(
                tr("the {key} of a node does not have {n} numbers").format(key=key, n=len(default))
            )
        if not all(isinstance(number, int | float) and abs(number) < 1e100 for number in given):
            raise ValueError(tr("the {key} of a node contains something other than numbers").format(key=key))
    return np.array(given, dtype=np.float64)


def transformed_positions(matrix: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Positions (n, 3) transformed by one matrix (4, 4), or each by its own (n, 4, 4)."""
    with np.errstate(all="ignore"):  # invalid positions are rejected later
        return matrix_products(matrix[..., :3, :3], local) + matrix[..., :3, 3]


def matrix_products(A: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Rows of ``X`` (n, 3) multiplied by one matrix, or by one each (n, 3, 3)."""
    return X @ A.T if A.ndim == 2 else np.einsum("nij,nj->ni", A, X)


def parse_document(json_content: bytes) -> tuple[str, dict[str, Any]]:
    """Decoded JSON text, and the parsed document."""
    try:
        text = json_content.decode("utf-8-sig")
        document = json.loads(text)
    except UnicodeDecodeError as error:
        raise ValueError(tr("its text is damaged at byte {at:,}").format(at=error.start)) from None
    except json.JSONDecodeError as error:
        raise ValueError(
            tr("its JSON is damaged at line {line:,}, column {column:,}").format(
                line=error.lineno, column=error.colno
            )
        ) from None
    except ValueError:  # raised for integers of thousands of digits
        raise ValueError(tr("its JSON has a number out of range")) from None
    except RecursionError:
        raise ValueError(tr("its JSON is nested too deeply")) from None
    if not isinstance(document, dict):
        raise ValueError(tr("its JSON is not a glTF document"))
    return text, document


def glb_chunks(content: bytes) -> tuple[bytes, bytes | None]:
    """JSON and binary chunk of a GLB file."""
    if len(content) < 20:
        raise ValueError(tr("it ends too early"))
    magic, version, _, length, kind = struct.unpack_from("<4sIII4s", content)
    if magic == b"glTF" and version != 2:
        raise ValueError(tr("it is version {version}; only version 2 is supported").format(version=version))
    if magic != b"glTF" or kind != b"JSON":
        raise ValueError(tr("it does not start with a GLB header"))
    begin = 20 + length
    if begin > len(content):
        raise ValueError(tr("it ends too early"))
    if begin + 8 > len(content):
        return content[20:begin], None
    (size,) = struct.unpack_from("<I", content, begin)
    return content[20:begin], content[begin + 8 : begin + 8 + size]


def read_buffers(document: dict[str, Any], blob: bytes | None, path: Path) -> list[bytes]:
    """Bytes of all buffers, with a size limit on external ones."""
    found: list[bytes] = []
    for k in range(len(list_field(document, "buffers"))):
        entry = document_entry(document, "buffers", k)
        found.append(_buffer_of(entry, None if k else blob, path))
        if "uri" in entry and sum(map(len, found)) > LARGEST_FILE:
            raise too_large_error(tr("all its buffers"))
        if len(found[-1]) < whole_number(entry, "byteLength", 0):
            raise ValueError(
                tr("a buffer declares {told:,} bytes, but there are {there:,}").format(
                    told=entry["byteLength"], there=len(found[-1])
                )
            )
    return found


def data_uri_content(uri: str) -> bytes:
    """Content of a data URI; raises InputError if too large, ValueError if damaged."""
    data = uri.partition(",")[2]
    if len(data) // 4 * 3 > LARGEST_FILE:
        raise too_large_error(uri[:20])
    try:
        return base64.b64decode(data)
    except ValueError:
        raise ValueError(tr("its embedded coordinates are damaged")) from None


def data_uri(old_uri: str, buffer: bytearray) -> str:
    """Data URI of a buffer, with the media type of ``old_uri``; InputError for a file."""
    if not old_uri.startswith("data:"):
        raise InputError(
            tr("The coordinates are in a separate file, {uri}; pack both into a GLB first.").format(
                uri=old_uri
            )
        )
    return old_uri.partition(",")[0] + "," + base64.b64encode(buffer).decode()


def rewritten_glb(content: bytes, text: str | None, buffer: bytearray | None) -> bytes:
    """GLB file with its JSON and binary buffer replaced; None keeps either."""
    head = struct.calcsize("<4sIII4s")
    (length,) = struct.unpack_from("<I", content, 12)
    chunk, rest = content[head : head + length], bytearray(content[head + length :])
    if text is not None:
        chunk = text.encode()
        chunk += b" " * (-len(chunk) % 4)
    if buffer is not None and rest:
        rest[8 : 8 + len(buffer)] = buffer
    start = struct.pack("<4sIII4s", b"glTF", 2, head + len(chunk) + len(rest), len(chunk), b"JSON")
    return start + chunk + bytes(rest)


def _buffer_of(entry: dict[str, Any], blob: bytes | None, path: Path) -> bytes:
    """Bytes of a buffer: binary chunk, data URI or neighbouring file."""
    uri = entry.get("uri")
    if uri is None:
        if blob is None:
            raise ValueError(tr("its binary chunk is missing"))
        return blob
    if not isinstance(uri, str):
        raise ValueError(tr("the location of its coordinates is missing"))
    if uri.startswith("data:"):
        return data_uri_content(uri)
    content = sibling_content(
        unquote(uri), path, whole_number(entry, "byteLength") if "byteLength" in entry else None
    )
    if content is None:
        raise ValueError(tr("the file {uri} is missing from its folder").format(uri=uri))
    return content
