"""Material point under the cursor, shared by shapes of one mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen

from apd_viewer.ui.scene.mouse_tool import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

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
