"""A ring around one place of the shape, with a word beside it."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

_RADIUS, _GAP, _ROOM = 11.0, 7.0, 5.0
_INK, _PAPER = QColor(20, 23, 29), QColor(255, 255, 255, 235)


class VertexCallout:
    """Ring and word at a vertex, following the surface.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface

    Attributes
    ----------
    vertex : int or None
    text : str
    """

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        self._viewport, self._surface = viewport, surface
        self.vertex: int | None = None
        self.text = ""

    def show_at(self, vertex: int | None, text: str = "") -> None:
        """Mark another vertex, or none."""
        if vertex is not None or self.vertex is not None:
            self.vertex, self.text = vertex, text
            self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the ring, light on dark, and the word on the freer side."""
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
