"""Selection of connected vertices, and picking of points and axes, by clicks."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen, QWheelEvent

from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.pointing import wheel_notches
from apd_viewer.ui.scene.surface import Hit, Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.selection_tool import SelectionTool, may_begin_stroke, stroke_effect

if TYPE_CHECKING:
    from apd_viewer.geometry.picking.surface_index import SurfaceIndex

_CREASE_PER_NOTCH = 5.0
_SHARPEST, _FLATTEST = 180.0, 1.0
_NONE = np.empty(0, dtype=np.int64)


class ClickExtent(Enum):
    """Extent of a selection by one click."""

    CREASE = "crease"
    COMPONENT = "piece"
    LOOP = "loop"


class ClickTool(SelectionTool):
    """Tool to select connected vertices at the cursor, with a preview.

    Attributes
    ----------
    crease_angle : float
        Largest angle between adjacent normals inside a fill, degrees; changed by the wheel.
    nothing_found : Signal()
        There is nothing of the kind that was clicked for.
    """

    crease_angle_changed = Signal(float)
    nothing_found = Signal()

    def __init__(self, viewport: Viewport, surface: Surface, extent: ClickExtent) -> None:
        super().__init__(viewport, surface)
        self._reach = extent
        self.crease_angle = 30.0
        self._cursor: QPointF | None = None
        self._hit: Hit | None = None
        self._seen: tuple[object, ...] = ()  # camera and shape at the latest hit test
        self._pressed = False
        self._known: tuple[object, np.ndarray] = (None, _NONE)

    def press(self, event: QMouseEvent) -> bool:
        """Begin a click if the cursor is on the mesh."""
        if not self._enabled or not may_begin_stroke(event):
            return False
        self._update_hit(event)
        self._pressed = self._hit is not None
        return self._pressed

    def move(self, event: QMouseEvent) -> bool:
        """Preview the selection at the cursor."""
        if not self._enabled:
            return False
        self._update_hit(event)
        if self._hit is not None:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        return self._hit is not None

    def release(self, event: QMouseEvent) -> None:
        """Select the previewed vertices if the cursor is still on the mesh."""
        if not self._pressed:
            return  # the press was cancelled
        self._pressed = False
        self._update_hit(event)
        vertices = self._connected_vertices()
        if len(vertices):
            self._apply(self.effect, vertices)
        elif self._hit is not None:
            self.nothing_found.emit()

    def cancel(self) -> bool:
        """Cancel a press; True if there was one."""
        if not self._pressed:
            return False
        self._pressed = False
        self.leave()
        self.stroke_cancelled.emit()
        return True

    def wheel(self, event: QWheelEvent) -> bool:
        """Change the crease angle."""
        other = self._reach is not ClickExtent.CREASE or not self._enabled
        if other or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        self.crease_angle = float(
            np.clip(self.crease_angle + _CREASE_PER_NOTCH * wheel_notches(event), _FLATTEST, _SHARPEST)
        )
        self.crease_angle_changed.emit(self.crease_angle)
        self._show()
        return True

    def leave(self) -> None:
        """Hide the preview."""
        if self._cursor is not None:
            self._cursor = self._hit = None
            self.previewed.emit(None)

    def paint(self, _painter: QPainter) -> None:
        """Update the preview if mesh or camera moved under a resting cursor."""
        if self._cursor is not None and self._seen != self._view_key:
            self._pick()

    def _update_hit(self, event: QMouseEvent) -> None:
        self._cursor, self.effect = event.position(), stroke_effect(event)
        self._pick()

    def _pick(self) -> None:
        self._hit = None if self._cursor is None else self._surface.hit(self._cursor)
        self._seen = self._view_key
        self._show()

    def _show(self) -> None:
        self.previewed.emit(self._connected_vertices() if self._hit is not None else None)

    def _connected_vertices(self) -> np.ndarray:
        """Vertices connected to the surface point under the cursor."""
        skin = self._surface.picking_index
        if skin is None or self._hit is None:
            return _NONE
        key = self._hit.face, self.crease_angle, self._surface.revision
        if self._known[0] != key:
            self._known = key, self._vertices_connected_to(skin, self._hit.face)
        return self._known[1]

    def _vertices_connected_to(self, skin: SurfaceIndex, face: int) -> np.ndarray:
        if self._reach is ClickExtent.CREASE:
            return skin.vertices_up_to_creases(self._surface.U, face, np.deg2rad(self.crease_angle))
        return skin.component(face) if self._reach is ClickExtent.COMPONENT else skin.border_loop(face)


_ARM = 9.0


class PointPicker(MouseTool, QObject):
    """Tool to pick points on the mesh on request; Esc cancels.

    Attributes
    ----------
    marked_points : (k, 3) float array
        Points that are marked, joined by a line, whether or not any are asked for.
    prompt_changed : Signal(str)
        Instruction to the user; empty after picking or cancelling.
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
        """Points (k, 3) drawn with marks."""
        return self._shown

    @marked_points.setter
    def marked_points(self, points: np.ndarray) -> None:
        self._shown = points
        self._viewport.tool_layer.update()

    def pick_points(self, count: int, on_picked: Callable[[np.ndarray], object], prompt: str) -> None:
        """Request ``count`` clicks, and pass their points (count, 3) to ``on_picked``."""
        self._wanted, self._then, self._points = count, on_picked, []
        self.prompt_changed.emit(prompt)

    def press(self, event: QMouseEvent) -> bool:
        """Begin a click on the point under the cursor."""
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
        """Add the clicked point, and call ``on_picked`` after the last one."""
        hit = self._surface.hit(event.position())
        if hit is not None:
            self._points.append(hit.point)
            if len(self._points) == self._wanted:
                points = np.array(self._points)
                self.cancel()
                self._then(points)

    def leave(self) -> None:
        """Remove the point under the cursor from the drawing."""
        if self._hit is not None:
            self._hit = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Cancel the request for points; True if there was one."""
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
