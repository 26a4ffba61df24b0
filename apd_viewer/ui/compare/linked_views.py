"""Linked views of the compared shapes: shared camera, colour scale and cursor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QSizePolicy, QWidget

from apd_viewer.geometry.analysis.deviation import Deviation, write_shades
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, Scale, default_scale, span_of
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.obstacles.obstacle_scene import DrawnObstacle, ObstacleScene
from apd_viewer.ui.obstacles.obstacle_shapes import ShapeExtent
from apd_viewer.ui.overlays.legend import LegendColorBar
from apd_viewer.ui.overlays.notice import CanvasHint
from apd_viewer.ui.scene.camera import Camera
from apd_viewer.ui.scene.camera_controller import link_cameras
from apd_viewer.ui.scene.coloring import colors_of
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import NumberField
from apd_viewer.ui.widgets.theme import Theme
from apd_viewer.ui.widgets.thin_bar import ElidedLabel

_READ = 250  # ms between two updates of the values while shapes move


class LinkedViews(QWidget):
    """Views of the compared shapes, in a grid maximizing their size.

    Parameters
    ----------
    titles : dict of str to str
        Of the views, by their names.

    Attributes
    ----------
    span_measured : Signal(object)
        The least and the largest change of all shapes that are shown, or None.
    column_count : int
        Number of columns of the grid.
    """

    span_measured = Signal(object)

    def __init__(self, titles: dict[str, str]) -> None:
        super().__init__(objectName="room")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.views = {name: MethodView(title) for name, title in titles.items()}
        self.column_count = len(titles)
        self._shown: Sequence[str] = list(titles)
        self._aspect = 1.0
        self._unit = Unit.NONE
        self._place: ProbedPoint | None = None
        self._grid = QGridLayout(self, spacing=1)
        self._grid.setContentsMargins(0, 1, 0, 1)
        self._reading = QTimer(self, singleShot=True, interval=_READ, timeout=self._read)
        link_cameras([view.viewport.camera_controller for view in self.views.values()])
        for view in self.views.values():
            view.probe.hovered.connect(self.mark_point)
            view.values_changed.connect(self._start_reading)

    def show_rest_shape(self, state: State, unit: Unit) -> None:
        """Show the rest shape of a document in all views."""
        self._unit = unit
        for view in self.views.values():
            view.show_rest_shape(state)

    def set_camera(self, state: State, camera: Camera) -> None:
        """Set the view direction, and frame both the rest and the current shape."""
        look = self._first_view.viewport.camera_controller
        own = look.camera
        look.camera = replace(
            camera,
            position=camera.position - camera.focal,
            focal=np.zeros(3),
            width=own.width,
            height=own.height,
        )
        right, up, _ = look.camera.axes
        both = np.vstack([state.document.mesh.V, state.frame.U])
        self._aspect = float(np.ptp(both @ right) / max(np.ptp(both @ up), 1e-300))
        self._frame(both)

    def show_standard_view(self, name: str) -> None:
        """Frame all shapes from 'front', 'side' or 'top'; prefix '-' gives the opposite."""
        self._first_view.viewport.camera_controller.show_standard_view(name)
        self.frame_shapes()

    def frame_shapes(self) -> None:
        """Zoom to all shapes shown."""
        self._frame(np.vstack([self.views[name].surface.U for name in self._shown]))

    @property
    def _first_view(self) -> MethodView:
        """First view; setting its camera sets all linked cameras."""
        return next(iter(self.views.values()))

    def _frame(self, points: np.ndarray) -> None:
        for view in self.views.values():
            view.viewport.camera_controller.frame(points)

    # Colours and values

    def set_deviation(self, deviation: Deviation, scale: Scale) -> None:
        """Colour the shapes by their local area change from the rest shape."""
        for view in self.views.values():
            view.show_scale(scale)
            view.set_deviation(deviation)

    def show_scale(self, scale: Scale) -> None:
        """Recolour the shapes with another scale."""
        for view in self.views.values():
            view.show_scale(scale)
        self.mark_point(self._place)

    def mark_point(self, point: ProbedPoint | None) -> None:
        """Mark a material point on all shapes, and show their values at it."""
        self._place = point
        for view in self.views.values():
            view.mark_point(point, self._unit)

    def _start_reading(self) -> None:
        if not self._reading.isActive():
            self._reading.start()

    def _read(self) -> None:
        spans = [span for name in self._shown if (span := self.views[name].span) is not None]
        low, high = zip(*spans, strict=True) if spans else ((), ())
        self.span_measured.emit((min(low), max(high)) if spans else None)
        self.mark_point(self._place)

    # Layout of the views

    def show_views(self, names: Sequence[str]) -> None:
        """Show only the views of the named methods."""
        self._shown = names
        self._arrange()
        self._start_reading()

    def _arrange(self) -> None:
        names = self._shown
        self.column_count = _best_column_count(len(names), self.width(), self.height(), self._aspect)
        places = {name: divmod(k, self.column_count) for k, name in enumerate(names)}
        for k in range(len(self.views)):
            self._grid.setRowStretch(k, int(k * self.column_count < len(names)))
            self._grid.setColumnStretch(k, int(k < self.column_count))
        for name, view in self.views.items():
            if name in places:
                self._grid.addWidget(view, *places[name])
            view.setVisible(name in places)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Rearrange the views for the new size."""
        super().resizeEvent(event)
        self._arrange()

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the backgrounds."""
        for view in self.views.values():
            view.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def close_all(self) -> None:
        """Release the VTK scenes; the views cannot be used afterwards."""
        self._reading.stop()
        for view in self.views.values():
            view.viewport.close()


def _best_column_count(count: int, width: int, height: int, aspect: float) -> int:
    """Number of columns maximizing the size of ``count`` views of an aspect ratio."""

    def size(across: int) -> float:
        return min(width / across / aspect, height * across / count - HEAD_HEIGHT)

    return max((across for across in range(1, count + 1) if count % across == 0), key=size)


_WIDTH = 248


class SharedScale(QWidget):
    """Legend of the colour scale shared by all views, with its range field.

    Parameters
    ----------
    chosen : Scale or None
        Chosen by the user, if any.

    Attributes
    ----------
    changed : Signal()
        The range is another one.
    is_chosen : bool
        True if the user has chosen the range: it is not fitted then.
    span : tuple of float or None
        Least and largest value in sight.
    """

    changed = Signal()

    def __init__(self, chosen: Scale | None) -> None:
        super().__init__()
        self.scale = scale = chosen or default_scale(Measure.AREA, 1.0)
        self.is_chosen = chosen is not None
        self.span: tuple[float, float] | None = None
        self.setFixedWidth(_WIDTH)
        self._bar = LegendColorBar()
        tip = tr("Change at the ends of the scale, where the colours are strongest")
        self.reach = NumberField(
            brief=True, accessibleName=tr("Range"), toolTip=tip, decimals=9, suffix="\u00a0%"
        )
        self.reach.setRange(1e-7, 1e9)
        self.reach.valueChanged.connect(self._choose)
        tip = tr("Fit the scale to the largest change of all shapes")
        self.fit = QPushButton(tr("Fit"), toolTip=tip, clicked=self.fit_to_span)
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=6)
        grid.setContentsMargins(0, 0, 0, 0)
        title = QLabel(scale.measure.traits.title, objectName="title", toolTip=scale.measure.traits.tip)
        grid.addWidget(title, 0, 0, 1, 3)
        grid.addWidget(self._bar, 1, 0, 1, 3)
        grid.addWidget(QLabel(tr("Range"), objectName="quiet"), 2, 0)
        grid.addWidget(self.reach, 2, 1, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(self.fit, 2, 2)
        grid.setColumnStretch(0, 1)
        grid.setRowStretch(3, 1)
        self._show()

    def show_span(self, span: tuple[float, float] | None) -> None:
        """Show the smallest and largest value of all shapes; None hides them."""
        self.span = span
        self._bar.show_values(span, None)
        self.fit.setEnabled(span is not None)

    def fit_to_span(self) -> None:
        """Fit the range to the largest change of all shapes."""
        if self.span is not None:
            self._rescale(self.scale.fitted_to(self.span).reach)

    def _choose(self, percent: float) -> None:
        self.is_chosen = True
        self._rescale(percent / 100.0)

    def _rescale(self, reach: float) -> None:
        if reach != self.scale.reach:
            self.scale = replace(self.scale, reach=reach)
            self._show()
            self.changed.emit()

    def _show(self) -> None:
        self.reach.show_value(100.0 * self.scale.reach)
        self._bar.show_scale(self.scale, Unit.NONE)


HEAD_HEIGHT = 32  # px


class MethodView(QWidget):
    """Viewport of one method's shape, captioned with its name and readings.

    Attributes
    ----------
    values_changed : Signal()
        There are other values.
    values : (n,) float array or None
        The local change that is drawn.
    """

    values_changed = Signal()

    def __init__(self, title: str) -> None:
        super().__init__(accessibleName=title)
        self.title = title
        self._state, self._value = ElidedLabel(objectName="quiet"), QLabel()
        self._state.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._value.setToolTip(tr("Local area change at the ring"))
        self._value.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        head = QWidget(objectName="head")
        head.setFixedHeight(HEAD_HEIGHT)
        name = QLabel(title, objectName="title")
        row_layout(name, (self._state, 1), self._value, spacing=4, margins=(12, 0, 12, 0), parent=head)
        self.viewport = Viewport(self)
        self.surface = Surface(self.viewport)
        self.obstacles = ObstacleScene(self.viewport)
        self._extent: ShapeExtent | None = None
        self._note = CanvasHint(self.viewport)
        column_layout(head, (self.viewport, 1), spacing=0, parent=self)
        self.values: np.ndarray | None = None
        self._change: Deviation | None = None
        self._measured = -1
        self._scale = Scale(Measure.AREA, 0.1, 0.001)
        self.probe = SurfaceProbe(self.viewport, self.surface)
        self.viewport.tools.insert(0, self.probe)
        self.viewport.pre_draw.append(self._refresh)

    # Display of shapes and readings

    def show_rest_shape(self, state: State) -> None:
        """Show the rest shape of a document until the method delivers another."""
        document = state.document
        self.values, self._change = None, None
        self.surface.set_color_map(None)
        self.surface.set_mesh(state.surface_index, document.mesh.V, colors_of(document))
        self._extent = ShapeExtent.from_points(document.mesh.V[used_vertices(document.mesh.F)])
        self.show_obstacles([DrawnObstacle(each, np.zeros(3)) for each in document.obstacles])

    def show_shape(self, U: np.ndarray) -> None:
        """Show a new shape (n, 3)."""
        if U is not self.surface.shape:
            self.surface.set_points(U)

    def show_obstacles(self, obstacles: Sequence[DrawnObstacle]) -> None:
        """Show the obstacles where they are beside the shape."""
        assert self._extent is not None
        self.obstacles.show_obstacles(obstacles, self._extent)

    def set_deviation(self, deviation: Deviation) -> None:
        """Colour the shape by its local area change from the rest shape."""
        self._change, self._measured = deviation, -1
        self.viewport.update()

    def show_scale(self, scale: Scale) -> None:
        """Recolour the shape with another scale."""
        self._scale, self._measured = scale, -1
        self.viewport.update()

    def show_status(self, state: str, tip: str = "", note: str = "") -> None:
        """Show the progress, its details as a tooltip, and a failure message."""
        if state != self._state.text():
            self._state.setText(state)
        self._state.setToolTip(tip or state)
        if note != self._note.text():
            self._note.show_text(note)

    @property
    def status_texts(self) -> tuple[str, str]:
        """Progress text and failure message."""
        return self._state.text(), self._note.text()

    def picture(self, pixel_ratio: int) -> np.ndarray:
        """Picture of the shape on white at a pixel ratio, (h, w, 3) uint8."""
        view = self.viewport
        wide, high = view.ren_win.GetSize()
        view.set_theme("#ffffff")
        view.ren_win.GetInteractor().UpdateSize(pixel_ratio * wide, pixel_ratio * high)
        pixels: np.ndarray = view.screenshot(return_img=True)
        view.ren_win.GetInteractor().UpdateSize(wide, high)
        return pixels

    def _refresh(self) -> None:
        """Measure the local area change of the shape and update its colours."""
        surface = self.surface
        if self._change is None or surface.shape_revision == self._measured:
            return
        self._measured = surface.shape_revision
        self.values = self._change.area_change(surface.shape)
        write_shades(self.values, True, self._scale.end, surface.shades)
        surface.update_shades()
        surface.set_color_map(self._scale.measure.colors, self._scale.neutral_fraction)
        self.values_changed.emit()

    @property
    def span(self) -> tuple[float, float] | None:
        """Smallest and largest local area change, or None."""
        return span_of(self.values)

    def mark_point(self, point: ProbedPoint | None, unit: Unit) -> None:
        """Mark a material point, and show the area change at it."""
        self.probe.marked_point = point
        value = "" if point is None else self._scale.format_value(self._read(point), unit)
        if value != self._value.text():
            self._value.setText(value)
        self.viewport.tool_layer.update()

    @property
    def marked_value(self) -> str:
        """Area change at the marked point, as text."""
        return self._value.text()

    def _read(self, place: ProbedPoint) -> float:
        if self.values is None or self.surface.surface_index is None:
            return np.nan
        return float(place.weights @ self.values[self.surface.surface_index.F[place.face]])


_RING = 6.0  # px


class ProbedPoint(NamedTuple):
    """Material point on the surface: a face and barycentric weights (3,)."""

    face: int
    weights: np.ndarray


class SurfaceProbe(MouseTool, QObject):
    """Tool to report the material point under the cursor and mark a point with a ring.

    Attributes
    ----------
    hovered : Signal(object)
        The Place under the cursor, or None.
    marked_point : ProbedPoint or None
        Point marked with a ring.
    """

    hovered = Signal(object)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport, self._surface = viewport, surface
        self.marked_point: ProbedPoint | None = None

    def move(self, event: QMouseEvent) -> bool:
        """Report the point under the cursor."""
        hit = self._surface.hit(event.position())
        self.hovered.emit(
            None if hit is None else ProbedPoint(hit.face, self._surface.barycentric_weights(hit))
        )
        return False

    def leave(self) -> None:
        """Report the cursor as outside the view."""
        self.hovered.emit(None)

    def paint(self, painter: QPainter) -> None:
        """Draw the ring around the marked point."""
        skin = self._surface.surface_index
        if self.marked_point is None or skin is None:
            return
        point = self.marked_point.weights @ self._surface.U[skin.F[self.marked_point.face]]
        if self._viewport.camera_controller.camera.depth(point) <= 0.0:
            return
        x, y = self._viewport.camera_controller.camera.project(point[None])[0]
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for color, width in (("#ffffff", 3.5), ("#1d2129", 1.5)):
            painter.setPen(QPen(QColor(color), width))
            painter.drawEllipse(QPointF(x, y), _RING, _RING)
