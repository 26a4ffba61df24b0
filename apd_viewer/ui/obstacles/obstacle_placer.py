"""Placing of new obstacles by a click on the surface."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QMouseEvent

from apd_viewer.language import tr
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.ui.scene.mouse_tool import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

HINTS = {
    ObstacleKind.PLATE: tr("Click the surface to put a plate there; Ctrl snaps to the axes, Esc cancels"),
    ObstacleKind.SPHERE: tr("Click the surface to put a sphere there; Ctrl snaps to the axes, Esc cancels"),
    ObstacleKind.CYLINDER: tr(
        "Click the surface to put a cylinder there; Ctrl snaps to the axes, Esc cancels"
    ),
}


class ObstaclePlacer(MouseTool, QObject):
    """Tool for a click on the surface where an obstacle is to be; Esc cancels.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface
    propose : callable
        ``propose(kind, point, outwards, at_once)``: the obstacle that would be put there.

    Attributes
    ----------
    kind : ObstacleKind or None
        What is being placed.
    prompt_changed : Signal(str)
        What the user is to do; empty once that is done or cancelled.
    previewed : Signal(object)
        The NamedObstacle under the cursor, or None.
    placed : Signal(object)
        The NamedObstacle where it was clicked.
    """

    prompt_changed = Signal(str)
    previewed = Signal(object)
    placed = Signal(object)

    def __init__(
        self,
        viewport: Viewport,
        surface: Surface,
        propose: Callable[[ObstacleKind, np.ndarray, np.ndarray, bool], NamedObstacle],
    ) -> None:
        super().__init__(viewport)
        self._viewport, self._surface, self._propose = viewport, surface, propose
        self.kind: ObstacleKind | None = None
        self._there = False  # a preview is shown

    def begin_placing(self, kind: ObstacleKind) -> None:
        """Wait for a click."""
        self.kind = kind
        self.prompt_changed.emit(HINTS[kind])

    def press(self, event: QMouseEvent) -> bool:
        """Hold the mouse over the surface, so that the place can still be changed."""
        if self.kind is None or event.button() != Qt.MouseButton.LeftButton:
            return False
        return self._show(self._proposed(event, at_once=True))

    def move(self, event: QMouseEvent) -> bool:
        """Show the obstacle at the point under the cursor."""
        if self.kind is None:
            return False
        there = self._show(self._proposed(event, at_once=True))
        if there:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        return there

    def release(self, event: QMouseEvent) -> None:
        """Put the obstacle there, unless the cursor has left the surface."""
        obstacle = None if self.kind is None else self._proposed(event, at_once=False)
        if obstacle is not None:
            self.cancel()
            self.placed.emit(obstacle)

    def leave(self) -> None:
        """Forget the cursor."""
        self._show(None)

    def cancel(self) -> bool:
        """Stop waiting for a click; True if it did."""
        waited, self.kind = self.kind is not None, None
        if waited:
            self.prompt_changed.emit("")
        self.leave()
        return waited

    def _proposed(self, event: QMouseEvent, at_once: bool) -> NamedObstacle | None:
        hit = self._surface.hit(event.position())
        if hit is None or self.kind is None:
            return None
        normal = hit.normal
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            along = int(np.argmax(np.abs(normal)))
            normal = np.copysign(1.0, normal[along]) * np.eye(3)[along]
        return self._propose(self.kind, hit.point, normal, at_once)

    def _show(self, obstacle: NamedObstacle | None) -> bool:
        if obstacle is not None or self._there:
            self._there = obstacle is not None
            self.previewed.emit(obstacle)
        return self._there
