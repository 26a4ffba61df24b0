"""View of one method's shape, with the material point under the cursor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from apd_viewer.geometry.analysis.deviation import Deviation, write_shades
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, Scale, span_of
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.notice import CanvasHint
from apd_viewer.ui.scene.coloring import colors_of
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

HEAD_HEIGHT = 32  # px


class MethodView(QWidget):
    """Viewport of one method's shape, captioned with its name and readings.

    Parameters
    ----------
    title : str

    Attributes
    ----------
    viewport : Viewport
    surface : Surface
    probe : SurfaceProbe
    values_changed : Signal()
        There are other values.
    values : (n,) float array or None
        The local change that is drawn.
    """

    values_changed = Signal()

    def __init__(self, title: str) -> None:
        super().__init__(accessibleName=title)
        self.title = title
        self._state, self._value = QLabel(objectName="quiet"), QLabel()
        self._state.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._value.setToolTip(tr("Local area change at the ring"))
        self._value.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        head = QWidget(objectName="head")
        head.setFixedHeight(HEAD_HEIGHT)
        row = QHBoxLayout(head, spacing=12)
        row.setContentsMargins(12, 0, 12, 0)
        row.addWidget(QLabel(title, objectName="title"))
        row.addWidget(self._state, 1)
        row.addWidget(self._value)
        self.viewport = Viewport(self)
        self.surface = Surface(self.viewport)
        self._note = CanvasHint(self.viewport)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(head)
        column.addWidget(self.viewport, 1)
        self.values: np.ndarray | None = None
        self._change: Deviation | None = None
        self._measured = -1
        self._scale = Scale(Measure.AREA, 0.1, 0.001)
        self.probe = SurfaceProbe(self.viewport, self.surface)
        self.viewport.tools.insert(0, self.probe)
        self.viewport.pre_draw.append(self._refresh)

    # Showing

    def show_rest_shape(self, state: State) -> None:
        """Show the rest shape of a document, until there is another."""
        document = state.document
        self.values, self._change = None, None
        self.surface.set_color_map(None)
        self.surface.set_mesh(state.surface_index, document.mesh.V, colors_of(document))

    def show_shape(self, U: np.ndarray) -> None:
        """Show another shape (n, 3)."""
        if U is not self.surface.shape:
            self.surface.set_points(U)

    def set_deviation(self, deviation: Deviation) -> None:
        """Show how the shape differs from rest, from now on."""
        self._change, self._measured = deviation, -1
        self.viewport.update()

    def show_scale(self, scale: Scale) -> None:
        """Show the change on another scale."""
        self._scale, self._measured = scale, -1
        self.viewport.update()

    def show_status(self, state: str, tip: str = "", note: str = "") -> None:
        """Show the progress, details and failure."""
        if state != self._state.text():
            self._state.setText(state)
        self._state.setToolTip(tip)
        if note != self._note.text():
            self._note.show_text(note)

    @property
    def status_texts(self) -> tuple[str, str]:
        """Progress and failure."""
        return self._state.text(), self._note.text()

    def picture(self, pixel_ratio: int) -> np.ndarray:
        """Shape on white at a pixel ratio, (h, w, 3) uint8."""
        view = self.viewport
        wide, high = view.ren_win.GetSize()
        view.set_theme("#ffffff")
        view.ren_win.GetInteractor().UpdateSize(pixel_ratio * wide, pixel_ratio * high)
        pixels: np.ndarray = view.screenshot(return_img=True)
        view.ren_win.GetInteractor().UpdateSize(wide, high)
        return pixels

    def _refresh(self) -> None:
        """Measure and colour the shape about to be drawn."""
        surface = self.surface
        if self._change is None or surface.shape_revision == self._measured:
            return
        self._measured = surface.shape_revision
        self.values = self._change.area_change(surface.shape)
        write_shades(self.values, True, self._scale.end, surface.shades)
        surface.update_shades()
        surface.set_color_map(self._scale.measure.colors, self._scale.neutral_share)
        self.values_changed.emit()

    @property
    def span(self) -> tuple[float, float] | None:
        """Least and largest value, or None."""
        return span_of(self.values)

    def mark_point(self, point: ProbedPoint | None, unit: Unit) -> None:
        """Mark a place, and read the change there."""
        self.probe.marked_point = point
        value = "" if point is None else self._scale.format_value(self._read(point), unit)
        if value != self._value.text():
            self._value.setText(value)
        self.viewport.tool_layer.update()

    @property
    def marked_value(self) -> str:
        """Change at the marked place, as text."""
        return self._value.text()

    def _read(self, place: ProbedPoint) -> float:
        if self.values is None or self.surface.surface_index is None:
            return np.nan
        return float(place.weights @ self.values[self.surface.surface_index.F[place.face]])


_RING = 6.0  # px


class ProbedPoint(NamedTuple):
    """Material point: a face and barycentric weights (3,)."""

    face: int
    weights: np.ndarray


class SurfaceProbe(MouseTool, QObject):
    """Reports the material point under the cursor and marks one with a ring.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface

    Attributes
    ----------
    hovered : Signal(object)
        The Place under the cursor, or None.
    marked_point : ProbedPoint or None
        What is marked.
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
        """There is no cursor any more."""
        self.hovered.emit(None)

    def paint(self, painter: QPainter) -> None:
        """Draw the ring."""
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
