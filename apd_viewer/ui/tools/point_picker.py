"""Picking of points on the mesh, as a pivot or as an axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QPen

from apd_viewer.ui.scene.mouse_tool import MouseTool

if TYPE_CHECKING:
    from collections.abc import Callable

    from PySide6.QtGui import QMouseEvent, QPainter

    from apd_viewer.ui.scene.surface import Hit, Surface
    from apd_viewer.ui.scene.viewport import Viewport

_ARM = 9.0


class PointPicker(MouseTool, QObject):
    """Tool for clicks on the mesh on request; Esc cancels.

    Attributes
    ----------
    marked_points : (k, 3) float array
        Points that are marked, joined by a line, whether or not any are asked for.
    prompt_changed : Signal(str)
        What the user is to do; empty once that is done or cancelled.
    """

    prompt_changed = Signal(str)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._surface = surface
        self._wanted = 0
        self._then: Callable[[np.ndarray], object] = lambda _: None
        self._points: list[np.ndarray] = []
        self._hit: Hit | None = None
        self._shown = np.empty((0, 3))

    @property
    def marked_points(self) -> np.ndarray:
        """Marked points (k, 3)."""
        return self._shown

    @marked_points.setter
    def marked_points(self, points: np.ndarray) -> None:
        self._shown = points
        self._viewport.tool_layer.update()

    def pick_points(self, count: int, on_picked: Callable[[np.ndarray], object], prompt: str) -> None:
        """Pass ``count`` clicked points (count, 3) to ``on_picked``."""
        self._wanted, self._then, self._points = count, on_picked, []
        self.prompt_changed.emit(prompt)

    def press(self, event: QMouseEvent) -> bool:
        """Take the point under the cursor."""
        if not self._wanted or event.button() != Qt.MouseButton.LeftButton:
            return False
        self._hit = self._surface.hit(event.position())
        return self._hit is not None

    def move(self, event: QMouseEvent) -> bool:
        """Show the point under the cursor."""
        if not self._wanted:
            return False
        self._hit = self._surface.hit(event.position())
        if self._hit is not None:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        self._viewport.tool_layer.update()
        return self._hit is not None

    def release(self, event: QMouseEvent) -> None:
        """Take the point, and tell all once there are as many as were asked for."""
        hit = self._surface.hit(event.position())
        if hit is not None:
            self._points.append(hit.point)
            if len(self._points) == self._wanted:
                points = np.array(self._points)
                self.cancel()
                self._then(points)

    def leave(self) -> None:
        """Forget the cursor."""
        if self._hit is not None:
            self._hit = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Stop waiting for clicks; True if it did."""
        waited, self._wanted, self._points = self._wanted > 0, 0, []
        if waited:
            self.prompt_changed.emit("")
        self.leave()
        return waited

    def paint(self, painter: QPainter) -> None:
        """Draw a cross at every point, and a line through them."""
        hit = [] if self._hit is None else [self._hit.point]
        points = np.array([*self._points, *hit]) if self._wanted else self._shown
        if not len(points):
            return
        at = [QPointF(x, y) for x, y in self._viewport.camera_controller.camera.project(points)]
        for color, width in ((QColor(255, 255, 255, 220), 4.5), (QColor(24, 26, 30), 1.8)):
            painter.setPen(QPen(color, width, c=Qt.PenCapStyle.RoundCap))
            painter.drawPolyline(at)
            for x in at:
                painter.drawLine(x - QPointF(_ARM, 0), x + QPointF(_ARM, 0))
                painter.drawLine(x - QPointF(0, _ARM), x + QPointF(0, _ARM))
