"""Selection between two parallel planes dragged across the mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt, QTimer, Signal

from apd_viewer.ui.tools.gizmo_drag import position_along_axis
from apd_viewer.ui.tools.gizmo_layout import GizmoFrame
from apd_viewer.ui.tools.polylines import axis_rectangle, draw_plane
from apd_viewer.ui.tools.selection_tool import SelectionTool, may_begin_stroke, stroke_effect

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QPainter, QWheelEvent

    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.viewport import Viewport

_PAUSE = 30  # ms between previews
_SMALLEST = 3.0  # pixels; a shorter way of the cursor is a click


class SlabTool(SelectionTool):
    """Tool to select the vertices between the planes at start and end of a drag.

    The planes are perpendicular to an axis, which the wheel changes. A drag begins on the mesh and may end
    beyond it.

    Attributes
    ----------
    axis : int
        0, 1 or 2.
    axis_changed : Signal(int)
    planes_moved : Signal(float, float)
        Where the two planes are along the axis.
    preview_timer : QTimer
        Until the cursor rests and the preview is made.
    """

    axis_changed = Signal(int)
    planes_moved = Signal(float, float)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport, surface)
        self.axis = 1
        self._here: np.ndarray | None = None  # where a press would begin
        self._start: np.ndarray | None = None
        self._end = 0.0
        self._pressed = QPointF()
        self._dragged = False
        self.preview_timer = QTimer(self, singleShot=True, interval=_PAUSE)
        self.preview_timer.timeout.connect(lambda: self.previewed.emit(self._between()))

    def press(self, event: QMouseEvent) -> bool:
        """Set the first plane."""
        if not self._enabled or not may_begin_stroke(event):
            return False
        self._look(event)
        if self._here is None:
            return False
        self.effect, self._start = stroke_effect(event), self._here
        self._end = float(self._start[self.axis])
        self._pressed, self._dragged = event.position(), False
        self._show()
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Drag the second plane, or preview the first."""
        if not self._enabled:
            return False
        if self._start is None:
            self._look(event)
            self._viewport.tool_layer.update()
            return self._here is not None
        frame = GizmoFrame(self._viewport.camera_controller.camera, self._start, np.eye(3))
        way = position_along_axis(frame, self.axis, event.position().x(), event.position().y())
        if way is not None:
            self._end = float(self._start[self.axis]) + way
        self._dragged |= (event.position() - self._pressed).manhattanLength() >= _SMALLEST
        self._show()
        return True

    def release(self, _event: QMouseEvent) -> None:
        """Select the vertices between the planes."""
        if self._start is not None:
            act, vertices = self.effect, self._between()
            self._finish()
            if self._dragged:
                self._apply(act, vertices)

    def wheel(self, event: QWheelEvent) -> bool:
        """Choose another axis."""
        if not self._enabled or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        if self._start is None and (event.angleDelta().y() or event.angleDelta().x()):
            self.axis = (self.axis + (1 if event.angleDelta().y() < 0 else 2)) % 3
            self._viewport.tool_layer.update()
            self.axis_changed.emit(self.axis)
        return True

    def leave(self) -> None:
        """Hide the planes."""
        if self._start is None and self._here is not None:
            self._here = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Cancel the drag; True if there was one."""
        if self._start is None:
            return False
        self._finish()
        self.stroke_cancelled.emit()
        return True

    def paint(self, painter: QPainter) -> None:
        """Draw the planes."""
        if self._start is not None:
            ends = {float(self._start[self.axis]), self._end}
        elif self._here is not None:
            ends = {float(self._here[self.axis])}
        else:
            return
        for height in sorted(ends):
            corners = axis_rectangle(self._surface.U, self.axis, height)
            draw_plane(
                painter,
                self._viewport.camera_controller.camera,
                corners,
                self._color,
                self._halo,
                self._pen_style,
            )

    def _look(self, event: QMouseEvent) -> None:
        hit = self._surface.hit(event.position())
        self._here = None if hit is None else hit.point
        if hit is not None:
            self.effect = stroke_effect(event)
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)

    def _show(self) -> None:
        self._viewport.tool_layer.update()
        if self._start is not None:
            self.planes_moved.emit(*sorted((float(self._start[self.axis]), self._end)))
        if not self.preview_timer.isActive():
            self.preview_timer.start()

    def _finish(self) -> None:
        self.preview_timer.stop()
        self._start = self._here = None
        self._viewport.tool_layer.update()
        self.previewed.emit(None)

    def _between(self) -> np.ndarray:
        skin = self._surface.picking_index
        if self._start is None or skin is None:
            return np.empty(0, dtype=np.int64)
        low, high = sorted((float(self._start[self.axis]), self._end))
        along = self._surface.U[skin.representative_vertices, self.axis]
        return skin.representative_vertices[(low <= along) & (along <= high)]
