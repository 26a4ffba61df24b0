"""Ground: a grid under the rest shape, and the shadow of the shape on it."""

import numpy as np
import pyvista as pv
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkTexture

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_position, format_short, round_step
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.scene.ghost import RestActor
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

_LINES = 12  # approximate number of grid cells across the mesh
_AROUND = 0.3  # margin of the grid, as a fraction of the mesh size
_APART = 34.0  # px: minimum spacing of two labels
_BETWEEN = 6  # px: minimum gap between two labels
_BELOW = 108.0  # px: place of the length of the grid from the upper edge, below the axes
_CELLS = 64  # of the picture of the shadow, along each side
_SAMPLES = 40_000  # points on the surface whose shadows are added up
_BLUR = 4.0  # cells
_SHADOW_MARGIN = 0.3  # around the surface, as a fraction of its larger side on the ground
_REACH = 0.3  # height at which a shadow has faded to a third, as a fraction of the size of the surface
_DEPTH = 0.002  # depth of the ground under the lowest point, as a fraction of the size
_DARKEST = {False: 0.36, True: 0.6}  # opacity by whether the background is dark
_SHADOW_COLOR = 18, 22, 34
_BLURRED = np.exp(-0.5 * (np.subtract.outer(np.arange(_CELLS), np.arange(_CELLS)) / _BLUR) ** 2)
_BLURRED /= _BLURRED.sum(axis=1).max()
_ON_LIGHT, _ON_DARK = (0.74, 0.77, 0.81), (0.33, 0.36, 0.42)


class Ground(MouseTool, RestActor):
    """Grid below the mesh, labelled at two sides.

    It is a tool of the viewport that handles no events.

    Attributes
    ----------
    grid_step : float
        Between two lines, mesh units.
    grid_corners : (2, 3) array
        Corners of the grid.
    """

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._unit = Unit.NONE
        self.grid_step = 1.0
        self.grid_corners = np.zeros((2, 3))
        self._lies_for = UpAxis.PLUS_Y
        self._actor.GetProperty().LightingOff()
        viewport.tools.append(self)

    def set_unit(self, unit: Unit) -> None:
        """Set the length unit of the labels."""
        self._unit = unit
        self._viewport.tool_layer.update()

    def _prepared_data(self, mesh: Mesh) -> pv.PolyData:
        used = mesh.V[mesh.F.ravel()]
        low, high = used.min(axis=0), used.max(axis=0)
        size, up = float((high - low).max()), self._up_axis
        self._lies_for = up
        self.grid_step = round_step(size / _LINES)
        self.grid_corners = np.array([low - _AROUND * size, high + _AROUND * size])
        self.grid_corners = self.grid_step * np.array(
            [np.floor(self.grid_corners[0] / self.grid_step), np.ceil(self.grid_corners[1] / self.grid_step)]
        )
        self.grid_corners[:, up.index] = (low if up.sign > 0 else high)[up.index]
        self._actor.SetPosition(*self.grid_corners.mean(axis=0))
        self._box = tuple(self.grid_corners.T.ravel())
        return _lines(self.grid_corners, {axis: self._ticks(axis) for axis in self._horizontal_axes})

    @property
    def _up_axis(self) -> UpAxis:
        return self._viewport.camera_controller.camera.up_axis

    @property
    def _horizontal_axes(self) -> tuple[int, int]:
        """Indices of the two horizontal axes."""
        first, second = (axis for axis in range(3) if axis != self._up_axis.index)
        return first, second

    def _ticks(self, axis: int) -> np.ndarray:
        """Positions of the grid lines across an axis."""
        first, last = np.rint(self.grid_corners[:, axis] / self.grid_step)
        return self.grid_step * np.arange(first, last + 1)

    def _match_background(self, dark: bool) -> None:
        self._actor.GetProperty().SetColor(*(_ON_DARK if dark else _ON_LIGHT))
        if self._shown_mesh is not None and self._lies_for is not self._up_axis:
            self._mapper.SetInputData(self._prepared_data(self._shown_mesh))

    def paint(self, painter: QPainter) -> None:
        """Draw the grid labels."""
        if self._shown_mesh is None:
            return
        ink = QColor(166, 173, 186) if self._viewport.is_dark else QColor(90, 98, 112)
        painter.save()
        painter.setPen(ink)
        taken: list[QRectF] = []
        for axis in self._horizontal_axes:
            self._write_along(painter, axis, taken)
        text = tr("grid {length}").format(length=self._unit.format_length(format_short(self.grid_step)))
        room = QRectF(self._viewport.width() - 128, _BELOW, 116, 18)
        painter.drawText(room, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignTop, text)
        painter.restore()

    def _write_along(self, painter: QPainter, axis: int, taken: list[QRectF]) -> None:
        """Write the labels along the nearer side of the grid.

        Labels overlapping the rectangles ``taken`` are left out: both sides have a label at their corner.
        """
        eye, other, ticks = (
            self._viewport.camera_controller.camera,
            sum(self._horizontal_axes) - axis,
            self._ticks(axis),
        )
        side = 0 if eye.position[other] < self.grid_corners[:, other].mean() else 1
        points = np.tile(self.grid_corners[side], (len(ticks), 1))
        points[:, axis] = ticks
        out = points.copy()
        out[:, other] += (0.4 if side else -0.4) * self.grid_step
        seen = eye.depth(out) > 0.05 * eye.distance
        places = eye.project(out)
        gap = float(np.linalg.norm(np.diff(places[seen], axis=0), axis=1).min(initial=np.inf))
        every = next((k for k in (1, 2, 5, 10) if k * gap >= _APART), 0)
        for value, at, visible in zip(ticks, places, seen, strict=True):
            if every and visible and round(value / self.grid_step) % every == 0:
                number = format_position(float(value), self.grid_step)
                width = painter.fontMetrics().horizontalAdvance(number) + _BETWEEN
                room = QRectF(at[0] - width / 2, at[1] - 9, width, 18)
                if not any(room.intersects(other) for other in taken):
                    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, number)
                    taken.append(room)


def _lines(ends: np.ndarray, ticks: dict[int, np.ndarray]) -> pv.PolyData:
    """Grid lines relative to the grid centre; ``ticks`` by horizontal axis."""
    rows = []
    for axis, places in ticks.items():
        lines = np.tile(ends, (len(places), 1, 1))
        lines[:, :, axis] = places[:, None]
        rows.append(lines.reshape(-1, 3))
    points = np.vstack(rows) - ends.mean(axis=0)
    grid = pv.PolyData(points.astype(np.float32))
    count = len(points) // 2
    grid.verts = np.empty(0, dtype=np.int64)
    pairs = np.arange(2 * count).reshape(-1, 2)
    grid.lines = np.column_stack([np.full(count, 2), pairs]).ravel()
    return grid


class GroundShadow:
    """Shadow of a light from above, drawn where the surface is near the ground.

    It follows the surface, and lies under its lowest point; from below it is not seen.
    """

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        self._viewport, self._surface = viewport, surface
        self._on = False
        self._cast_for: tuple[int, UpAxis, bool] | None = None
        self._box: tuple[float, ...] = ()
        self._plane = pv.PolyData.from_regular_faces(np.zeros((4, 3), np.float32), np.array([[0, 1, 2, 3]]))
        self._plane.active_texture_coordinates = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
        self._image = pv.ImageData(dimensions=(_CELLS, _CELLS, 1))
        self._image.point_data["rgba"] = np.zeros((_CELLS * _CELLS, 4), np.uint8)
        self._image.set_active_scalars("rgba")
        texture = vtkTexture()
        texture.SetInputData(self._image)
        texture.InterpolateOn()
        texture.RepeatOff()
        texture.EdgeClampOn()
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(self._plane)
        self._actor = vtkActor()
        self._actor.SetMapper(mapper)
        self._actor.SetTexture(texture)
        self._actor.ForceTranslucentOn()
        self._actor.GetProperty().LightingOff()
        self._actor.GetProperty().SetBackfaceCulling(True)
        self._actor.SetVisibility(False)
        viewport.renderer.AddActor(self._actor)
        viewport.backdrop.append(self._actor)
        viewport.pre_draw.append(self._follow)
        viewport.more_boxes.append(lambda: self._box)

    @property
    def visible(self) -> bool:
        """True while the shadow is shown."""
        return self._on

    @visible.setter
    def visible(self, on: bool) -> None:
        self._on = on
        self._viewport.update()

    def _follow(self) -> None:
        """Cast the shadow of the shape about to be drawn."""
        surface, up = self._surface, self._viewport.camera_controller.camera.up_axis
        shown = self._on and surface.surface_index is not None
        self._actor.SetVisibility(shown)
        if not shown or surface.surface_index is None:
            self._box, self._cast_for = (), None
            return
        asked = surface.revision, up, self._viewport.is_dark
        if asked != self._cast_for:
            self._cast_for = asked
            self._cast(surface.U, surface.surface_index.F, up)

    def _cast(self, U: np.ndarray, F: np.ndarray, up: UpAxis) -> None:
        points, areas = _samples(up.frame @ U.T, F)
        x, height, z = points
        low, high = points.min(axis=1), points.max(axis=1)
        size, middle = float((high - low).max()), 0.5 * (low + high)
        half = (0.5 + _SHADOW_MARGIN) * float(max((high - low)[[0, 2]].max(), 0.1 * size))
        ends = middle[2] + half, middle[2] - half  # the front is at the bottom of the picture
        right, back = np.array([middle[0] - half, middle[0] + half]), np.array(ends)
        amounts = areas * np.exp(-(height - low[1]) / (_REACH * size))
        column, row = (
            ((along - least) * (_CELLS / (2.0 * half))).astype(np.intp)
            for along, least in ((x, right[0]), (z, back[1]))
        )
        cells = np.bincount(column * _CELLS + row, weights=amounts, minlength=_CELLS**2)
        covered = cells.reshape(_CELLS, _CELLS)
        cover = _BLURRED @ (covered / (2.0 * half / _CELLS) ** 2) @ _BLURRED
        opacity = _DARKEST[self._viewport.is_dark] * (1.0 - np.exp(-cover))
        rgba = np.asarray(self._image.point_data["rgba"])
        rgba[:, :3] = _SHADOW_COLOR
        rgba[:, 3] = np.rint(255.0 * opacity[:, ::-1].T).astype(np.uint8).ravel()
        self._image.point_data["rgba"].VTKObject.Modified()
        self._image.Modified()
        level = low[1] - _DEPTH * size
        corners = np.array(
            [[right[i], level, back[j]] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float
        )
        corners = corners @ up.frame
        centre = corners.mean(axis=0)  # single precision is too coarse far from the origin
        self._plane.points = (corners - centre).astype(np.float32)
        self._actor.SetPosition(*centre)
        self._box = tuple(np.column_stack([corners.min(axis=0), corners.max(axis=0)]).ravel())


def _samples(X: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (3, k) on triangles of positions (3, n), and the area (k,) of each."""
    every = max(1, len(F) // _SAMPLES)
    corners = np.array([row[F[::every]] for row in np.ascontiguousarray(X)])
    (a, b, c), (d, e, f) = corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0]
    # By hand: NumPy's cross product and norm take four times as long, and a shadow is cast for every picture.
    double = np.sqrt((b * f - c * e) ** 2 + (c * d - a * f) ** 2 + (a * e - b * d) ** 2)
    count = max(1, _SAMPLES // len(double))
    k = np.arange(1, count + 1)
    weights = np.column_stack([k * 0.7548776662 % 1.0, k * 0.5698402910 % 1.0])  # [Roberts 2018, R2 sequence]
    folded = weights.sum(axis=1) > 1.0
    weights[folded] = 1.0 - weights[folded]
    weights = np.column_stack([1.0 - weights.sum(axis=1), weights])
    points = np.einsum("kc,xmc->xmk", weights, corners, order="C").reshape(3, -1)
    return points, np.repeat(0.5 * every / count * double, count)
