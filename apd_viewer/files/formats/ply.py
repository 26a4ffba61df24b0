"""PLY, text or binary: file order kept; new coordinates in place."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.parsed import Parsed, turned
from apd_viewer.files.formats.polygons import Polygons
from apd_viewer.files.formats.text import Edits, numbers, shown, whole_numbers
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
_TYPES |= {"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"}
_TYPES |= {"int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4", "float64": "f8"}
_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}
_CODES |= {"f4": "f", "f8": "d"}
_ORDER = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_AXES, _NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")
_LINE, _WORD = re.compile(rb"[^\r\n]+"), re.compile(rb"\S+")
_INDICES = ("vertex_indices", "vertex_index")
_MOST_CORNERS = 1 << 16  # of a face; more is a broken file
_EXTRAS = {
    "red": tr("colours"),
    "nx": tr("normals"),
    "s": tr("texture coordinates"),
    "alpha": tr("transparency"),
}


@dataclass
class _Element:
    """Table of the file; ``properties`` are (name, type of list length, type)."""

    name: str
    rows: int
    properties: list[tuple[str, str | None, str]] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        return [name for name, _, _ in self.properties]

    @property
    def has_lists(self) -> bool:
        return any(length is not None for _, length, _ in self.properties)

    @property
    def least(self) -> int:
        """Least size of a row in bytes."""
        return sum(np.dtype(length or kind).itemsize for _, length, kind in self.properties)

    def table(self, order: str, lengths: dict[str, int] | None = None) -> np.dtype:
        """A row, if every list has its length of ``lengths``."""
        columns: list[tuple] = []
        for name, length, kind in self.properties:
            if length is None:
                columns.append((name, order + kind))
            else:
                columns += [(f"{name} count", order + length), (name, order + kind, ((lengths or {})[name],))]
        return np.dtype(columns)


@dataclass(frozen=True)
class PlyFile:
    """Content of a PLY file with its layout."""

    content: bytes
    order: str
    elements: list[_Element]
    starts: list[int]  # of the elements
    suffix = ".ply"

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        names = {name for element in self.elements for name in element.names}
        found = [what for name, what in _EXTRAS.items() if name in names]
        known = {*_AXES, *_NORMAL, *_INDICES, *_EXTRAS, "green", "blue", "t"}
        return (*found, *(f"“{name}”" for name in sorted(names - known)))

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and turned normals."""
        at = next(k for k, element in enumerate(self.elements) if element.name == "vertex")
        element, start = self.elements[at], self.starts[at]
        kinds = {name: kind for name, length, kind in element.properties if length is None}
        if any(kinds[axis][0] != "f" for axis in _AXES):
            raise InputError(tr("The file holds whole numbers only; choose another format to write."))
        new: dict[tuple[str, ...], np.ndarray] = {_AXES: U}
        if all(kinds.get(name, "")[:1] == "f" for name in _NORMAL):
            N = self.columns(at, _NORMAL)
            new[_NORMAL] = turned(mesh.V, U, mesh.F, N, mesh.F)
        if not self.order:
            return self._text(at, new)
        body = bytearray(self.content)
        for names, values in new.items():
            old = self.columns(at, names)
            for axis, name in enumerate(names):
                self._put(body, element, start, name, values[:, axis], values[:, axis] != old[:, axis])
        return bytes(body)

    def _put(
        self, body: bytearray, element: _Element, start: int, name: str, values: np.ndarray, which: np.ndarray
    ) -> None:
        kind = self.order + next(kind for other, _, kind in element.properties if other == name)
        if not element.has_lists:
            table = np.frombuffer(body, element.table(self.order), element.rows, start)
            table[name][which] = values[which]
            return
        for row, offsets in enumerate(_walk(self.content, start, element, self.order)):
            if which[row]:
                struct.pack_into(kind[0] + _CODES[kind[1:]], body, offsets[name], values[row])

    def columns(self, at: int, names: tuple[str, ...]) -> np.ndarray:
        """Columns of an element, (rows, len(names)) float array."""
        element, start = self.elements[at], self.starts[at]
        if not self.order:
            places = [element.names.index(name) for name in names]
            words = None if element.has_lists else _rows_alike(self.content, start, element)
            if words is not None and len(words[0]) >= len(element.names):
                return numbers([row[c] for row in words for c in places]).reshape(-1, len(names))
            rows = _text_rows(self.content, start, element)
            return numbers([row[c][0] for row in rows for c in places]).reshape(-1, len(names))
        if not element.has_lists:
            table = np.frombuffer(self.content, element.table(self.order), element.rows, start)
            columns = np.empty((element.rows, len(names)))
            with np.errstate(invalid="ignore"):  # some that are no numbers; refused later
                for k, name in enumerate(names):
                    columns[:, k] = table[name]
            return columns
        codes = {name: self.order + _CODES[kind] for name, _, kind in element.properties}
        return np.array(
            [
                [struct.unpack_from(codes[name], self.content, offsets[name])[0] for name in names]
                for offsets in _walk(self.content, start, element, self.order)
            ]
        ).reshape(-1, len(names))

    def _text(self, at: int, new: dict[tuple[str, ...], np.ndarray]) -> bytes:
        element, start = self.elements[at], self.starts[at]
        edits = Edits(self.content)
        rows = list(_text_rows(self.content, start, element))
        for names, values in new.items():
            columns = [element.names.index(name) for name in names]
            cells = [row[c] for row in rows for c in columns]
            old = numbers([word for word, _ in cells])
            edits.numbers([span for _, span in cells], old, values.ravel())
        return edits.done()


def read_ply(content: bytes) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of a PLY file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    order, elements, start = _head(content)
    starts: list[int] = []
    polygons = Polygons.of([])
    file = PlyFile(content, order, elements, starts)
    for at, element in enumerate(elements):
        if order and element.rows * element.least > len(content) - start:
            raise ValueError(_ends_within(element))
        starts.append(start)
        if element.name == "vertex":
            missing = [axis for axis in _AXES if axis not in element.names]
            if missing:
                raise ValueError(tr("its vertices have no {axis}").format(axis=missing[0]))
            if any(length and name in _AXES for name, length, _ in element.properties):
                raise ValueError(tr("its vertices have lists of coordinates"))
            V = file.columns(at, _AXES)
            if not order:
                start = _after_text(content, start, element)
        if element.name == "face" and element.rows:
            polygons, start = _faces(content, start, element, order)
        elif order and not element.has_lists:
            start += element.rows * element.table(order).itemsize
        elif order:
            for offsets in _walk(content, start, element, order):
                start = offsets[""]
        elif element.name != "vertex":
            start = _after_text(content, start, element)
    if "vertex" not in [element.name for element in elements]:
        return Parsed(np.empty((0, 3)), polygons.triangles(np.empty((0, 3))), None)
    return Parsed(V, polygons.triangles(V), file)


def _faces(content: bytes, start: int, element: _Element, order: str) -> tuple[Polygons, int]:
    """Faces, and the offset of the next element."""
    name = next((name for name, length, _ in element.properties if length and name in _INDICES), None)
    if name is None:
        raise ValueError(tr("its faces have no list of vertex_indices"))
    if any(name == other and kind[0] == "f" for other, _, kind in element.properties):
        raise ValueError(tr("its faces name vertices by fractions"))
    if not order:
        column = element.names.index(name)
        words = _rows_alike(content, start, element) if len(element.names) == 1 else None
        if words is not None and all(row[0] == words[0][0] for row in words):
            (k,) = whole_numbers([words[0][0]])
            if 0 < k < len(words[0]):
                corners = whole_numbers([word for row in words for word in row[1 : 1 + k]])
                alike = [corners[at : at + k] for at in range(0, len(corners), k)]
                return Polygons.of(alike), _after_text(content, start, element)
        faces = [whole_numbers(row[column][0].split()) for row in _text_rows(content, start, element)]
        return Polygons.of(faces), _after_text(content, start, element)
    binary = _faces_alike(content, start, element, order, name)
    if binary is not None:
        return binary
    code = next(_CODES[kind] for other, _, kind in element.properties if other == name)
    size = struct.calcsize(code)
    faces = []
    for offsets in _walk(content, start, element, order):
        count = (offsets[f"{name} end"] - offsets[name]) // size
        faces.append(list(struct.unpack_from(f"{order}{count}{code}", content, offsets[name])))
        end = offsets[""]
    return Polygons.of(faces), end


def _faces_alike(
    content: bytes, start: int, element: _Element, order: str, name: str
) -> tuple[Polygons, int] | None:
    """The same, if all rows are as long as the first one."""
    first = next(_walk(content, start, element, order))
    lengths = {
        other: (first[f"{other} end"] - first[other]) // np.dtype(kind).itemsize
        for other, length, kind in element.properties
        if length is not None
    }
    table = element.table(order, lengths)
    if element.rows * table.itemsize > len(content) - start:
        return None
    rows = np.frombuffer(content, table, element.rows, start)
    if any((rows[f"{other} count"] != length).any() for other, length in lengths.items()):
        return None
    return Polygons.alike(rows[name].astype(np.int64)), start + rows.nbytes


def _walk(content: bytes, start: int, element: _Element, order: str) -> Iterator[dict[str, int]]:
    """Offsets of every property by row ("... end" for list ends, "" for row ends)."""
    sizes = [
        (
            name,
            length and (order + _CODES[length]),
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
                    if not 0 <= count <= _MOST_CORNERS:
                        raise ValueError(tr("a list of {count:,} is absurd").format(count=count))
                    start += head
                    offsets[name] = start
                    start += count * size
                    offsets[f"{name} end"] = start
                else:
                    offsets[name] = start
                    start += size
            offsets[""] = start
            if start > len(content):
                raise ValueError(_ends_within(element))
            yield offsets
    except struct.error:
        raise ValueError(_ends_within(element)) from None


def _ends_within(element: _Element) -> str:
    return tr("it ends within its {rows:,} rows of {element}").format(rows=element.rows, element=element.name)


def _text_rows(
    content: bytes, start: int, element: _Element
) -> Iterator[list[tuple[bytes, tuple[int, int]]]]:
    """Words of every row by property, lists joined, with their spans."""
    rows = 0
    for begin, end in _text_lines(content, start) if element.rows else ():
        words = [(word[0], *word.span()) for word in _WORD.finditer(content, begin, end)]
        yield _row(words, element)
        rows += 1
        if rows == element.rows:
            return
    if rows < element.rows:
        raise ValueError(_ends_within(element))


def _text_lines(content: bytes, start: int) -> Iterator[tuple[int, int]]:
    """Begin and end of the non-empty lines."""
    for line in _LINE.finditer(content, start):
        if not line[0].isspace():
            yield line.span()


def _rows_alike(content: bytes, start: int, element: _Element) -> list[list[bytes]] | None:
    """Words of all rows if equally many in each, else None."""
    end = _after_text(content, start, element)
    rows = [words for line in content[start:end].split(b"\n") if (words := line.split())]
    alike = len(rows) == element.rows and all(len(row) == len(rows[0]) for row in rows)
    return rows if rows and alike else None


def _row(words: list[tuple[bytes, int, int]], element: _Element) -> list[tuple[bytes, tuple[int, int]]]:
    cells, k = [], 0
    for _, length, _ in element.properties:
        count = 1
        if length is not None:
            (count,) = whole_numbers([words[k][0]]) if k < len(words) else (0,)
            k += 1
        if count < 0 or k + count > len(words):
            raise ValueError(_ends_within(element))
        own = words[k : k + count]
        span = (own[0][1], own[-1][2]) if own else (0, 0)
        cells.append((b" ".join(word for word, _, _ in own), span))
        k += count
    return cells


def _after_text(content: bytes, start: int, element: _Element) -> int:
    """Offset of the line after the rows of an element."""
    if not element.rows:
        return start
    for row, (_, end) in enumerate(_text_lines(content, start)):
        if row + 1 == element.rows:
            return end
    return len(content)


def _head(content: bytes) -> tuple[str, list[_Element], int]:
    """Byte order ("" for text), elements and the offset of their rows."""
    head = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", content[: 1 << 20])
    if not content.startswith(b"ply") or head is None:
        raise ValueError(tr("it has no PLY header"))
    order: str | None = None
    elements: list[_Element] = []
    for line in _LINE.findall(content[: head.start()]):
        match line.decode("utf-8", errors="replace").split():
            case ["format", kind, *_] if kind in _ORDER:
                order = _ORDER[kind]
            case ["element", name, rows]:
                elements.append(_Element(name, whole_numbers([rows.encode()])[0]))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= _TYPES.keys():
                elements[-1].properties.append((name, _TYPES[length], _TYPES[kind]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, None, _TYPES[kind]))
            case ["format" | "element" | "property", *_]:
                raise ValueError(
                    tr("its header has a line that is not understood: {text}").format(text=shown(line))
                )
    if order is None:
        raise ValueError(tr("its header does not say whether it is text or binary"))
    for names in ([element.name for element in elements], *(element.names for element in elements)):
        if len(set(names)) < len(names):
            raise ValueError(tr("its header gives one name twice"))
    if any(element.rows < 0 for element in elements):
        raise ValueError(tr("its header announces less than nothing"))
    if any(length and length[0] == "f" for element in elements for _, length, _ in element.properties):
        raise ValueError(tr("its header announces lists of fractional lengths"))
    return order, elements, head.end()
