"""Camera navigation with the mouse, for events not taken by a tool.

======================================  =====================================================
left drag (background), right drag      orbit; the horizon stays level
middle drag, Shift + left / right drag  pan; what lies at the pivot's depth follows the cursor
wheel, two fingers, pinch               zoom to what is under the cursor
Ctrl + right drag                       zoom to where the drag began
======================================  =====================================================
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt

from apd_viewer.ui.scene.mouse_tool import MouseTool

if TYPE_CHECKING:
    from collections.abc import Callable

    from PySide6.QtGui import QMouseEvent, QWheelEvent

    from apd_viewer.ui.scene.camera_controller import CameraController

ZOOM_PER_PIXEL = 1.008
ZOOM_PER_WHEEL_UNIT = 1.0013  # one notch is 120 units
DEAD_ZONE = 2.0  # pixels that the cursor may tremble in a click that is no drag


class Navigation(MouseTool):
    """Orbit, pan and zoom; consumes every press.

    Parameters
    ----------
    camera_controller : CameraController
    click : callable
        Called at the position of a press that moved nothing.
    """

    def __init__(self, camera_controller: CameraController, click: Callable[[QPointF], None]) -> None:
        self._look = camera_controller
        self._click = click
        self._mode = ""
        self._start = QPointF()
        self._last = QPointF()
        self._moved = False

    def press(self, event: QMouseEvent) -> bool:
        """Begin a camera drag."""
        self._mode = _mode(event.button(), event.modifiers())
        self._start = self._last = event.position()
        self._moved = event.button() != Qt.MouseButton.LeftButton
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Move the camera by the cursor's motion since the last event."""
        d = event.position() - self._last
        if not self._mode or d.isNull():
            return False
        if (event.position() - self._start).manhattanLength() > DEAD_ZONE:
            self._moved = True
        self._last = event.position()
        if self._mode == "zoom":
            self._look.zoom_at(self._start, ZOOM_PER_PIXEL ** -d.y())
        elif self._mode == "pan":
            self._look.camera = self._look.camera.panned(d.x(), d.y())
        else:
            self._look.camera = self._look.camera.orbited(d.x(), d.y())
        return True

    def release(self, event: QMouseEvent) -> None:
        """End the drag."""
        if self._mode and not self._moved:
            self._click(event.position())
        self._mode = ""

    def wheel(self, event: QWheelEvent) -> bool:
        """Zoom to the cursor."""
        self._look.zoom_at(event.position(), ZOOM_PER_WHEEL_UNIT ** event.angleDelta().y())
        return True


def _mode(button: Qt.MouseButton, modifiers: Qt.KeyboardModifier) -> str:
    if button == Qt.MouseButton.MiddleButton or modifiers & Qt.KeyboardModifier.ShiftModifier:
        return "pan"
    if button == Qt.MouseButton.RightButton and modifiers & Qt.KeyboardModifier.ControlModifier:
        return "zoom"
    return "orbit"
