"""Containers of a glTF file: chunks, JSON and buffers."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from apd_viewer.errors import InputError
from apd_viewer.files.gltf.scene import document_entry, list_field, whole_number
from apd_viewer.files.storage.sibling_files import LARGEST_FILE, sibling_content, too_large_error
from apd_viewer.language import tr


def parse_document(json_content: bytes) -> tuple[str, dict[str, Any]]:
    """JSON as text, and its content."""
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
    except ValueError:  # numbers of thousands of digits
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
    """Bytes of all buffers; of those outside the file no more than it may hold."""
    found: list[bytes] = []
    for k in range(len(list_field(document, "buffers"))):
        told = document_entry(document, "buffers", k)
        found.append(_buffer_of(told, None if k else blob, path))
        if "uri" in told and sum(map(len, found)) > LARGEST_FILE:
            raise too_large_error(tr("all its buffers"))
        if len(found[-1]) < whole_number(told, "byteLength", 0):
            raise ValueError(
                tr("a buffer declares {told:,} bytes, but there are {there:,}").format(
                    told=told["byteLength"], there=len(found[-1])
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


def data_uri(before: str, buffer: bytearray) -> str:
    """Data URI of a buffer; raises InputError if the one before was none."""
    if not before.startswith("data:"):
        raise InputError(
            tr("The coordinates are in a separate file, {uri}; pack both into a GLB first.").format(
                uri=before
            )
        )
    return before.partition(",")[0] + "," + base64.b64encode(buffer).decode()


def rewritten_glb(content: bytes, text: str | None, buffer: bytearray | None) -> bytes:
    """GLB file with another JSON and another binary buffer; None keeps them."""
    head = struct.calcsize("<4sIII4s")
    (length,) = struct.unpack_from("<I", content, 12)
    said, rest = content[head : head + length], bytearray(content[head + length :])
    if text is not None:
        said = text.encode()
        said += b" " * (-len(said) % 4)
    if buffer is not None and rest:
        rest[8 : 8 + len(buffer)] = buffer
    start = struct.pack("<4sIII4s", b"glTF", 2, head + len(said) + len(rest), len(said), b"JSON")
    return start + said + bytes(rest)


def _buffer_of(entry: dict[str, Any], blob: bytes | None, path: Path) -> bytes:
    """Bytes of a buffer: the binary chunk, a data URI or a file beside."""
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
