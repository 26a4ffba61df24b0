"""Tour of five steps with the sample bottle, advanced by the user's actions."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QTimer, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.help.tour_card import TourCard
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.gizmo_drag import GizmoFrame
from apd_viewer.ui.tools.tool_modes import Tool

_LOOK = 33  # ms from a repaint to the update of the target's rectangle
_READING_TIME = 1500  # ms to read the area after the shape has converged
_RING, _AREA = 1, 2  # numbers of the steps that wait for a drag of the ring

_NOT_HELD = tr(
    "This is the total area. Drag the ring again and watch it: the current method lets it "
    "change, the method Exact keeps it."
)


class TourStep(NamedTuple):
    """Step of the tour: its sentence and its target.

    Parameters
    ----------
    target : callable
        Function giving the target of the card's pointer; None if it is out of sight.
    hidden_sentence : str
        Sentence for a target out of sight.
    """

    sentence: str
    target: Callable[[], QRect | None]
    hidden_sentence: str = ""


def tour_steps(targets: TourTargets) -> tuple[TourStep, ...]:
    """Steps of the tour: texts and target rectangles."""
    return (
        TourStep(
            tr(
                "The blue base of this bottle stays in place; the orange top is the handle to move. "
                "Drag beside the bottle to look around."
            ),
            targets.mesh,
        ),
        TourStep(
            tr("Drag the green ring around the handle to twist the bottle."),
            targets.rings,
            tr("The ring is out of view: choose “Move handle”, then “Frame mesh”."),
        ),
        TourStep(
            tr("This is the total area. Drag the ring again: the shape changes, the area does not."),
            targets.area,
            tr("The area is out of view: open Panel in the View menu."),
        ),
        TourStep(
            tr(
                "Paint your own base, handle and region with these tools; Erase makes painted vertices "
                "free again."
            ),
            targets.brushes,
        ),
        TourStep(
            tr("Export saves the shape to a file. Now open your own mesh, or drop it on the window."),
            targets.export,
        ),
    )


class Tour(QObject):
    """Non-modal sequence of the tour's steps.

    Attributes
    ----------
    ring_requested : Signal()
        The ring should be there to be dragged.
    """

    began = Signal()
    ended = Signal()
    ring_requested = Signal()

    def __init__(self, window: QMainWindow, canvas: Canvas, targets: TourTargets) -> None:
        super().__init__(window)
        self._window = window
        self._canvas = canvas
        self.targets = targets
        self._steps = tour_steps(targets)
        self.card = TourCard(window)
        self.card.step_requested.connect(self._step)
        self.card.skipped.connect(self.end)
        self._step_now = -1
        self._rests: Callable[[], bool] = lambda: True
        self._holds: Callable[[], bool] = lambda: True
        self._turned = False
        self._pose: np.ndarray = np.eye(4)
        self._looking = QTimer(self, singleShot=True, interval=_LOOK, timeout=self.update_target)
        self._reading = QTimer(self, singleShot=True, interval=_READING_TIME, timeout=self._advance)
        canvas.drag_began.connect(self._begin_drag)
        canvas.drag_ended.connect(self._detect_rotation)

    @property
    def step_number(self) -> int:
        """Number of the current step, from 0; -1 outside a tour."""
        return self._step_now

    @property
    def is_active(self) -> bool:
        """True during a tour."""
        return self._step_now >= 0

    def begin(self, is_settled: Callable[[], bool], keeps_area: Callable[[], bool]) -> None:
        """Show the first step.

        ``is_settled`` says whether the shape on screen has settled, ``keeps_area`` whether its method holds
        the area.
        """
        self._rests, self._holds = is_settled, keeps_area
        self._window.installEventFilter(self)
        self._show(0)
        self.began.emit()

    def end(self) -> bool:
        """Close the tour; True if one was active."""
        if not self.is_active:
            return False
        self._step_now = -1
        self._window.removeEventFilter(self)
        self._looking.stop()
        self._reading.stop()
        if self.card.isAncestorOf(self._window.focusWidget()):
            self._canvas.viewport.setFocus()
        self.card.hide()
        self.ended.emit()
        return True

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Schedule an update of the target after any repaint of the window.

        The target moves with camera, layout, scroll bars and tool, and each of these causes a repaint.
        """
        if event.type() == QEvent.Type.UpdateRequest and not self._looking.isActive():
            self._looking.start()
        return False

    def _step(self, by: int) -> None:
        number = self._step_now + by
        if not self.is_active or number >= len(self._steps):
            self.end()
        else:
            self._show(number)

    def _show(self, number: int) -> None:
        self._step_now = number
        self._turned = False
        self._reading.stop()
        if number == _RING:
            self.ring_requested.emit()
        self.card.show_step(number, len(self._steps), self._sentence)
        self.update_target()

    def update_target(self) -> None:
        """Point the card at the step's target, and advance if the step is complete."""
        if not self.is_active:
            return
        step = self._steps[self._step_now]
        target = step.target()
        self.card.show_sentence(
            self._sentence if target is not None else step.hidden_sentence or self._sentence
        )
        gizmo = self.targets.gizmo() if self._step_now <= _AREA else None
        self.card.point_at(target, gizmo or QRect())
        if self._step_now == _AREA and self._turned and self._rests() and not self._reading.isActive():
            self._reading.start()

    @property
    def _sentence(self) -> str:
        """Sentence of the current step, adapted to the method."""
        if self._step_now == _AREA and not self._holds():
            return _NOT_HELD
        return self._steps[self._step_now].sentence

    def _advance(self) -> None:
        """Advance to the next step, unless the card is hidden."""
        if self.card.isVisible():
            self._step(1)

    def _begin_drag(self) -> None:
        self._pose = self._canvas.gizmo.pose
        self._turned = False
        self._reading.stop()

    def _detect_rotation(self) -> None:
        """Detect whether the drag has rotated the handle."""
        old, new = (
            pose[:3, :3] / np.linalg.norm(pose[:3, :3]) for pose in (self._pose, self._canvas.gizmo.pose)
        )
        self._turned = not np.allclose(old, new)
        if self._step_now == _RING and self._turned:
            self._advance()


_MOST_POINTS = 500  # largest sample of mesh vertices, for speed


class TourTargets:
    """Rectangles of the tour's targets in a window, each None if out of sight."""

    def __init__(self, window: QMainWindow, canvas: Canvas, actions: Actions, panel: Panel) -> None:
        self._window = window
        self._canvas = canvas
        self._actions = actions
        self._panel = panel

    def mesh(self) -> QRect | None:
        """Rectangle of the mesh in the window."""
        U = self._canvas.surface.U
        return self._box_around_points(
            self._canvas.viewport.camera_controller.camera.project(U[:: 1 + len(U) // _MOST_POINTS])
        )

    def rings(self) -> QRect | None:
        """Rectangle of the gizmo's rings in the window."""
        return self._gizmo(lambda frame, axis: frame.ring(axis)[0])

    def gizmo(self) -> QRect | None:
        """Rectangle of the whole gizmo in the window, with rings, arrows and letters."""
        return self._gizmo(lambda frame, axis: np.vstack([frame.ring(axis)[0], frame.arrow(axis)]))

    def area(self) -> QRect | None:
        """Rectangle of the area reading in the window."""
        area = self._panel.area
        return self._box_of_widgets([area.percent, area.verdict, area.area])

    def brushes(self) -> QRect | None:
        """Rectangle of the buttons of the painting tools."""
        return self._buttons([self._actions.tools[tool] for tool in Tool if tool.traits.is_brush])

    def export(self) -> QRect | None:
        """Rectangle of the export button."""
        return self._buttons([self._actions.file.export])

    def _gizmo(self, points: Callable[[GizmoFrame, int], np.ndarray]) -> QRect | None:
        gizmo = self._canvas.gizmo
        if not gizmo.visible or not gizmo.frame.is_visible:
            return None
        return self._box_around_points(np.vstack([points(gizmo.frame, axis) for axis in range(3)]))

    def _box_around_points(self, points: np.ndarray) -> QRect | None:
        """Visible part of the bounding box of viewport points."""
        view = self._canvas.viewport
        if not len(points) or not np.isfinite(points).all():
            return None
        # Coordinates far outside the view would overflow in Qt.
        low, high = np.clip([points.min(axis=0), points.max(axis=0)], -1e6, 1e6).round().astype(int)
        seen = QRect(QPoint(*low.tolist()), QPoint(*high.tolist())) & view.rect()
        return self._mapped_to_window(view, seen) if seen.isValid() else None

    def _buttons(self, actions: list[QAction]) -> QRect | None:
        return self._box_of_widgets([self._actions.bar.widgetForAction(action) for action in actions])

    def _box_of_widgets(self, widgets: list[QWidget]) -> QRect | None:
        """Bounding box of the visible parts of widgets."""
        found = QRect()
        for widget in widgets:
            if widget.isVisible() and not (seen := widget.visibleRegion().boundingRect()).isEmpty():
                found |= self._mapped_to_window(widget, seen)
        return found if found.isValid() else None

    def _mapped_to_window(self, widget: QWidget, rect: QRect) -> QRect:
        return rect.translated(widget.mapTo(self._window, QPoint()))
