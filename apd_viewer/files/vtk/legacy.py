"""Legacy VTK surface files (``.vtk``): reading, and rewriting in place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import ParsedMesh, Polygons, concatenated_polygons
from apd_viewer.files.formats.text import Splice, excerpt, spliced_content, text_values, with_replaced_values
from apd_viewer.files.vtk.cells import POLYGON, STRIP, cell_faces, cells_to_polygons, point_positions
from apd_viewer.files.vtk.xml_arrays import updated_array
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_HEAD = re.compile(
    rb"#\s*vtk DataFile Version\s+(\d{1,3})\S*[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\b", re.IGNORECASE
)
_DATA = {"POINT_DATA": tr("point data"), "CELL_DATA": tr("cell data"), "FIELD": tr("field data")}
_KINDS = {"POLYGONS": POLYGON, "TRIANGLE_STRIPS": STRIP, "VERTICES": None, "LINES": None}
_NORMS = re.compile(rb"NAME L2_NORM_\w*RANGE LOCATION \S+\s+DATA 2 (\S+) (\S+)")


@dataclass(frozen=True)
class VtkLegacyFile:
    """Content of a legacy VTK file, and the span of its points."""

    content: bytes
    points: LegacyArray
    points_metadata: tuple[int, int]
    other_data: tuple[str, ...]
    suffix = ".vtk"

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        return self.other_data

    @property
    def colors(self) -> None:
        """None: data arrays are values, not colours."""

    def normals(self, _: Mesh) -> None:
        """None: point data stay unchanged, including normals."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3); all data arrays unchanged."""
        if np.array_equal(mesh.V, U):
            return self.content
        return spliced_content(self.content, [self._point_update(U.ravel()), *self._norm_updates(U)])

    def _point_update(self, values: np.ndarray) -> Splice:
        old, start, end, is_text = self.points
        if is_text:
            return Splice(start, end, with_replaced_values(self.content[start:end], old, values))
        return Splice(start, end, updated_array(old, values).tobytes())

    def _norm_updates(self, U: np.ndarray) -> Iterator[Splice]:
        """Updates of the stored range of distances from the origin, if any."""
        size = np.linalg.norm(U, axis=1)
        for found in _NORMS.finditer(self.content, *self.points_metadata):
            yield Splice(*found.span(1), b"%g" % size.min())
            yield Splice(*found.span(2), b"%g" % size.max())


@dataclass
class _Sections:
    """Sections of the file read so far."""

    points: LegacyArray | None = None
    about_points: tuple[int, int] = (0, 0)
    cells: Polygons | None = None
    types: np.ndarray | None = None
    polygons: dict[str, Polygons] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)


def read_vtk(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of a legacy VTK surface file.

    Raises
    ------
    ValueError
        If it cannot be understood.
    InputError
        If it holds something else than a surface.
    """
    head = _HEAD.match(content[:1000])
    if head is None:
        raise ValueError(tr("it does not start with a VTK header"))
    reader = LegacyReader(content, head.end(), head[2].upper() == b"BINARY")
    sections = _Sections()
    kind = _read(reader, sections, lists_offsets=int(head[1]) >= 5)
    if sections.points is None:
        raise ValueError(tr("it has no points"))
    V = point_positions(sections.points.values)
    faces = _grid_faces(sections) if kind == "UNSTRUCTURED_GRID" else _poly_faces(sections)
    origin = VtkLegacyFile(
        content, sections.points, sections.about_points, tuple(dict.fromkeys(sections.others))
    )
    return ParsedMesh(V, faces.triangles(V), origin)


def _read(reader: LegacyReader, sections: _Sections, lists_offsets: bool) -> str:
    """Read up to the point and cell data; return the kind of the data set."""
    kind = ""
    while (word := reader.peek_word()) and word not in ("POINT_DATA", "CELL_DATA"):
        reader.read_word()
        if word == "DATASET":
            kind = reader.read_word().decode("ascii", "replace").upper()
            if kind not in ("POLYDATA", "UNSTRUCTURED_GRID"):
                raise InputError(
                    tr("The file holds a grid or a field and no surface; extract the surface first.")
                )
        elif word == "FIELD":
            sections.others.append(_DATA[word])
            _skip_field(reader)
        elif word == "POINTS":
            sections.points = reader.read_array(3 * reader.read_count(), reader.read_word())
            sections.about_points = reader.skip_metadata()
        elif word == "CELL_TYPES":
            sections.types = reader.read_array(reader.read_count(), b"int").values
        elif word == "CELLS":
            sections.cells = _read_cells(reader, sections, lists_offsets)
        elif word in _KINDS:
            sections.polygons[word] = _read_cells(reader, sections, lists_offsets)
        elif word == "METADATA":
            reader.position -= len(word)
            reader.skip_metadata()
        else:
            raise ValueError(tr("it has an unknown part {text}").format(text=f"“{word}”"))
    for match in re.finditer(rb"^(POINT_DATA|CELL_DATA)\b", reader.content[reader.position :], re.MULTILINE):
        sections.others.append(_DATA[match[1].decode()])
    return kind


def _skip_field(reader: LegacyReader) -> None:
    reader.read_word()
    for _ in range(reader.read_count()):
        reader.read_word()
        count = reader.read_count() * reader.read_count()
        reader.skip_values(count, reader.read_word())
        reader.skip_metadata()


def _read_cells(reader: LegacyReader, sections: _Sections, lists_offsets: bool) -> Polygons:
    """Read cells, stored as offsets and connectivity or as one list with sizes."""
    points = 0 if sections.points is None else len(sections.points.values) // 3
    first, second = reader.read_count(), reader.read_count()
    if not lists_offsets:
        return _size_prefixed_polygons(
            reader.read_array(second, b"int").values.astype(np.int64), first, points
        )
    if not first:
        return concatenated_polygons([])
    offsets = _read_named_array(reader, "OFFSETS", first)
    return cells_to_polygons(_read_named_array(reader, "CONNECTIVITY", second), offsets, points)


def _read_named_array(reader: LegacyReader, name: str, count: int) -> np.ndarray:
    if reader.peek_word() != name:
        raise ValueError(tr("its cells have no {name}").format(name=name.lower()))
    reader.read_word()
    values = reader.read_array(count, reader.read_word()).values
    reader.skip_metadata()
    return values


def _size_prefixed_polygons(row: np.ndarray, cells: int, points: int) -> Polygons:
    """Polygons from one list (k,) with the size of each cell before its vertices."""
    places, at, numbers = [], 0, row.tolist()
    for _ in range(cells):
        if at >= len(numbers) or numbers[at] < 0:
            raise ValueError(tr("its cells do not fit the list of their vertices"))
        places.append(at)
        at += numbers[at] + 1
    heads = np.array(places, dtype=np.int64)
    start = np.concatenate([[0], np.cumsum(row[heads])]) if cells else np.zeros(1, dtype=np.int64)
    return cells_to_polygons(np.delete(row, heads), start, points)


def _grid_faces(sections: _Sections) -> Polygons:
    if sections.cells is None or sections.types is None:
        return concatenated_polygons([])
    return cell_faces(sections.cells, sections.types)


def _poly_faces(sections: _Sections) -> Polygons:
    """Polygons, then the triangles of strips."""
    parts = []
    for name in ("POLYGONS", "TRIANGLE_STRIPS"):
        cells = sections.polygons.get(name)
        if cells is not None:
            parts.append(cell_faces(cells, np.full(len(cells.start) - 1, _KINDS[name])))
    return concatenated_polygons(parts)


_WORD, _WORDS = re.compile(rb"\s*(\S+)"), re.compile(rb"\S+")
_SPACE = re.compile(rb"[^\S\n]*\n?")
_METADATA_END = re.compile(rb"\n[^\S\n]*\n|\Z")
# Binary numbers are big-endian; ids were written as int before VTK had types for them.
_TYPES = {
    "char": "i1", "signed_char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2",
    "int": "i4", "unsigned_int": "u4", "long": "i8", "unsigned_long": "u8", "float": "f4", "double": "f8",
    "vtkidtype": "i4", "vtktypeint64": "i8", "vtktypeuint64": "u8", "vtktypeint32": "i4",
    "vtktypeuint32": "u4",
}  # fmt: skip


class LegacyArray(NamedTuple):
    """Values (k,) of an array, and its span in the file.

    Attributes
    ----------
    values : array
        Of a text in double precision.
    """

    values: np.ndarray
    start: int
    end: int
    is_text: bool


class LegacyReader:
    """Cursor in a legacy VTK file; methods raise ValueError on damaged content.

    Parameters
    ----------
    start : int
        Offset of the first byte.
    """

    def __init__(self, content: bytes, start: int, is_binary: bool) -> None:
        self.content = content
        self.position = start
        self._binary = is_binary

    def peek_word(self) -> str:
        """Next word in upper case without advancing; empty at the end."""
        found = _WORD.match(self.content, self.position)
        return "" if found is None else found[1][:40].decode("ascii", "replace").upper()

    def read_word(self) -> bytes:
        """Read the next word."""
        found = _WORD.match(self.content, self.position)
        if found is None:
            raise ValueError(tr("it ends early"))
        self.position = found.end()
        return found[1]

    def read_count(self) -> int:
        """Read the next word as a non-negative integer."""
        word = self.read_word()
        if not re.fullmatch(rb"\d{1,18}", word):
            raise ValueError(tr("{text} is not a whole number").format(text=excerpt(word)))
        return int(word)

    def read_array(self, count: int, kind: bytes) -> LegacyArray:
        """Read the next ``count`` numbers of a type."""
        name = _TYPES.get(kind.decode("ascii", "replace").lower())
        if name is None:
            raise ValueError(tr("{text} is not a type of numbers").format(text=excerpt(kind)))
        return self._bytes(count, np.dtype(">" + name)) if self._binary else self._text(count, name)

    def skip_values(self, count: int, kind: bytes) -> None:
        """Skip the next ``count`` values of a type, possibly texts or bits."""
        name = kind.lower()
        if name == b"string":
            self.position = self._line_end()
            for _ in range(count):
                self._skip_text()
        elif name == b"bit":
            self.read_array(*((-(-count // 8), b"unsigned_char") if self._binary else (count, b"int")))
        else:
            self.read_array(count, kind)

    def _skip_text(self) -> None:
        """Skip a line of text, or in a binary file a length and that many bytes."""
        if self.position >= len(self.content):
            raise ValueError(tr("it ends early"))
        if not self._binary:
            self.position = self.content.find(b"\n", self.position) + 1 or len(self.content)
            return
        size = 8 >> (self.content[self.position] >> 6)  # bytes of the length field, from its first two bits
        number = int.from_bytes(self.content[self.position : self.position + size], "big")
        self.position += size + number % (1 << 8 * size - 2)

    def _line_end(self) -> int:
        """Offset after the blank rest of a line."""
        space = _SPACE.match(self.content, self.position)
        assert space is not None  # always found: the pattern also matches the empty string
        return space.end()

    def _bytes(self, count: int, dtype: np.dtype) -> LegacyArray:
        start = self._line_end()
        end = start + count * dtype.itemsize
        if end > len(self.content):
            raise ValueError(tr("it ends early"))
        self.position = end
        return LegacyArray(np.frombuffer(self.content, dtype, count, start), start, end, False)

    def _text(self, count: int, name: str) -> LegacyArray:
        if 2 * count > len(self.content) - self.position + 1:
            raise ValueError(tr("it ends early"))
        start = self.position
        if count:
            last = next(islice(_WORDS.finditer(self.content, start), count - 1, None), None)
            if last is None:
                raise ValueError(tr("it ends early"))
            self.position = last.end()
        values = text_values(self.content[start : self.position], name)
        return LegacyArray(values, start, self.position, True)

    def skip_metadata(self) -> tuple[int, int]:
        """Skip the metadata of an array; return their span."""
        if self.peek_word() != "METADATA":
            return self.position, self.position
        start = self.position
        self.read_word()
        found = _METADATA_END.search(self.content, self.position)
        assert found is not None  # always found: the pattern also matches the end of the file
        self.position = found.end()
        return start, self.position
