"""Arrays of a VTK XML file: text, base64 and appended bytes, also compressed."""

import base64
import binascii
import lzma
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.text import text_values, with_replaced_values
from apd_viewer.files.storage.archive import largest_unpacked_size
from apd_viewer.files.vtk.xml_elements import XmlElement, parse_elements
from apd_viewer.language import tr

_LEAST_MATCH = 4
_LONG, _FULL = 15, 255  # length values continued in further bytes


def decompressed_block(data: bytes, most: int) -> bytes:
    """Decompress an LZ4 block to at most ``most`` bytes; raises ValueError if damaged."""
    found, place = bytearray(), 0
    try:
        while place < len(data):
            token = data[place]
            length, place = _length(data, place + 1, token >> 4)
            found += data[place : place + length]
            place += length
            if place >= len(data) or len(found) > most:
                break
            back = data[place] | data[place + 1] << 8
            length, place = _length(data, place + 2, token & _LONG)
            _repeat(found, back, max(0, min(length + _LEAST_MATCH, most - len(found))))
    except IndexError:
        raise ValueError(tr("one of its compressed arrays is damaged")) from None
    return bytes(found[:most])


def compressed_block(data: bytes) -> bytes:
    """Valid LZ4 block with uncompressed content, 0.4 % longer."""
    size = len(data)
    if size < _LONG:
        return bytes([size << 4]) + data
    rest = size - _LONG
    return bytes([_LONG << 4]) + b"\xff" * (rest // _FULL) + bytes([rest % _FULL]) + data


def _length(data: bytes, place: int, length: int) -> tuple[int, int]:
    """Length continued in further bytes, and the offset after it."""
    if length == _LONG:
        while data[place] == _FULL:
            length += _FULL
            place += 1
        length += data[place]
        place += 1
    return length, place


def _repeat(found: bytearray, back: int, length: int) -> None:
    """Append ``length`` bytes, repeating the last ``back`` bytes."""
    if not 0 < back <= len(found):
        raise IndexError
    start = len(found) - back
    piece = found[start : start + length]
    times = -(-length // back)
    found += (piece * times)[:length] if times > 1 else piece


_TYPES = {
    f"{name}{8 * size}": f"{kind}{size}"
    for name, kind in (("Int", "i"), ("UInt", "u"))
    for size in (1, 2, 4, 8)
}
_TYPES |= {"Float32": "f4", "Float64": "f8"}
_ENDS = tr("one of its arrays ends early")


class _Codec(NamedTuple):
    """Compression and bounded decompression of a block."""

    pack: Callable[[bytes], bytes]
    unpack: Callable[[bytes, int], bytes]


_CODECS = {
    "vtkLZ4DataCompressor": _Codec(compressed_block, decompressed_block),
    "vtkZLibDataCompressor": _Codec(
        zlib.compress, lambda data, most: zlib.decompressobj().decompress(data, most)
    ),
    "vtkLZMADataCompressor": _Codec(
        lzma.compress, lambda data, most: lzma.LZMADecompressor().decompress(data, most)
    ),
}


@dataclass(frozen=True)
class _EncodedBytes:
    """Bytes of the file, stored raw or in base64."""

    content: bytes
    is_base64: bool

    def decode(self, start: int, size: int) -> tuple[bytes, int]:
        """Decode ``size`` bytes from offset ``start``; return them and the end offset."""
        length = -(-size // 3) * 4 if self.is_base64 else size
        found = self.content[start : start + length]
        if len(found) < length:
            raise ValueError(_ENDS)
        if not self.is_base64:
            return found, start + length
        try:
            return base64.b64decode(found, validate=True)[:size], start + length
        except binascii.Error:
            raise ValueError(tr("one of its arrays is not valid base64")) from None

    def encode(self, data: bytes) -> bytes:
        """Encode data as in the file."""
        return base64.b64encode(data) if self.is_base64 else data


class XmlArray(NamedTuple):
    """Values (k,) of an array in the type of the file, and their span in the file.

    Attributes
    ----------
    values : array
        Of a text in double precision, as it says more digits than its type has.
    start, end : int
        Of all that is written anew if a value changes.
    header : dtype or None
        Type of the sizes before the values; None for text.
    has_separate_header : bool
        Whether these sizes are a separate base64 text.
    block : int
        Bytes that are packed together; 0 if they are not.
    """

    values: np.ndarray
    start: int
    end: int
    header: np.dtype | None = None
    has_separate_header: bool = False
    block: int = 0


class XmlArrays:
    """Reader and writer of the data arrays of a VTK XML file.

    Raises
    ------
    ValueError
        If it is no XML of VTK.
    """

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.root, self.appended = parse_elements(content)
        if self.root.name != "VTKFile":
            raise ValueError(tr("it is not a VTK file"))
        attributes = self.root.attributes
        self._order = ">" if attributes.get("byte_order") == "BigEndian" else "<"
        self._header = np.dtype(self._order + ("u8" if attributes.get("header_type") == "UInt64" else "u4"))
        self._compressor = attributes.get("compressor", "")
        data = self.root.first_child("AppendedData")
        self._is_raw = data is not None and data.attributes.get("encoding") == "raw"
        # A file may reference one array many times, so the total size is bounded.
        self._most = largest_unpacked_size(len(content))
        self._left = 2 * len(content)

    def read(self, element: XmlElement) -> XmlArray:
        """Read a DataArray element; raises ValueError if it is damaged."""
        stored = self._read_array(element)
        self._left -= stored.end - stored.start
        if self._left < 0:
            raise ValueError(tr("two of its arrays overlap"))
        return stored

    def _read_array(self, element: XmlElement) -> XmlArray:
        kind = _TYPES.get(element.attributes.get("type", ""))
        if kind is None:
            raise ValueError(tr("one of its arrays is of an unknown type"))
        form = element.attributes.get("format", "ascii")
        start, end = element.text_span(self.content)
        if form == "ascii":
            return XmlArray(text_values(self.content[start:end], kind), start, end)
        if form == "appended":
            if self.appended is None:
                raise ValueError(tr("its appended data is missing"))
            return self._binary_array(self.appended + element.int_attribute("offset"), kind, not self._is_raw)
        text = self.content[start:end]
        if not text.strip():
            return XmlArray(np.empty(0, dtype=kind), start, start)
        return self._binary_array(start + len(text) - len(text.lstrip()), kind, True)

    def _binary_array(self, start: int, kind: str, is_base64: bool) -> XmlArray:
        coded = _EncodedBytes(self.content, is_base64)
        head, behind = coded.decode(start, self._header.itemsize)
        if self._compressor:
            data, end, block = self._blocks(coded, start, self._number(head))
            return XmlArray(self._numbers(data, kind), start, end, self._header, True, block)
        size = self._number(head)
        apart = is_base64 and self._header.itemsize % 3 != 0 and self.content[behind - 1 : behind] == b"="
        if apart:
            data, end = coded.decode(behind, size)
        else:
            data, end = coded.decode(start, len(head) + size)
            data = data[len(head) :]
        return XmlArray(self._numbers(data, kind), start, end, self._header, apart)

    def _blocks(self, coded: _EncodedBytes, start: int, count: int) -> tuple[bytes, int, int]:
        """Decompressed bytes, the offset after their blocks, and the block size."""
        codec = _CODECS.get(self._compressor)
        if codec is None:
            raise ValueError(tr("its compression is not supported; save it with ZLib or without compression"))
        head, at = coded.decode(start, (3 + count) * self._header.itemsize)
        _, block, last, *packed = np.frombuffer(head, self._header).tolist()
        size = (count - 1) * block + (last or block) if count else 0
        if size > self._most:
            raise ValueError(tr("its arrays would have at least {size:,} bytes").format(size=size))
        self._most -= size
        data, end = coded.decode(at, sum(packed))
        pieces, place = [], 0
        for k, size in enumerate(packed):
            most = last if last and k == count - 1 else block
            pieces.append(_unpack(codec, data[place : place + size], most))
            place += size
        return b"".join(pieces), end, block

    def _number(self, head: bytes) -> int:
        return int(np.frombuffer(head, self._header)[0])

    def _numbers(self, data: bytes, kind: str) -> np.ndarray:
        dtype = np.dtype(self._order + kind)
        if len(data) % dtype.itemsize:
            raise ValueError(_ENDS)
        return np.frombuffer(data, dtype)

    def rewritten_content(self, element: XmlElement, stored: XmlArray, values: np.ndarray) -> bytes:
        """File content of an array's span with new ``values`` (k,)."""
        if stored.header is None:
            return with_replaced_values(self.content[stored.start : stored.end], stored.values, values)
        new = updated_array(stored.values, values)
        coded = _EncodedBytes(b"", element.attributes.get("format") != "appended" or not self._is_raw)
        return self._packed_bytes(coded, stored, new.tobytes())

    def _packed_bytes(self, coded: _EncodedBytes, stored: XmlArray, data: bytes) -> bytes:
        if not stored.block:
            head = np.array([len(data)], self._header).tobytes()
            return (
                coded.encode(head) + coded.encode(data)
                if stored.has_separate_header
                else coded.encode(head + data)
            )
        codec, size = _CODECS[self._compressor], stored.block
        blocks = [codec.pack(data[k : k + size]) for k in range(0, len(data), size)]
        head = np.array([len(blocks), size, len(data) % size, *map(len, blocks)], self._header).tobytes()
        return coded.encode(head) + coded.encode(b"".join(blocks))


def updated_array(old: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Copy of ``old`` (k,) in its type, updated to ``values`` where they differ."""
    changed, new = values != old, old.copy()
    with np.errstate(all="ignore"):  # overflow is detected when the file is read back
        new[changed] = values[changed]
    return new


def _unpack(codec: _Codec, data: bytes, most: int) -> bytes:
    """Decompress a block to exactly ``most`` bytes; raises ValueError otherwise."""
    try:
        found = codec.unpack(data, most) if most else b""
    except (zlib.error, lzma.LZMAError, EOFError):
        raise ValueError(tr("one of its compressed arrays is damaged")) from None
    if len(found) != most:
        raise ValueError(_ENDS)
    return found
