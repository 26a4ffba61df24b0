"""VTK XML surface files (``.vtp``, ``.vtu``): reading, and rewriting in place."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import ParsedMesh, Polygons, concatenated_polygons
from apd_viewer.files.formats.text import Splice, spliced_content
from apd_viewer.files.vtk.cells import POLYGON, STRIP, cell_faces, cells_to_polygons, point_positions
from apd_viewer.files.vtk.xml_arrays import XmlArray, XmlArrays
from apd_viewer.files.vtk.xml_elements import XmlElement
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_KINDS = {".vtp": "PolyData", ".vtu": "UnstructuredGrid"}
_DATA = {"PointData": tr("point data"), "CellData": tr("cell data"), "FieldData": tr("field data")}
_ARRAYS = "DataArray", "Array"
_LONGEST = 40  # maximum number of characters of the listed array names


class _Points(NamedTuple):
    """Points of a piece: element, stored values and first vertex in the mesh."""

    element: XmlElement
    stored: XmlArray
    first: int


@dataclass(frozen=True)
class VtkXmlFile:
    """Content of a VTK XML file, and the spans of its points."""

    arrays: XmlArrays
    points: tuple[_Points, ...]
    suffix: str

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        found: dict[str, list[str]] = {}
        for element in self.arrays.root.walk():
            for array in element.children_named(*_ARRAYS) if element.name in _DATA else ():
                names = found.setdefault(element.name, [])
                names += [name for name in [array.attributes.get("Name", "")] if name not in names]
        return tuple(f"{_DATA[kind]} ({', '.join(names)[:_LONGEST]})" for kind, names in found.items())

    @property
    def colors(self) -> None:
        """None: data arrays are values, not colours."""

    def normals(self, _: Mesh) -> None:
        """None: point data stay unchanged, including normals."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3); all data arrays unchanged.

        Raises
        ------
        InputError
            If the places of other arrays, which have to be moved, cannot be understood.
        """
        try:
            return spliced_content(self.arrays.content, self._splices(mesh.V, U))
        except ValueError as error:
            sentence = tr("The file that was opened is damaged ({reason}); choose another format.")
            raise InputError(sentence.format(reason=error)) from error

    def data_values(self, kind: str, name: str) -> np.ndarray | None:
        """Data array of the "PointData" or "CellData"; None if there is none."""
        found = [
            self.arrays.read(array).values.astype(np.float64)
            for element in self.arrays.root.walk()
            for array in (element.children_named(*_ARRAYS) if element.name == kind else ())
            if array.attributes.get("Name") == name
        ]
        return np.concatenate(found) if found else None

    def _splices(self, V: np.ndarray, U: np.ndarray) -> Iterator[Splice]:
        for element, stored, first in self.points:
            there = slice(first, first + len(stored.values) // 3)
            if np.array_equal(V[there], U[there]):
                continue
            new = self.arrays.rewritten_content(element, stored, U[there].ravel())
            yield Splice(stored.start, stored.end, new)
            yield from _range_updates(self.arrays.content, element, U[there])
            if element.attributes.get("format") == "appended":
                yield from self._offset_updates(
                    element.int_attribute("offset"), len(new) - (stored.end - stored.start)
                )

    def _offset_updates(self, offset: int, by: int) -> Iterator[Splice]:
        """Updates of the array offsets after an array of changed length."""
        for element in self.arrays.root.walk() if by else ():
            if element.attributes.get("format") == "appended" and element.int_attribute("offset") > offset:
                span = element.attribute_span(self.arrays.content, "offset")
                if span is not None:
                    yield Splice(*span, by)


def read_vtp(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of a PolyData file; raises ValueError."""
    return _read(content, ".vtp")


def read_vtu(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of a flat UnstructuredGrid file.

    Raises ValueError on invalid content, InputError on volume cells.
    """
    return _read(content, ".vtu")


def _read(content: bytes, suffix: str) -> ParsedMesh:
    arrays = XmlArrays(content)
    kind = arrays.root.attributes.get("type", "")
    if kind != _KINDS[suffix]:
        raise InputError(_kind_error_message(kind))
    grid = arrays.root.first_child(kind)
    pieces = grid.children_named("Piece") if grid is not None else []
    points, faces, count = [], [], 0
    for piece in pieces:
        element, stored = _points_of(arrays, piece)
        if element is None:
            continue
        n = len(stored.values) // 3
        polygons = _cells(arrays, piece, n) if suffix == ".vtu" else _polys(arrays, piece, n)
        points.append(_Points(element, stored, count))
        faces.append(Polygons(polygons.corner + count, polygons.start))
        count += n
    V = [point_positions(each.stored.values) for each in points]
    X = np.vstack([np.empty((0, 3)), *V])
    return ParsedMesh(X, concatenated_polygons(faces).triangles(X), VtkXmlFile(arrays, tuple(points), suffix))


def _kind_error_message(kind: str) -> str:
    """Error sentence for a VTK data set kind not matching the suffix."""
    suffix = next((suffix for suffix, own in _KINDS.items() if own == kind), None)
    if suffix is not None:
        return tr("The file holds another kind of surface; rename it to end in {ending}.").format(
            ending=suffix
        )
    return tr("The file holds no surface of its own; save the surface as one .vtp file.")


def _points_of(arrays: XmlArrays, piece: XmlElement) -> tuple[XmlElement | None, XmlArray]:
    """Element and values of a piece's points; None if it has none."""
    n, points = piece.int_attribute("NumberOfPoints"), piece.first_child("Points")
    found = points.children_named("DataArray") if points is not None else []
    if not found or not n:
        return None, XmlArray(np.empty(0), 0, 0)
    if len(found) > 1:
        raise ValueError(tr("it holds several time steps; save one of them"))
    stored = arrays.read(found[0])
    if len(stored.values) != 3 * n:
        raise ValueError(tr("the number of its points differs from what it declares"))
    return found[0], stored


def _array(arrays: XmlArrays, group: XmlElement, name: str) -> np.ndarray:
    for element in group.children_named("DataArray"):
        if element.attributes.get("Name") == name:
            return arrays.read(element).values
    raise ValueError(tr("its cells have no {name}").format(name=name))


def _group(arrays: XmlArrays, group: XmlElement, points: int, count: int) -> Polygons:
    offsets = _array(arrays, group, "offsets")
    if len(offsets) != count:
        raise ValueError(
            tr("it declares {declared:,} cells and has {there:,}").format(declared=count, there=len(offsets))
        )
    start = np.concatenate([np.zeros(1, dtype=offsets.dtype), offsets])
    return cells_to_polygons(_array(arrays, group, "connectivity"), start, points)


def _polys(arrays: XmlArrays, piece: XmlElement, points: int) -> Polygons:
    """Polygons, then the triangles of strips."""
    found = []
    for name, kind in (("Polys", POLYGON), ("Strips", STRIP)):
        group = piece.first_child(name)
        if group is not None and piece.int_attribute(f"NumberOf{name}"):
            cells = _group(arrays, group, points, piece.int_attribute(f"NumberOf{name}"))
            found.append(cell_faces(cells, np.full(len(cells.start) - 1, kind)))
    return concatenated_polygons(found)


def _cells(arrays: XmlArrays, piece: XmlElement, points: int) -> Polygons:
    group = piece.first_child("Cells")
    if group is None or not piece.int_attribute("NumberOfCells"):
        return concatenated_polygons([])
    types = _array(arrays, group, "types")
    return cell_faces(_group(arrays, group, points, piece.int_attribute("NumberOfCells")), types)


def _range_updates(content: bytes, element: XmlElement, U: np.ndarray) -> Iterator[Splice]:
    """Updates of the stored ranges of distances from the origin, if any."""
    size = np.linalg.norm(U, axis=1)
    ends = [b"%r" % float(size.min()), b"%r" % float(size.max())]
    for name, said in zip(("RangeMin", "RangeMax"), ends, strict=True):
        span = element.attribute_span(content, name)
        if span is not None and content[slice(*span)].strip():
            yield Splice(*span, said)
    for key in element.children_named("InformationKey"):
        if not key.attributes.get("name", "").startswith("L2_NORM_"):
            continue
        for value in key.children_named("Value"):
            found = re.search(rb"\S+", content[value.inside : value.end])
            if found is not None and value.attributes.get("index") in ("0", "1"):
                start, end = (value.inside + place for place in found.span())
                yield Splice(start, end, ends[int(value.attributes["index"])])
