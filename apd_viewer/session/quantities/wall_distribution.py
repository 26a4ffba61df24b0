"""Wall distributions in files: thickness, modulus and yield radius at each place."""

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.ply import PlyFile
from apd_viewer.files.gltf.gltf_file import GltfFile
from apd_viewer.files.meshes import invalid_file_message, read_mesh
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.files.tables import write_table
from apd_viewer.files.vtk.xml_surface import VtkXmlFile
from apd_viewer.geometry.energy.wall_map import (
    WallMap,
    check_positive,
    interpolated_values,
    triangle_means,
    triangle_wall,
    vertices_at,
)
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import DerivedOrigin, Mesh, Origin
from apd_viewer.geometry.mesh.weld import SEAM_TOLERANCE
from apd_viewer.language import tr
from apd_viewer.session.model.up_axis import standing_axis
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS, parse_length
from apd_viewer.session.quantities.units import SYMBOLS, NoUnitError, Unit
from apd_viewer.session.quantities.wall_material import MODULI, parse_young_modulus

TABLE_SUFFIX = ".csv"
DISTRIBUTION_SUFFIXES = (TABLE_SUFFIX, ".ply", ".vtp", ".vtu", ".glb", ".gltf")
_THICKNESS, _YOUNG, _RADIUS = "thickness", "young", "yield_radius"
_HEIGHT, _AXES = "height", "xyz"
_ROWS = {"vertex": "vertex", "index": "vertex", "triangle": "triangle"}
# A column and its unit: thickness, thickness_mm, thickness (mm) or young (MPa).
_UNIT = r"(?:[\s_]*[\[(]?({})[\])]?)?"
_COLUMN = re.compile(rf"(yield[\s_]radius|(?!young)[a-z]+?){_UNIT.format('|'.join(SYMBOLS))}", re.IGNORECASE)
_MODULUS = re.compile(rf"(young){_UNIT.format('|'.join(MODULI))}", re.IGNORECASE)
_COLORED = re.compile(r"(.+):([^:/\\]+\.\.[^:/\\]+)")  # a file, and the thickness of black and white
_GREY = 2 / 255  # largest difference of the parts of a grey colour
_FARTHEST = 0.05  # of the diagonal: distance of a measured point from the nearest vertex


class WallDistribution(str):
    """Name of a wall distribution, such as its file, typed as a thickness.

    Attributes
    ----------
    thickness : WallMap
    unit : str
        Symbol of the unit of the thickness; empty for that of the mesh.
    """

    __slots__ = ("thickness", "unit")
    thickness: WallMap
    unit: str

    def __new__(cls, name: str, thickness: WallMap, unit: str = "") -> "WallDistribution":
        """Name of a file, and what it says."""
        made = super().__new__(cls, name)
        made.thickness, made.unit = thickness, unit
        return made

    def __getnewargs__(self) -> tuple[str, WallMap, str]:  # type: ignore[override]
        """Arguments that make a copy."""
        return str(self), self.thickness, self.unit

    def in_unit(self, unit: Unit) -> WallMap:
        """Thickness in the ``unit`` of the mesh; raises InputError if unknown."""
        return (
            self.thickness.scaled(parse_length(f"1 {self.unit}", unit, {})) if self.unit else self.thickness
        )

    def on(self, mesh: Mesh) -> "WallDistribution":
        """The same wall of the triangles on another rest shape."""
        return WallDistribution(str(self), self.thickness.on(mesh.V, mesh.F), self.unit)

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


class ColorScaleError(InputError):
    """Colours in place of a thickness, and nobody says that of black and white."""


def distribution_file(typed: str) -> tuple[Path, str] | None:
    """File of a wall distribution and scale of its colours; None for a length."""
    found = _COLORED.fullmatch(typed)
    path, scale = (Path(found[1]), found[2]) if found else (Path(typed), "")
    return (path, scale) if path.suffix.lower() in DISTRIBUTION_SUFFIXES else None


def thickness_text(typed: str, mesh: Mesh, unit: Unit) -> str:
    """Thickness as typed; if that names a file, with its wall distribution."""
    file = distribution_file(typed)
    return typed if file is None else read_distribution(file[0], mesh, unit, file[1])


def read_distribution(path: Path, mesh: Mesh, unit: Unit, scale: str = "") -> WallDistribution:
    """Wall distribution from a file, on a mesh in ``unit``.

    A table has a heading: ``vertex,thickness`` or ``triangle,thickness`` (from 0, in any order),
    ``x,y,z,thickness`` for measured points, or ``height,thickness``, also with x, y or z in place of the
    height. Columns ``young`` and ``yield_radius`` may be beside it. A unit may follow a name, as in
    ``thickness (mm)``; other numbers are in mesh units and GPa. PLY, VTP and VTU files of the mesh have
    vertex or face properties of these names, GLB and glTF files vertex attributes such as ``_THICKNESS``.
    With a ``scale`` such as ``0.2mm..0.8mm`` the thickness is that of grey or red colours at the vertices,
    from black to white, in proportion to the stored numbers.

    Raises
    ------
    ColorScaleError
        If it has colours but no thickness, and there is no scale.
    InputError
        If it cannot be read, or does not fit the mesh.
    """
    content = read_content(path)
    try:
        if path.suffix.lower() == TABLE_SUFFIX:
            thickness, symbol = _WallTable(content.decode("utf-8-sig", "replace"), unit).wall_on(mesh)
        else:
            ends = tuple(parse_length(end, unit, {}) for end in scale.split("..")) if scale else ()
            thickness, symbol = _stored_wall(read_mesh(path, content), mesh, ends), ""
    except NoUnitError:
        raise
    except (InputError, csv.Error) as error:
        kind = ColorScaleError if isinstance(error, ColorScaleError) else InputError
        raise kind(f"{path.name}: {str(error).removeprefix(f'{path.name}: ')}") from error
    except ValueError as error:  # attributes are not validated on reading
        raise InputError(invalid_file_message(content, path, error)) from error
    name = f"{path.name}:{scale}" if scale else path.name
    return WallDistribution(name[:MOST_CHARACTERS], thickness, symbol)


def write_distribution(path: Path, thickness: WallMap) -> None:
    """Write the wall of every triangle as a table; raises InputError."""
    columns = {"triangle": np.arange(len(thickness.triangles)), _THICKNESS: thickness.triangles}
    if thickness.young is not None:
        columns[f"{_YOUNG} (Pa)"] = thickness.young.triangles
    if thickness.yield_radius is not None:
        columns[_RADIUS] = thickness.yield_radius.triangles
    write_table(path, tuple(columns), np.column_stack([*columns.values()]))


def _stored_wall(found: Mesh, mesh: Mesh, scale: Sequence[float]) -> WallMap:
    """Wall by properties of the vertices or faces of the mesh in a file."""
    at = np.arange(len(mesh.V)) if np.array_equal(found.F, mesh.F) else None
    if at is None and len(found.F) == len(mesh.F):  # the same in another order
        at = vertices_at(mesh.V, found.V, SEAM_TOLERANCE * diagonal(mesh.V))
    if at is None:
        raise InputError(tr("It is of another mesh: its triangles differ."))
    thickness, young, radius = (
        _stored_property(found, mesh, name, at) for name in (_THICKNESS, _YOUNG, _RADIUS)
    )
    if (scale or thickness is None) and (colored := _thickness_of_colors(found, scale)) is not None:
        thickness = triangle_means(colored[at], mesh.F)
    if thickness is None:
        raise InputError(tr("It has no property “{name}” of vertices or triangles.").format(name=_THICKNESS))
    return _checked_wall(mesh, thickness, None if young is None else _pascals(young, ""), radius)


def _file_of(mesh: Mesh) -> Origin | None:
    """File of a mesh, whatever its encoding."""
    origin = mesh.origin
    while isinstance(origin, DerivedOrigin):
        origin = origin.origin
    return origin


def _stored_property(found: Mesh, mesh: Mesh, name: str, at: np.ndarray) -> np.ndarray | None:
    """Property (m,) of the vertices ``at`` (n,) of a file, or its faces; None without."""
    for of_vertices in (True, False) if np.array_equal(found.F, mesh.F) else (True,):
        origin, values, count = _file_of(found), None, len(found.V) if of_vertices else len(mesh.F)
        if isinstance(origin, PlyFile):
            values = origin.property_values("vertex" if of_vertices else "face", name)
        elif isinstance(origin, GltfFile):
            values = origin.vertex_values(name) if of_vertices else None
        elif isinstance(origin, VtkXmlFile):
            values = origin.data_values("PointData" if of_vertices else "CellData", name)
        if values is not None and len(values) == count:
            return triangle_means(values[at], mesh.F) if of_vertices else values
    return None


def _thickness_of_colors(found: Mesh, scale: Sequence[float]) -> np.ndarray | None:
    """Thickness by grey or red colours of the vertices in a file; None without."""
    origin, colors = _file_of(found), None
    if isinstance(origin, GltfFile):
        colors = origin.linear_colors
    elif isinstance(origin, PlyFile) and origin.colors is not None:
        colors = origin.colors / 255.0
    if colors is None or len(colors) != len(found.V):
        return None
    if len(scale) != 2:
        raise ColorScaleError(
            tr("It has colours in place of a thickness; add that of black and white, such as :0.2mm..0.8mm.")
        )
    red, *others = colors.astype(np.float64).T
    if max(np.abs(red - other).max() for other in others) > _GREY and any(other.any() for other in others):
        raise InputError(tr("Its colours are neither grey nor red, so they are no thickness."))
    black, white = scale
    return np.asarray((1.0 - red) * black + red * white)


def _checked_wall(
    mesh: Mesh, thickness: np.ndarray, young: np.ndarray | None, radius: np.ndarray | None
) -> WallMap:
    check_positive(thickness)
    if radius is not None:
        check_positive(radius, tr("The yield radius"))
    return triangle_wall(thickness, mesh.V, mesh.F, young, radius)


def _pascals(values: np.ndarray, symbol: str) -> np.ndarray:
    """Moduli in Pa from numbers in a unit, by default GPa; raises InputError."""
    few, at = np.unique(values, return_inverse=True)
    return np.array([parse_young_modulus(f"{each!r} {symbol}") for each in few.tolist()])[at]


class _WallTable:
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
            column = _MODULUS.fullmatch(cell.strip()) or _COLUMN.fullmatch(cell.strip())
            if column is not None:
                name = column[1].lower().replace(" ", "_")
                self._names[name], self._symbols[name] = k, (column[2] or "").lower()
        self._rows, self._comma, self._unit = rows[1:], "," if comma == ";" else ".", unit

    def wall_on(self, mesh: Mesh) -> tuple[WallMap, str]:
        """Wall of the triangles, and the symbol of the unit of its thickness."""
        is_placed = any(name in self._names for name in (*_ROWS, _HEIGHT, *_AXES))
        if _THICKNESS not in self._names or not self._rows or not is_placed:
            raise InputError(
                tr(
                    "A table of thickness needs rows below a heading such as vertex,thickness or "
                    "x,y,z,thickness or height,thickness."
                )
            )
        check_positive(self._column(_THICKNESS))
        values = self._of_triangles(self._column(_THICKNESS), mesh)
        symbol, young, radius = self._symbols[_THICKNESS], None, None
        if _YOUNG in self._names:
            young = self._of_triangles(_pascals(self._column(_YOUNG), self._symbols[_YOUNG]), mesh)
        if _RADIUS in self._names:
            radius = self._of_triangles(self._column(_RADIUS), mesh)
            if self._symbols[_RADIUS] != symbol:
                radius = radius * (self._factor(_RADIUS) / self._factor(_THICKNESS))
        return _checked_wall(mesh, values, young, radius), symbol

    def _of_triangles(self, values: np.ndarray, mesh: Mesh) -> np.ndarray:
        """Values (m,) of the triangles from those of the rows."""
        rows = next((name for name in _ROWS if name in self._names), None)
        axes = [axis for axis in (_HEIGHT, *_AXES) if axis in self._names]
        if rows:
            is_vertex = _ROWS[rows] == "vertex"
            values = _in_order(self._column(rows), values, len(mesh.V) if is_vertex else len(mesh.F))
            if not is_vertex:
                return values
        elif axes == list(_AXES):
            points = np.column_stack([self._column(axis) * self._factor(axis) for axis in axes])
            values = interpolated_values(points, values, mesh.V, _FARTHEST * diagonal(mesh.V))
        else:
            values = self._along(axes, values, mesh)
        return triangle_means(values, mesh.F)

    def _along(self, axes: Sequence[str], values: np.ndarray, mesh: Mesh) -> np.ndarray:
        """Values at the vertices of a mesh, interpolated along one axis."""
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
