"""Vertices and faces of PLY, text or binary, in the order of the file."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

import numpy as np

from apd_viewer.files.polygons import fans

_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
_TYPES |= {"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"}
_TYPES |= {"int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4", "float64": "f8"}
_CODES = {
    "i1": "b",
    "u1": "B",
    "i2": "h",
    "u2": "H",
    "i4": "i",
    "u4": "I",
    "i8": "q",
    "u8": "Q",
    "f4": "f",
    "f8": "d",
}
_ORDER = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass
class _Element:
    """A table of the file. ``properties`` are (name, type of a list's length or None, type)."""

    name: str
    rows: int
    properties: list[tuple[str, str | None, str]] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        return [name for name, _, _ in self.properties]


def read_ply(content: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and triangles (m, 3) of a PLY file; all other properties are left out.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    order, elements, start = _head(content)
    lines = iter(
        [] if order else [line for line in content[start:].decode("ascii").splitlines() if line.strip()]
    )
    positions: np.ndarray = np.empty((0, 3))
    polygons: list = []
    for element in elements:
        if order:
            rows, start = _binary(content, start, element, order)
        else:
            rows = [_row(next(lines, ""), element) for _ in range(element.rows)]
        if element.name == "vertex":
            columns = [element.names.index(axis) for axis in "xyz"]
            positions = np.array([[row[c] for c in columns] for row in rows], dtype=np.float64).reshape(-1, 3)
        elif element.name == "face" and rows:
            column = next(
                k for k, name in enumerate(element.names) if name in ("vertex_indices", "vertex_index")
            )
            polygons = [row[column] for row in rows]
    return positions, fans(polygons)


def _head(content: bytes) -> tuple[str, list[_Element], int]:
    """Byte order ("" for text), the elements, and where their rows begin."""
    end = content.find(b"end_header")
    start = content.find(b"\n", end) + 1
    if not content.startswith(b"ply") or end < 0 or not start:
        raise ValueError("it has no PLY header")
    order, elements = None, []
    for line in content[:end].decode("utf-8", errors="replace").splitlines():
        match line.split():
            case ["format", kind, _]:
                order = _ORDER[kind]
            case ["element", name, rows]:
                elements.append(_Element(name, int(rows)))
            case ["property", "list", length, kind, name]:
                elements[-1].properties.append((name, _TYPES[length], _TYPES[kind]))
            case ["property", kind, name]:
                elements[-1].properties.append((name, None, _TYPES[kind]))
    if order is None:
        raise ValueError("its header does not say whether it is text or binary")
    return order, elements, start


def _row(line: str, element: _Element) -> list:
    words = iter(line.split())
    values: list = []
    try:
        for _, length, kind in element.properties:
            read = float if kind[0] == "f" else int
            if length is None:
                values.append(read(next(words)))
            else:
                values.append([read(next(words)) for _ in range(int(next(words)))])
    except (StopIteration, RuntimeError):
        raise ValueError(f"it ends within its {element.rows:,} rows of {element.name}") from None
    return values


def _binary(content: bytes, start: int, element: _Element, order: str) -> tuple[list, int]:
    """Rows of an element, and where the next one begins."""
    try:
        if all(length is None for _, length, _ in element.properties):
            table = np.dtype([(name, order + kind) for name, _, kind in element.properties])
            whole = np.frombuffer(content, table, element.rows, start)
            return whole.tolist(), start + whole.nbytes
        rows: list = []
        for _ in range(element.rows):
            row: list = []
            for _, length, kind in element.properties:
                count = 1
                if length is not None:
                    (count,) = struct.unpack_from(order + _CODES[length], content, start)
                    start += np.dtype(length).itemsize
                values = struct.unpack_from(f"{order}{count}{_CODES[kind]}", content, start)
                start += count * np.dtype(kind).itemsize
                row.append(values[0] if length is None else values)
            rows.append(row)
        return rows, start
    except (struct.error, ValueError):
        raise ValueError(f"it ends within its {element.rows:,} rows of {element.name}") from None
