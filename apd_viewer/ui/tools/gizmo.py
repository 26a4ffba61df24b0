"""Gizmo to move, rotate and scale a handle, and dots at inactive handles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QMouseEvent, QPainter, QPen

from apd_viewer.presentation.palette import handle_color
from apd_viewer.ui.scene.navigation import DEAD_ZONE, MouseTool
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.gizmo_drag import ALL_HANDLES, GizmoDrag, GizmoFrame, GizmoOrientation, begin_drag
from apd_viewer.ui.tools.gizmo_drawing import GizmoAppearance, draw_gizmo, draw_hint

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document


class Gizmo(MouseTool, QObject):
    """Tool to edit the pose of a handle.

    Drag an arrow, a square between two arrows, a ring, or the dot in the middle, which moves in the
    plane of the picture, as does what :attr:`may_grab` says; the square out at the corner scales. Ctrl
    snaps to 15 degrees, to round lengths or to tenths, Esc goes back.

    Attributes
    ----------
    began, ended, cancelled : Signal()
        A click that moves nothing emits none of them.
    moved : Signal(object)
        The new (4, 4) pose, while the drag goes on; once more the old one when it is cancelled.
    orientation : GizmoOrientation
        Orientation of the axes.
    may_grab : callable or None
        Whether a press at a position beside the gizmo takes the handle too.
    offered_handles : frozenset of str
        Handles of its own that it has.
    hint_changed : Signal(str)
        Amount of the drag, such as "+32.5°"; empty at its end.
    """

    began = Signal()
    moved = Signal(object)
    ended = Signal()
    cancelled = Signal()
    hint_changed = Signal(str)

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._pose: np.ndarray = np.eye(4)
        self._pivot: np.ndarray = np.zeros(3)
        self._visible = False
        self._along = GizmoOrientation.WORLD
        self.may_grab: Callable[[QPointF], bool] | None = None
        self.offered_handles = ALL_HANDLES
        self._hot: str | None = None
        self._drag: GizmoDrag | None = None
        self._moving = False  # True once the drag has left the dead zone

    @property
    def pose(self) -> np.ndarray:
        """Copy of the current pose, (4, 4)."""
        return self._pose.copy()

    @property
    def visible(self) -> bool:
        """True while shown; hiding it cancels a drag."""
        return self._visible

    @visible.setter
    def visible(self, on: bool) -> None:
        if not on:
            self.cancel()
            self._hot = None
        self._visible = on
        self._viewport.tool_layer.update()

    @property
    def orientation(self) -> GizmoOrientation:
        """Orientation of the gizmo's axes."""
        return self._along

    @orientation.setter
    def orientation(self, along: GizmoOrientation) -> None:
        self._along = along
        self._viewport.tool_layer.update()

    def place(self, pose: np.ndarray, pivot: np.ndarray) -> None:
        """Place the gizmo at ``pose`` applied to ``pivot``; ignored during a drag.

        Parameters
        ----------
        pose : (4, 4) float array
        pivot : (3,) float array
            Centre of the handle before the pose is applied.
        """
        if self._drag is None:
            self._pose, self._pivot = np.array(pose, dtype=float), np.array(pivot, dtype=float)
            self._viewport.tool_layer.update()

    @property
    def frame(self) -> GizmoFrame:
        """Layout of the gizmo for the current camera."""
        eye, A = self._viewport.camera_controller.camera, self._pose[:3, :3]
        centre, axes = A @ self._pivot + self._pose[:3, 3], np.eye(3)
        if self._along is GizmoOrientation.HANDLE:
            axes = (A / np.linalg.norm(A, axis=0)).T.copy()
        elif self._along is GizmoOrientation.VIEW:
            axes = eye.axes * [[1.0], [1.0], [-1.0]]
        return GizmoFrame(eye, centre, axes, self.offered_handles)

    def press(self, event: QMouseEvent) -> bool:
        """Begin a drag of the handle under the cursor."""
        handle = self._handle_at(event)
        if handle is None or event.button() != Qt.MouseButton.LeftButton:
            return False
        self.begin_drag(event.position(), handle)
        return True

    def begin_drag(self, position: QPointF, handle: str = "centre") -> None:
        """Begin a drag of a gizmo handle at a position in the viewport."""
        drag = begin_drag(handle, self.frame, self._pose, position.x(), position.y())
        self._drag, self._moving = drag, False
        self._show(handle, Qt.CursorShape.ClosedHandCursor)

    @property
    def is_dragged(self) -> bool:
        """True while a gizmo handle is pressed or dragged."""
        return self._drag is not None

    def move(self, event: QMouseEvent) -> bool:
        """Continue the drag, or highlight the gizmo handle under the cursor."""
        if self._drag is None:
            handle = self._handle_at(event)
            self._show(handle, Qt.CursorShape.OpenHandCursor)
            return handle is not None
        p = event.position()
        if not self._moving:
            if abs(p.x() - self._drag.start[0]) + abs(p.y() - self._drag.start[1]) <= DEAD_ZONE:
                return True
            self._moving = True
            self.began.emit()
        snap = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        self._drag = self._drag.moved_to(self._viewport.camera_controller.camera, p.x(), p.y(), snap)
        self._emit(self._drag.pose, self._drag.text)
        return True

    def release(self, _event: QMouseEvent) -> None:
        """End the drag."""
        if self._drag is None:
            return
        self._finish()
        if self._moving:
            self.ended.emit()

    def leave(self) -> None:
        """Remove the highlight."""
        self._show(None)

    def cancel(self) -> bool:
        """Restore the pose before the drag; True if there was a drag."""
        if self._drag is None:
            return False
        pose = self._drag.start_pose
        self._finish()
        if self._moving:
            self._emit(pose, "")
            self.cancelled.emit()
        return True

    def paint(self, painter: QPainter) -> None:
        """Draw the gizmo, and the amount of a drag."""
        if not self._visible:
            return
        draw_gizmo(painter, self.frame, GizmoAppearance(self._viewport.is_dark, self._hot, self._drag))
        if self._drag is not None and self._drag.text:
            draw_hint(painter, self._drag, (self._viewport.width(), self._viewport.height()))

    def _handle_at(self, event: QMouseEvent) -> str | None:
        p = event.position()
        if not self._visible:
            return None
        taken = self.frame.handle_at(p.x(), p.y())
        return taken or ("centre" if self.may_grab is not None and self.may_grab(p) else None)

    def _show(self, handle: str | None, cursor: Qt.CursorShape | None = None) -> None:
        if handle is not None and cursor is not None:
            self._viewport.setCursor(cursor)
        if handle != self._hot:
            self._hot = handle
            self._viewport.tool_layer.update()

    def _finish(self) -> None:
        self._drag = None
        self._viewport.unsetCursor()
        self._viewport.tool_layer.update()
        self.hint_changed.emit("")

    def _emit(self, pose: np.ndarray, text: str) -> None:
        self._pose = pose
        self._viewport.tool_layer.update()
        self.hint_changed.emit(text)
        self.moved.emit(pose.copy())


DOT_RADIUS = 6.0
PICK_RADIUS = 11.0


class HandlePivot(NamedTuple):
    """Pivot of a handle, with its number, name, colour and pose (4, 4).

    ``unposed_position`` (3,) is the centre of the handle before the pose is applied.
    """

    number: int
    name: str
    color: tuple[int, int, int]
    pose: np.ndarray
    unposed_position: np.ndarray

    @property
    def centre(self) -> np.ndarray:
        """Current centre of the handle, (3,)."""
        moved: np.ndarray = self.pose[:3, :3] @ self.unposed_position + self.pose[:3, 3]
        return moved


def movable_pivots(document: Document) -> tuple[HandlePivot, ...]:
    """Pivots of the movable handles."""
    if document.paint_problem is not None:
        return ()
    found = []
    for k, handle in enumerate(document.handles):
        pivot = document.pivot(k)
        if pivot is not None:
            found.append(HandlePivot(k, handle.name, handle_color(k), handle.pose, pivot))
    return tuple(found)


class InactiveHandles(MouseTool, QObject):
    """Tool to activate and drag another handle by its dot or painted patch.

    Parameters
    ----------
    gizmo : Gizmo
        Drags what was taken.
    handle_at : callable
        Function giving the number of the handle painted at a position in the viewport, or None.

    Attributes
    ----------
    chosen : Signal(int)
        Number of the handle that was pressed.
    pivots : tuple of HandlePivot
        Shown as dots.
    """

    chosen = Signal(int)

    def __init__(self, viewport: Viewport, gizmo: Gizmo, handle_at: Callable[[QPointF], int | None]) -> None:
        super().__init__(viewport)
        self._viewport, self._gizmo = viewport, gizmo
        self._handle_at = handle_at
        self.pivots: tuple[HandlePivot, ...] = ()
        self._hot: int | None = None

    def set_pivots(self, pivots: Sequence[HandlePivot]) -> None:
        """Set the pivots drawn as dots."""
        if pivots or self.pivots:
            self.pivots = tuple(pivots)
            self._viewport.tool_layer.update()

    def press(self, event: QMouseEvent) -> bool:
        """Begin a drag of the handle under the cursor."""
        pans = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        number = self._number_at(event.position())
        if number is None or pans or event.button() != Qt.MouseButton.LeftButton:
            return False
        self.chosen.emit(number)
        self._gizmo.begin_drag(event.position())
        return True

    def release(self, event: QMouseEvent) -> None:
        """End the drag of the activated handle."""
        self._gizmo.release(event)

    def move(self, event: QMouseEvent) -> bool:
        """Drag the activated handle, or show the name of the one under the cursor."""
        if self._gizmo.is_dragged:
            return self._gizmo.move(event)
        number = self._number_at(event.position())
        self._show(number)
        if number is not None:
            self._viewport.setCursor(Qt.CursorShape.PointingHandCursor)
        return number is not None

    def leave(self) -> None:
        """Remove the highlight."""
        self._show(None)

    def paint(self, painter: QPainter) -> None:
        """Draw the dots, and the name of the handle under the cursor."""
        for pivot in self.pivots:
            at = self._screen_position(pivot)
            if at is not None:
                self._draw(painter, pivot, QPointF(*at))

    def _draw(self, painter: QPainter, pivot: HandlePivot, at: QPointF) -> None:
        hot = pivot.number == self._hot
        painter.setOpacity(1.0 if hot else 0.85)
        painter.setPen(QPen(QColor(255, 255, 255, 235), 2.0))
        painter.setBrush(QColor(*pivot.color))
        radius = DOT_RADIUS + 1.5 if hot else DOT_RADIUS
        painter.drawEllipse(at, radius, radius)
        painter.setPen(QPen(QColor(20, 22, 26, 150), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(at, radius + 1.5, radius + 1.5)
        if hot:
            font = QFont(painter.font())
            font.setPixelSize(13)
            font.setWeight(QFont.Weight.DemiBold)
            painter.setFont(font)
            width = painter.fontMetrics().horizontalAdvance(pivot.name) + 20.0
            box = QRectF(at.x() + 14, at.y() - 13, width, 26)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(24, 26, 30, 225))
            painter.drawRoundedRect(box, 7, 7)
            painter.setPen(QColor("#ffffff"))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, pivot.name)
        painter.setOpacity(1.0)

    def _screen_position(self, pivot: HandlePivot) -> np.ndarray | None:
        eye = self._viewport.camera_controller.camera
        if float(eye.depth(pivot.centre)) <= 1e-6 * eye.distance:
            return None
        at: np.ndarray = eye.project(pivot.centre[None])[0]
        return at

    def _dot_at(self, position: QPointF) -> int | None:
        cursor = np.array([position.x(), position.y()])
        for pivot in self.pivots:
            at = self._screen_position(pivot)
            if at is not None and np.linalg.norm(at - cursor) <= PICK_RADIUS:
                return pivot.number
        return None

    def _number_at(self, position: QPointF) -> int | None:
        """Number of the inactive handle whose dot or paint is at a position, or None."""
        dot = self._dot_at(position)
        if dot is not None or not self.pivots:
            return dot
        number = self._handle_at(position)
        return number if number in {pivot.number for pivot in self.pivots} else None

    def _show(self, number: int | None) -> None:
        if number != self._hot:
            self._hot = number
            self._viewport.tool_layer.update()
