"""Base class of the mouse tools, and camera navigation for unconsumed events.

Which drag does what is said by a preset. An orbit keeps the horizon level; with a pan, what lies at the depth
of the pivot follows the cursor; a drag zooms to where it began, the wheel, two fingers and a pinch to what is
under the cursor.
"""

from collections.abc import Callable
from inspect import isfunction, signature
from typing import Any

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent, QPainter, QWheelEvent

from apd_viewer.ui.scene.camera_controller import CameraController
from apd_viewer.ui.scene.navigation_preset import DEFAULT_PRESET, CameraMotion
from apd_viewer.ui.scene.pointing import wheel_notches

_GIVEN = {"event", "painter"}  # parameter names of event and paint methods, leading underscores ignored


class MouseTool:
    """Base class of a viewport's mouse tools; all methods do nothing by default.

    Raises
    ------
    TypeError
        When a subclass has a public method that takes an event or a painter and overrides nothing:
        nobody would call it.
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        for name, method in vars(cls).items():
            if name.startswith("_") or not isfunction(method) or hasattr(super(cls, cls), name):
                continue
            if _GIVEN & {argument.lstrip("_") for argument in signature(method).parameters}:
                raise TypeError(f"{cls.__name__}.{name} is no method of mouse tools: is it misspelled?")

    def press(self, _event: QMouseEvent) -> bool:
        """Begin a drag; True captures the mouse until the button is released."""
        return False

    def move(self, _event: QMouseEvent) -> bool:
        """Continue a drag or preview a press; True consumes the event."""
        return False

    def release(self, _event: QMouseEvent) -> None:
        """End a drag."""

    def wheel(self, _event: QWheelEvent) -> bool:
        """Handle a turn of the wheel; True consumes the event."""
        return False

    def leave(self) -> None:
        """Handle the cursor leaving the viewport or being taken by an earlier tool."""

    def cancel(self) -> bool:
        """Cancel a drag or a stroke; True if there was one."""
        return False

    def finish(self) -> bool:
        """Finish an outline of several clicks; True if there was one."""
        return False

    def paint(self, painter: QPainter) -> None:
        """Draw on the tool layer above the scene."""


ZOOM_PER_PIXEL = 1.008
ZOOM_PER_NOTCH = 1.0013**120
DEAD_ZONE = 2.0  # px: a press that moves no farther is a click


class Navigation(MouseTool):
    """Tool to orbit, pan and zoom the camera; consumes every press.

    Parameters
    ----------
    click : callable
        Called at the position of a press that moved nothing.

    Attributes
    ----------
    preset : NavigationPreset
        Which drag does what.
    """

    def __init__(self, camera_controller: CameraController, click: Callable[[QPointF], None]) -> None:
        self._look = camera_controller
        self._click = click
        self.preset = DEFAULT_PRESET
        self._motion: CameraMotion | None = None
        self._start = QPointF()
        self._last = QPointF()
        self._moved = False

    def press(self, event: QMouseEvent) -> bool:
        """Begin a camera drag."""
        self._motion = self.preset.motion(event.button(), event.modifiers())
        self._start = self._last = event.position()
        self._moved = event.button() != Qt.MouseButton.LeftButton
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Move the camera by the cursor's motion since the last event."""
        d = event.position() - self._last
        if self._motion is None or d.isNull():
            return False
        if (event.position() - self._start).manhattanLength() > DEAD_ZONE:
            self._moved = True
        self._last = event.position()
        if self._motion is CameraMotion.ZOOM:
            self._look.zoom_at(self._start, ZOOM_PER_PIXEL ** -d.y())
        elif self._motion is CameraMotion.PAN:
            self._look.camera = self._look.camera.panned(d.x(), d.y())
        else:
            self._look.camera = self._look.camera.orbited(d.x(), d.y())
        return True

    def release(self, event: QMouseEvent) -> None:
        """End the drag."""
        if self._motion is not None and not self._moved:
            self._click(event.position())
        self._motion = None

    def wheel(self, event: QWheelEvent) -> bool:
        """Zoom about the point under the cursor."""
        self._look.zoom_at(event.position(), ZOOM_PER_NOTCH ** wheel_notches(event))
        return True
