"""Messages of the ``serve`` command: a JSON head and the raw arrays that it names.

A message is the length of its head (8 bytes, little-endian), the head (a JSON object in UTF-8) and the
numbers of each array, row by row. The head's ``arrays`` lists them as name, dtype and shape. Nothing of the
package is imported, so that the Python of another program can use this file alone.
"""

import json
import math
import struct
from collections.abc import Mapping
from typing import Any, BinaryIO, NamedTuple

import numpy as np

DTYPES = ("<f4", "<f8", "<i4", "<i8")
MOST_HEAD_BYTES = 1 << 16
MOST_ARRAY_BYTES = 1 << 31  # of all arrays of a message
_MOST_ARRAYS, _MOST_AXES = 16, 3
_PIECE = 1 << 20  # bytes; memory grows with what has arrived, whatever is announced
_LENGTH = struct.Struct("<Q")


class MessageError(ValueError):
    """Content that is no message; where the next one begins is unknown."""


class Message(NamedTuple):
    """Head of a message, without ``arrays``, and its arrays by name, read-only."""

    head: dict[str, Any]
    arrays: dict[str, np.ndarray]


def write_message(sink: BinaryIO, head: Mapping[str, Any], arrays: Mapping[str, np.ndarray] = {}) -> None:
    """Write a message; arrays must have one of ``DTYPES``.

    Raises OSError if the other end is closed, and ValueError for a number in the head that is not finite.
    """
    table = [[name, array.dtype.str, list(array.shape)] for name, array in arrays.items()]
    text = json.dumps({**head, "arrays": table}, allow_nan=False).encode()
    sink.write(_LENGTH.pack(len(text)) + text)
    for array in arrays.values():
        sink.write(array.tobytes())
    sink.flush()


def read_message(source: BinaryIO) -> Message | None:
    """Read a message; None at the end of the stream, also within a message.

    Raises MessageError with a sentence for anything else.
    """
    start = source.read(_LENGTH.size)
    if len(start) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(start)
    if not 2 <= length <= MOST_HEAD_BYTES:
        raise MessageError(f"A head must have 2 to {MOST_HEAD_BYTES} bytes, not {length}.")
    text = source.read(length)
    if len(text) < length:
        return None
    try:
        head = json.loads(text, parse_float=_finite_number, parse_constant=_finite_number)
    except (ValueError, RecursionError):
        raise MessageError("A head must be JSON in UTF-8, with finite numbers.") from None
    if not isinstance(head, dict):
        raise MessageError("A head must be a JSON object.")
    arrays: dict[str, np.ndarray] = {}
    for name, dtype, shape in _checked_table(head.pop("arrays", [])):
        content = _read_content(source, math.prod(shape) * np.dtype(dtype).itemsize)
        if content is None:
            return None
        arrays[name] = np.frombuffer(content, dtype).reshape(shape)
        arrays[name].flags.writeable = False
    return Message(head, arrays)


def _finite_number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


def _checked_table(table: object) -> list[tuple[str, str, tuple[int, ...]]]:
    """Rows of ``arrays``; raises MessageError for others."""
    if not isinstance(table, list) or len(table) > _MOST_ARRAYS:
        raise MessageError(f"arrays must be a list of at most {_MOST_ARRAYS}.")
    rows, size = [], 0
    for row in table:
        if not (isinstance(row, list) and len(row) == 3 and isinstance(row[0], str)):
            raise MessageError("Each of arrays must be a name, a dtype and a shape.")
        name, dtype, shape = row
        if dtype not in DTYPES:
            raise MessageError(f"A dtype must be one of {', '.join(DTYPES)}.")
        if not isinstance(shape, list) or len(shape) > _MOST_AXES or not all(type(n) is int for n in shape):
            raise MessageError(f"A shape must be a list of at most {_MOST_AXES} whole numbers.")
        if not all(0 <= n <= MOST_ARRAY_BYTES for n in shape):
            raise MessageError("A shape must have numbers of at least 0, and no huge ones.")
        size += math.prod(shape) * np.dtype(dtype).itemsize
        if size > MOST_ARRAY_BYTES:
            raise MessageError(f"The arrays of a message may have {MOST_ARRAY_BYTES} bytes together.")
        rows.append((name, dtype, tuple(shape)))
    if len({name for name, _, _ in rows}) < len(rows):
        raise MessageError("The names of arrays must differ.")
    return rows


def _read_content(source: BinaryIO, size: int) -> bytearray | None:
    content = bytearray()
    while len(content) < size:
        piece = source.read(min(_PIECE, size - len(content)))
        if not piece:
            return None
        content += piece
    return content
