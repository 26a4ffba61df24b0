"""PLY elements: header parsing, and rows in text or binary."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from apd_viewer.files.formats.polygon_mesh import Polygons, strip_triangles
from apd_viewer.files.formats.text import excerpt, parse_integers
from apd_viewer.language import tr

STRUCT_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}
STRUCT_CODES |= {"f4": "f", "f8": "d"}
INDEX_PROPERTIES = ("vertex_indices", "vertex_index")
_WORD = re.compile(rb"\S+")
_BLANK = bytes.maketrans(b"\r\n", b"  ")


def read_faces(content: bytes, start: int, element: PlyElement, order: str) -> tuple[Polygons, int]:
    """Faces, and the offset of the next element."""
    name = next((name for name, length, _ in element.properties if length and name in INDEX_PROPERTIES), None)
    if name is None:
        raise ValueError(tr("its faces have no vertex_indices list"))
    if any(name == other and kind[0] == "f" for other, _, kind in element.properties):
        raise ValueError(tr("its faces have fractional vertex indices"))
    if not order:
        column = element.names.index(name)
        words = uniform_rows(content, start, element) if len(element.names) == 1 else None
        if words is not None and all(row[0] == words[0][0] for row in words):
            (k,) = parse_integers([words[0][0]])
            if 0 < k < len(words[0]):
                corners = parse_integers([word for row in words for word in row[1 : 1 + k]])
                alike = [corners[at : at + k] for at in range(0, len(corners), k)]
                return Polygons.from_faces(alike), text_end(content, start, element)
        faces = [parse_integers(row[column][0].split()) for row in text_rows(content, start, element)]
        return Polygons.from_faces(faces), text_end(content, start, element)
    binary = _uniform_faces(content, start, element, order, name)
    if binary is not None:
        return binary
    code = next(STRUCT_CODES[kind] for other, _, kind in element.properties if other == name)
    size = struct.calcsize(code)
    faces = []
    for offsets in row_offsets(content, start, element, order):
        count = (offsets[f"{name} end"] - offsets[name]) // size
        faces.append(list(struct.unpack_from(f"{order}{count}{code}", content, offsets[name])))
        end = offsets[""]
    return Polygons.from_faces(faces), end


def faces_of_strips(strips: Polygons) -> Polygons:
    """Triangles of strips, without the degenerate ones between them."""
    T = strip_triangles(np.insert(strips.corner, strips.start[1:-1], -1))
    return Polygons.from_array(T[(np.roll(T, 1, axis=1) != T).all(axis=1)])


def _uniform_faces(
    content: bytes, start: int, element: PlyElement, order: str, name: str
) -> tuple[Polygons, int] | None:
    """Fast path of read_faces for rows of equal length; None if lengths differ."""
    first = next(row_offsets(content, start, element, order))
    lengths = {
        other: (first[f"{other} end"] - first[other]) // np.dtype(kind).itemsize
        for other, length, kind in element.properties
        if length is not None
    }
    table = element.row_dtype(order, lengths)
    if element.rows * table.itemsize > len(content) - start:
        return None
    rows = np.frombuffer(content, table, element.rows, start)
    if any((rows[f"{other} count"] != length).any() for other, length in lengths.items()):
        return None
    return Polygons.from_array(rows[name].astype(np.int64)), start + rows.nbytes


def row_offsets(content: bytes, start: int, element: PlyElement, order: str) -> Iterator[dict[str, int]]:
    """Property offsets of each row ("... end" for list ends, "" for the row end)."""
    sizes = [
        (
            name,
            length and (order + STRUCT_CODES[length]),
            np.dtype(length or kind).itemsize,
            np.dtype(kind).itemsize,
        )
        for name, length, kind in element.properties
    ]
    try:
        for _ in range(element.rows):
            offsets: dict[str, int] = {}
            for name, length, head, size in sizes:
                if length:
                    (count,) = struct.unpack_from(length, content, start)
                    if not 0 <= count * size <= len(content):
                        raise ValueError(tr("a list length of {count:,} is out of range").format(count=count))
                    start += head
                    offsets[name] = start
                    start += count * size
                    offsets[f"{name} end"] = start
                else:
                    offsets[name] = start
                    start += size
            offsets[""] = start
            if start > len(content):
                raise ValueError(truncation_message(element))
            yield offsets
    except struct.error:
        raise ValueError(truncation_message(element)) from None


def truncation_message(element: PlyElement) -> str:
    """Error phrase for a file truncated within the element."""
    return tr("it ends before the last of its {rows:,} rows of {element}").format(
        rows=element.rows, element=element.name
    )


def text_rows(
    content: bytes, start: int, element: PlyElement
) -> Iterator[list[tuple[bytes, tuple[int, int]]]]:
    """Words of each row by property with their spans; lists are joined."""
    rows = 0
    for begin, end in _text_lines(content, start) if element.rows else ():
        words = [(word[0], *word.span()) for word in _WORD.finditer(content, begin, end)]
        yield _row(words, element)
        rows += 1
        if rows == element.rows:
            return
    if rows < element.rows:
        raise ValueError(truncation_message(element))


def _text_lines(content: bytes, start: int) -> Iterator[tuple[int, int]]:
    """Start and end of each non-empty line."""
    for line in LINE_PATTERN.finditer(content, start):
        if not line[0].isspace():
            yield line.span()


def uniform_rows(content: bytes, start: int, element: PlyElement) -> list[list[bytes]] | None:
    """Words of all rows; None unless every row has the same number of words."""
    end = text_end(content, start, element)
    rows = [words for line in content[start:end].split(b"\n") if (words := line.split())]
    alike = len(rows) == element.rows and all(len(row) == len(rows[0]) for row in rows)
    return rows if rows and alike else None


def _row(words: list[tuple[bytes, int, int]], element: PlyElement) -> list[tuple[bytes, tuple[int, int]]]:
    cells, k = [], 0
    for _, length, _ in element.properties:
        count = 1
        if length is not None:
            (count,) = parse_integers([words[k][0]]) if k < len(words) else (0,)
            k += 1
        if count < 0 or k + count > len(words):
            raise ValueError(truncation_message(element))
        own = words[k : k + count]
        span = (own[0][1], own[-1][2]) if own else (0, 0)
        cells.append((b" ".join(word for word, _, _ in own), span))
        k += count
    return cells


def with_one_row_per_line(content: bytes, start: int, elements: Sequence[PlyElement]) -> bytes | None:
    """Wrapped text rewritten with one row per line, at the same length.

    None if the number of words does not match the elements.
    """
    body = bytearray(content[:start] + content[start:].translate(_BLANK))
    words = _WORD.finditer(content, start)
    for element in elements:
        for _ in range(element.rows if element.properties else 0):
            end = start
            for _, length, _ in element.properties:
                word = next(words, None)
                for _ in range(parse_integers([word[0]])[0] if word and length else 0):
                    word = next(words, None)
                    if word is None:
                        break
                if word is None:
                    return None
                end = word.end()
            body[end : end + 1] = b"\n"
    return bytes(body) if next(words, None) is None else None


def text_end(content: bytes, start: int, element: PlyElement) -> int:
    """End offset of the last row of an element."""
    if not element.rows:
        return start
    for row, (_, end) in enumerate(_text_lines(content, start)):
        if row + 1 == element.rows:
            return end
    return len(content)


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
    """Element of a PLY file; ``properties`` are (name, list length type, type)."""

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
        """Minimum size of a row in bytes."""
        return sum(np.dtype(length or kind).itemsize for _, length, kind in self.properties)

    def row_dtype(self, order: str, lengths: dict[str, int] | None = None) -> np.dtype:
        """Structured dtype of a row, with list lengths from ``lengths``."""
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
    # If lines end in \r alone, a \n after the header's last \r is the first byte of the rows.
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
            case _:
                pass  # comments and unknown keywords
    if order is None:
        raise ValueError(tr("its header does not say whether it is text or binary"))
    _check(elements)
    return order, elements, head.end() - is_of_rows


def _check(elements: list[PlyElement]) -> None:
    """Raise ValueError on invalid elements."""
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
