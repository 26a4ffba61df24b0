"""Legacy VTK files of surfaces, ``.vtk``: read, and rewritten in place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.parsed_mesh import ParsedMesh
from apd_viewer.files.formats.polygons import Polygons, concatenated
from apd_viewer.files.vtk.cells import POLYGON, STRIP, cell_faces, cells_to_polygons, point_positions
from apd_viewer.files.vtk.legacy_reader import LegacyArray, LegacyReader
from apd_viewer.files.vtk.splices import Splice, spliced_content
from apd_viewer.files.vtk.text_values import with_replaced_values
from apd_viewer.files.vtk.xml_arrays import retyped_array
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
    """Content of a legacy file, and the place of its points."""

    content: bytes
    points: LegacyArray
    points_metadata: tuple[int, int]
    other_data: tuple[str, ...]
    suffix = ".vtk"

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        return self.other_data

    @property
    def colors(self) -> None:
        """None: its data are values, and not colours."""

    def normals(self, _: Mesh) -> None:
        """None: the data of points stay as they are."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3); all data as they were."""
        if np.array_equal(mesh.V, U):
            return self.content
        return spliced_content(self.content, [self._of_points(U.ravel()), *self._norms(U)])

    def _of_points(self, values: np.ndarray) -> Splice:
        old, start, end, is_text = self.points
        if is_text:
            return Splice(start, end, with_replaced_values(self.content[start:end], old, values))
        return Splice(start, end, retyped_array(old, values).tobytes())

    def _norms(self, U: np.ndarray) -> Iterator[Splice]:
        """Least and largest distance from the origin, where the file has them."""
        size = np.linalg.norm(U, axis=1)
        for found in _NORMS.finditer(self.content, *self.points_metadata):
            yield Splice(*found.span(1), b"%g" % size.min())
            yield Splice(*found.span(2), b"%g" % size.max())


@dataclass
class _Found:
    """Parts of the file met so far."""

    points: LegacyArray | None = None
    about_points: tuple[int, int] = (0, 0)
    cells: Polygons | None = None
    types: np.ndarray | None = None
    polygons: dict[str, Polygons] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)


def read_vtk(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of a legacy file of a surface.

    Raises
    ------
    ValueError
        If it cannot be understood.
    InputError
        If it holds something else than a surface.
    """
    head = _HEAD.match(content[:1000])
    if head is None:
        raise ValueError(tr("it does not start as a VTK file does"))
    reader = LegacyReader(content, head.end(), head[2].upper() == b"BINARY")
    found = _Found()
    kind = _read(reader, found, lists_offsets=int(head[1]) >= 5)
    if found.points is None:
        raise ValueError(tr("it has no points"))
    V = point_positions(found.points.values)
    faces = _grid_faces(found) if kind == "UNSTRUCTURED_GRID" else _poly_faces(found)
    origin = VtkLegacyFile(content, found.points, found.about_points, tuple(dict.fromkeys(found.others)))
    return ParsedMesh(V, faces.triangles(V), origin)


def _read(reader: LegacyReader, found: _Found, lists_offsets: bool) -> str:
    """Read up to the data of points and cells; the kind of the data set."""
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
            found.others.append(_DATA[word])
            _skip_field(reader)
        elif word == "POINTS":
            found.points = reader.read_array(3 * reader.read_count(), reader.read_word())
            found.about_points = reader.skip_metadata()
        elif word == "CELL_TYPES":
            found.types = reader.read_array(reader.read_count(), b"int").values
        elif word == "CELLS":
            found.cells = _cells(reader, found, lists_offsets)
        elif word in _KINDS:
            found.polygons[word] = _cells(reader, found, lists_offsets)
        elif word == "METADATA":
            reader.position -= len(word)
            reader.skip_metadata()
        else:
            raise ValueError(tr("it has an unknown part {text}").format(text=f"“{word}”"))
    for match in re.finditer(rb"^(POINT_DATA|CELL_DATA)\b", reader.content[reader.position :], re.MULTILINE):
        found.others.append(_DATA[match[1].decode()])
    return kind


def _skip_field(reader: LegacyReader) -> None:
    reader.read_word()
    for _ in range(reader.read_count()):
        reader.read_word()
        count = reader.read_count() * reader.read_count()
        reader.skip_values(count, reader.read_word())
        reader.skip_metadata()


def _cells(reader: LegacyReader, found: _Found, lists_offsets: bool) -> Polygons:
    """Cells as offsets and connectivity, or as one list with their sizes."""
    points = 0 if found.points is None else len(found.points.values) // 3
    first, second = reader.read_count(), reader.read_count()
    if not lists_offsets:
        return _counted(reader.read_array(second, b"int").values.astype(np.int64), first, points)
    if not first:
        return concatenated([])
    offsets = _named(reader, "OFFSETS", first)
    return cells_to_polygons(_named(reader, "CONNECTIVITY", second), offsets, points)


def _named(reader: LegacyReader, name: str, count: int) -> np.ndarray:
    if reader.peek_word() != name:
        raise ValueError(tr("its cells have no {name}").format(name=name.lower()))
    reader.read_word()
    values = reader.read_array(count, reader.read_word()).values
    reader.skip_metadata()
    return values


def _counted(row: np.ndarray, cells: int, points: int) -> Polygons:
    """Cells of one list (k,) with their sizes among their vertices."""
    places, at, said = [], 0, row.tolist()
    for _ in range(cells):
        if at >= len(said) or said[at] < 0:
            raise ValueError(tr("its cells do not fit the list of their vertices"))
        places.append(at)
        at += said[at] + 1
    heads = np.array(places, dtype=np.int64)
    start = np.concatenate([[0], np.cumsum(row[heads])]) if cells else np.zeros(1, dtype=np.int64)
    return cells_to_polygons(np.delete(row, heads), start, points)


def _grid_faces(found: _Found) -> Polygons:
    if found.cells is None or found.types is None:
        return concatenated([])
    return cell_faces(found.cells, found.types)


def _poly_faces(found: _Found) -> Polygons:
    """Polygons, then the triangles of strips."""
    parts = []
    for name in ("POLYGONS", "TRIANGLE_STRIPS"):
        cells = found.polygons.get(name)
        if cells is not None:
            parts.append(cell_faces(cells, np.full(len(cells.start) - 1, _KINDS[name])))
    return concatenated(parts)
