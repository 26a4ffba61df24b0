"""Turntable animation of the camera around the shape."""

import time

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QMouseEvent

from apd_viewer.ui.scene.camera import DEGREES_PER_PIXEL
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.viewport import Viewport

SPEED = 24.0  # degrees a second
_TICK = 16  # ms between frames
_LONGEST = 0.1  # s: longest time step, so that the camera does not jump after a pause


class Turntable(MouseTool, QObject):
    """Animation that orbits the camera until a tool is used."""

    stopped = Signal()

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._last = 0.0
        self._timer = QTimer(self, interval=_TICK, timeout=self._turn)
        viewport.tools.insert(0, self)

    @property
    def is_running(self) -> bool:
        """True while the camera orbits."""
        return self._timer.isActive()

    @is_running.setter
    def is_running(self, on: bool) -> None:
        self._last = time.perf_counter()
        if on:
            self._timer.start()
        else:
            self._timer.stop()

    def press(self, _: QMouseEvent) -> bool:
        """Stop the animation, without consuming the press."""
        self._stop()
        return False

    def cancel(self) -> bool:
        """Stop the animation; True if it was running."""
        return self._stop()

    def _stop(self) -> bool:
        turned = self.is_running
        if turned:
            self.is_running = False
            self.stopped.emit()
        return turned

    def _turn(self) -> None:
        now = time.perf_counter()
        angle = SPEED * float(np.clip(now - self._last, 0.0, _LONGEST))
        self._last = now
        self._viewport.camera_controller.camera = self._viewport.camera_controller.camera.orbited(
            angle / DEGREES_PER_PIXEL, 0.0
        )
