"""Wall distributions in files: the thickness of a wall at each place."""

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.ply import PlyFile
from apd_viewer.files.meshes import read_mesh
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.files.tables import write_table
from apd_viewer.files.vtk.xml_surface import VtkXmlFile
from apd_viewer.geometry.energy.thickness_map import (
    ThicknessMap,
    check_positive,
    interpolated_values,
    triangle_means,
    triangle_thickness,
)
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.up_axis import standing_axis
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS, parse_length
from apd_viewer.session.quantities.units import SYMBOLS, NoUnitError, Unit

TABLE_SUFFIX = ".csv"
DISTRIBUTION_SUFFIXES = (TABLE_SUFFIX, ".ply", ".vtp", ".vtu")
_THICKNESS, _HEIGHT, _AXES = "thickness", "height", "xyz"
_ROWS = {"vertex": "vertex", "index": "vertex", "triangle": "triangle"}
# A column and its unit: thickness, thickness_mm or thickness (mm).
_COLUMN = re.compile(rf"([a-z]+?)(?:[\s_]*[\[(]?({'|'.join(SYMBOLS)})[\])]?)?", re.IGNORECASE)
_FARTHEST = 0.05  # of the diagonal: distance of a measured point from the nearest vertex


class WallDistribution(str):
    """Name of a file with a wall distribution, typed as the thickness of a wall.

    Attributes
    ----------
    thickness : ThicknessMap
    unit : str
        Symbol of the unit of the thickness; empty for that of the mesh.
    """

    __slots__ = ("thickness", "unit")
    thickness: ThicknessMap
    unit: str

    def __new__(cls, name: str, thickness: ThicknessMap, unit: str = "") -> "WallDistribution":
        """Name of a file, and what it says."""
        made = super().__new__(cls, name)
        made.thickness, made.unit = thickness, unit
        return made

    def __getnewargs__(self) -> tuple[str, ThicknessMap, str]:  # type: ignore[override]
        """Arguments that make a copy."""
        return str(self), self.thickness, self.unit

    def in_unit(self, unit: Unit) -> ThicknessMap:
        """Thickness in the ``unit`` of the mesh; raises InputError if unknown."""
        return (
            self.thickness.scaled(parse_length(f"1 {self.unit}", unit, {})) if self.unit else self.thickness
        )

    def on(self, mesh: Mesh) -> "WallDistribution":
        """The same thickness of the triangles on another rest shape."""
        thickness = triangle_thickness(self.thickness.triangles, mesh.V, mesh.F)
        return WallDistribution(str(self), thickness, self.unit)

    def __eq__(self, other: object) -> bool:
        """True for the same name, thickness and unit."""
        if not isinstance(other, WallDistribution):
            return False
        own, others = ((str(each), each.unit, each.thickness) for each in (self, other))
        return own == others

    def __ne__(self, other: object) -> bool:
        """True unless name, thickness and unit are the same."""
        return not self == other

    def __hash__(self) -> int:
        """Hash of the name."""
        return str.__hash__(self)


def thickness_text(typed: str, mesh: Mesh, unit: Unit) -> str:
    """Thickness as typed; if that names a file, with its wall distribution."""
    path = Path(typed)
    return read_distribution(path, mesh, unit) if path.suffix.lower() in DISTRIBUTION_SUFFIXES else typed


def read_distribution(path: Path, mesh: Mesh, unit: Unit) -> WallDistribution:
    """Wall distribution from a file, on a mesh in ``unit``.

    A table has a heading: ``vertex,thickness`` or ``triangle,thickness`` (from 0, in any order),
    ``x,y,z,thickness`` for measured points, or ``height,thickness``, also with x, y or z in place of the
    height. A unit may follow a name, as in ``thickness (mm)``; other numbers are in mesh units. PLY, VTP and
    VTU files of the mesh have a vertex or face property of the name ``thickness``.

    Raises
    ------
    InputError
        If it cannot be read, or does not fit the mesh.
    """
    content = read_content(path)
    try:
        if path.suffix.lower() == TABLE_SUFFIX:
            values, symbol = _ThicknessTable(content.decode("utf-8-sig", "replace"), unit).thickness_on(mesh)
        else:
            values, symbol = _stored_property(read_mesh(path, content), mesh), ""
        check_positive(values)
        thickness = triangle_thickness(values, mesh.V, mesh.F)
    except NoUnitError:
        raise
    except (InputError, csv.Error) as error:
        raise InputError(f"{path.name}: {str(error).removeprefix(f'{path.name}: ')}") from error
    return WallDistribution(path.name[:MOST_CHARACTERS], thickness, symbol)


def write_distribution(path: Path, thickness: ThicknessMap) -> None:
    """Write the thickness of every triangle as a table; raises InputError."""
    rows = np.column_stack([np.arange(len(thickness.triangles)), thickness.triangles])
    write_table(path, ("triangle", _THICKNESS), rows)


def _stored_property(found: Mesh, mesh: Mesh) -> np.ndarray:
    """Thickness (m,) by a property of the vertices or faces of the mesh in a file."""
    if not np.array_equal(found.F, mesh.F):
        raise InputError(tr("It is of another mesh: its triangles differ."))
    for of_vertices in (True, False):
        origin, values, count = found.origin, None, len(found.V) if of_vertices else len(mesh.F)
        if isinstance(origin, PlyFile):
            values = origin.property_values("vertex" if of_vertices else "face", _THICKNESS)
        elif isinstance(origin, VtkXmlFile):
            values = origin.data_values("PointData" if of_vertices else "CellData", _THICKNESS)
        if values is not None and len(values) == count:
            return triangle_means(values, mesh.F) if of_vertices else values
    raise InputError(tr("It has no property “{name}” of vertices or triangles.").format(name=_THICKNESS))


class _ThicknessTable:
    """Table of numbers with a heading.

    Parameters
    ----------
    text : str
        Cells apart by commas, by tabs, or by semicolons with decimal commas.
    unit : Unit
        Of the mesh.
    """

    def __init__(self, text: str, unit: Unit) -> None:
        heading = text.lstrip().partition("\n")[0]
        comma = next((sign for sign in ";\t" if sign in heading), ",")
        rows = [row for row in csv.reader(text.splitlines(), delimiter=comma) if any(map(str.strip, row))]
        self._names: dict[str, int] = {}
        self._symbols: dict[str, str] = {}
        for k, cell in enumerate(rows[0] if rows else ()):
            if (column := _COLUMN.fullmatch(cell.strip())) is not None:
                name = column[1].lower()
                self._names[name], self._symbols[name] = k, (column[2] or "").lower()
        self._rows, self._comma, self._unit = rows[1:], "," if comma == ";" else ".", unit

    def thickness_on(self, mesh: Mesh) -> tuple[np.ndarray, str]:
        """Thickness (m,) of the triangles, and the symbol of its unit."""
        rows = next((name for name in _ROWS if name in self._names), None)
        axes = [axis for axis in (_HEIGHT, *_AXES) if axis in self._names]
        if _THICKNESS not in self._names or not self._rows or not (rows or axes):
            raise InputError(
                tr(
                    "A table of thickness needs rows below a heading such as vertex,thickness or "
                    "x,y,z,thickness or height,thickness."
                )
            )
        values = self._column(_THICKNESS)
        check_positive(values)
        if rows:
            is_vertex = _ROWS[rows] == "vertex"
            values = _in_order(self._column(rows), values, len(mesh.V) if is_vertex else len(mesh.F))
            if not is_vertex:
                return values, self._symbols[_THICKNESS]
        elif axes == list(_AXES):
            points = np.column_stack([self._column(axis) * self._factor(axis) for axis in axes])
            values = interpolated_values(points, values, mesh.V, _FARTHEST * diagonal(mesh.V))
        else:
            values = self._along(axes, values, mesh)
        return triangle_means(values, mesh.F), self._symbols[_THICKNESS]

    def _along(self, axes: Sequence[str], values: np.ndarray, mesh: Mesh) -> np.ndarray:
        """Thickness at the vertices of a mesh, interpolated along one axis."""
        if len(axes) > 1:
            raise InputError(tr("Points need x, y and z; a profile has only one of them, or height."))
        (axis,) = axes
        if axis != _HEIGHT:
            at = mesh.V[:, _AXES.index(axis)]
        elif (up := standing_axis(mesh)) is not None:
            at = mesh.V @ up.direction
            at = at - at[mesh.F].min()
        else:
            raise InputError(
                tr("The side on which the shape stands is not clear; name the column x, y or z, not height.")
            )
        known = self._column(axis) * self._factor(axis)
        order = np.argsort(known, kind="stable")
        return np.interp(at, known[order], values[order])

    def _factor(self, name: str) -> float:
        """Mesh units in one unit of a column."""
        symbol = self._symbols[name]
        return parse_length(f"1 {symbol}", self._unit, {}) if symbol else 1.0

    def _column(self, name: str) -> np.ndarray:
        """Numbers of a column; raises InputError."""
        numbers, k = [], self._names[name]
        for line, row in enumerate(self._rows, start=2):
            cell = row[k].strip() if k < len(row) else ""
            try:
                numbers.append(float(cell.replace(self._comma, ".")))
            except ValueError:
                sentence = tr("Row {line:,} has “{cell}” in place of a number.")
                raise InputError(sentence.format(line=line, cell=cell[:20])) from None
        return np.array(numbers)


def _in_order(ids: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Values in the order of ``ids`` from 0 to ``count``; raises InputError."""
    if len(values) != count or not np.array_equal(np.sort(ids), np.arange(count)):
        sentence = tr("It has {rows:,} rows, but the mesh needs each number from 0 to {last:,} once.")
        raise InputError(sentence.format(rows=len(values), last=count - 1))
    return values[np.argsort(ids)]
