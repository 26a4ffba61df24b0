"""Blocks of LZ4, after its block format description."""

from __future__ import annotations

from apd_viewer.language import tr

_LEAST_MATCH = 4
_LONG, _FULL = 15, 255  # of a length: more bytes follow


def decompressed_block(data: bytes, most: int) -> bytes:
    """Content of a block, at most so many bytes; raises ValueError if damaged."""
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
    """A block with the content as it is: valid, and 0.4 % longer."""
    size = len(data)
    if size < _LONG:
        return bytes([size << 4]) + data
    rest = size - _LONG
    return bytes([_LONG << 4]) + b"\xff" * (rest // _FULL) + bytes([rest % _FULL]) + data


def _length(data: bytes, place: int, length: int) -> tuple[int, int]:
    """A length continued in further bytes, and the place behind it."""
    if length == _LONG:
        while data[place] == _FULL:
            length += _FULL
            place += 1
        length += data[place]
        place += 1
    return length, place


def _repeat(found: bytearray, back: int, length: int) -> None:
    """Append the bytes from so far back, over and over."""
    if not 0 < back <= len(found):
        raise IndexError
    start = len(found) - back
    piece = found[start : start + length]
    times = -(-length // back)
    found += (piece * times)[:length] if times > 1 else piece
