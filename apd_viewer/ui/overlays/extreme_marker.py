"""Marker stepping through the extremes of the deviation on the mesh."""

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from apd_viewer.geometry.analysis.deviation import extreme_vertices
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.canvas import Canvas

_PLACES = 12  # number of extremes; below, their spacing and framing margin relative to the mesh size
_APART, _AROUND = 0.08, 0.04


class ExtremeMarker(MouseTool):
    """Tool to frame and mark the extremes one after another.

    Parameters
    ----------
    covered_rect : callable
        The part of the viewport hidden at its lower left.
    """

    def __init__(self, canvas: Canvas, covered_rect: Callable[[], QRect]) -> None:
        self._canvas, self._covered = canvas, covered_rect
        self._places: np.ndarray | None = None
        self.callout = VertexCallout(canvas.viewport, canvas.surface)
        canvas.viewport.tools.insert(0, self)

    def remove_mark(self) -> None:
        """Remove the mark and the list of extremes, as the values are out of date."""
        self._places = None
        self.callout.show_at(None)

    def show_extreme(self, values: np.ndarray, size: float, by: int, scale: Scale, unit: Unit) -> None:
        """Frame the next or previous extreme, if there is any.

        Parameters
        ----------
        values : (n,) float array
            Of the vertices.
        size : float
            Of the mesh.
        unit : Unit
            Unit of the caption.
        """
        surface = self._canvas.surface
        if self._places is None:
            self._places = extreme_vertices(
                scale.displayed_changes(values), surface.U, _APART * size, _PLACES
            )
        if not len(self._places):
            return
        before = np.flatnonzero(self._places == self.callout.vertex)
        k = (int(before[0]) + by) % len(self._places) if len(before) else 0
        vertex = int(self._places[k])
        text = tr("{number} of {count}: {value}").format(
            number=k + 1, count=len(self._places), value=scale.format_value(float(values[vertex]), unit)
        )
        self.callout.show_at(vertex, text)
        away = ((surface.U - surface.U[vertex]) ** 2).sum(axis=1)
        around = np.flatnonzero(away <= (_AROUND * size) ** 2)
        self._canvas.view.show_vertices(around, QRectF(self._covered()))

    def cancel(self) -> bool:
        """Remove the mark; return False to let other tools handle Esc."""
        self.callout.show_at(None)
        return False

    def paint(self, painter: QPainter) -> None:
        """Draw the mark."""
        self.callout.paint(painter)


_RADIUS, _GAP, _ROOM = 11.0, 7.0, 5.0
_INK, _PAPER = QColor(20, 23, 29), QColor(255, 255, 255, 235)


class VertexCallout:
    """Ring and caption at a vertex, following the surface."""

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        self._viewport, self._surface = viewport, surface
        self.vertex: int | None = None
        self.text = ""

    def show_at(self, vertex: int | None, text: str = "") -> None:
        """Set the marked vertex and its caption; None removes the mark."""
        if vertex is not None or self.vertex is not None:
            self.vertex, self.text = vertex, text
            self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the ring, and the caption on the side with more room."""
        if self.vertex is None or self.vertex >= len(self._surface.U):
            return
        point = self._surface.U[[self.vertex]]
        if self._viewport.camera_controller.camera.depth(point)[0] <= 0.0:
            return
        at = QPointF(*self._viewport.camera_controller.camera.project(point)[0])
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for color, width in ((_PAPER, 5.0), (_INK, 2.0)):
            painter.setPen(QPen(color, width))
            painter.drawEllipse(at, _RADIUS, _RADIUS)
        metrics = painter.fontMetrics()
        wide, tall = metrics.horizontalAdvance(self.text) + 2 * _ROOM + 2, metrics.height() + 4
        beside = _RADIUS + _GAP
        left = at.x() + beside if at.x() + beside + wide < self._viewport.width() else at.x() - beside - wide
        room = QRectF(left, at.y() - tall / 2, wide, tall)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(_PAPER)
        painter.drawRoundedRect(room, 4, 4)
        painter.setPen(_INK)
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, self.text)
