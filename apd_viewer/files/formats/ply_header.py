"""PLY headers: byte order and elements."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from apd_viewer.files.formats.text import excerpt, parse_integers
from apd_viewer.language import tr

NUMPY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
NUMPY_TYPES |= {"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"}
NUMPY_TYPES |= {
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float32": "f4",
    "float64": "f8",
}
AXES = ("x", "y", "z")
LINE_PATTERN = re.compile(rb"[^\r\n]+")
_ORDER = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass
class PlyElement:
    """Table of the file; ``properties`` are (name, type of list length, type)."""

    name: str
    rows: int
    properties: list[tuple[str, str | None, str]] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        """Names of the properties."""
        return [name for name, _, _ in self.properties]

    @property
    def has_lists(self) -> bool:
        """True if any property is a list."""
        return any(length is not None for _, length, _ in self.properties)

    @property
    def least_row_size(self) -> int:
        """Least size of a row in bytes."""
        return sum(np.dtype(length or kind).itemsize for _, length, kind in self.properties)

    def row_dtype(self, order: str, lengths: dict[str, int] | None = None) -> np.dtype:
        """A row, if every list has its length of ``lengths``."""
        columns: list[tuple] = []
        for name, length, kind in self.properties:
            if length is None:
                columns.append((name, order + kind))
            else:
                columns += [(f"{name} count", order + length), (name, order + kind, ((lengths or {})[name],))]
        return np.dtype(columns)


def read_header(content: bytes) -> tuple[str, list[PlyElement], int]:
    """Byte order ("" for text), elements and the offset of their rows."""
    head = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", content[: 1 << 20])
    if not content.startswith(b"ply") or head is None:
        raise ValueError(tr("it has no PLY header"))
    # Where all lines end in \r alone, a \n behind the last one is the first byte of the rows.
    is_of_rows = head[1] == b"\r\n" and b"\n" not in content[: head.start(1)]
    order: str | None = None
    elements: list[PlyElement] = []
    for line in LINE_PATTERN.findall(content[: head.start()]):
        match line.decode("utf-8", errors="replace").split():
            case ["format", kind, *_] if kind in _ORDER:
                order = _ORDER[kind]
            case ["element", name, rows]:
                elements.append(PlyElement(name, parse_integers([rows.encode()])[0]))
            case ["property", "list", length, kind, name] if (
                elements and {length, kind} <= NUMPY_TYPES.keys()
            ):
                elements[-1].properties.append((name, NUMPY_TYPES[length], NUMPY_TYPES[kind]))
            case ["property", kind, name] if elements and kind in NUMPY_TYPES:
                elements[-1].properties.append((name, None, NUMPY_TYPES[kind]))
            case ["format" | "element" | "property", *_]:
                raise ValueError(tr("its header has an invalid line: {text}").format(text=excerpt(line)))
    if order is None:
        raise ValueError(tr("its header does not say whether it is text or binary"))
    _check(elements)
    return order, elements, head.end() - is_of_rows


def _check(elements: list[PlyElement]) -> None:
    """Raise ValueError on impossible elements."""
    for names in ([element.name for element in elements], *(element.names for element in elements)):
        if len(set(names)) < len(names):
            raise ValueError(tr("its header uses one name twice"))
    for vertex in [element for element in elements if element.name == "vertex"]:
        missing = [axis for axis in AXES if axis not in vertex.names]
        if missing:
            raise ValueError(tr("its vertices have no {axis} coordinate").format(axis=missing[0]))
        if any(length and name in AXES for name, length, _ in vertex.properties):
            raise ValueError(tr("its vertices have lists of coordinates"))
    if any(element.rows < 0 for element in elements):
        raise ValueError(tr("its header declares a negative count"))
    if any(length and length[0] == "f" for element in elements for _, length, _ in element.properties):
        raise ValueError(tr("its header declares lists of fractional lengths"))
