"""Dots at the pivots of inactive handles, taken and moved by a press and a drag."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPainter, QPen

from apd_viewer.presentation.palette import handle_color
from apd_viewer.ui.scene.mouse_tool import MouseTool

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent

    from apd_viewer.session.model.document import Document
    from apd_viewer.ui.scene.viewport import Viewport
    from apd_viewer.ui.tools.gizmo import Gizmo

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
        """The centre of the handle now, (3,)."""
        moved: np.ndarray = self.pose[:3, :3] @ self.unposed_position + self.pose[:3, 3]
        return moved


def movable_pivots(document: Document) -> tuple[HandlePivot, ...]:
    """Pivots of the movable handles."""
    if document.paint_problem is not None:
        return ()
    found = []
    for k, handle in enumerate(document.handles):
        gripped = document.pivot(k)
        if gripped is not None:
            found.append(HandlePivot(k, handle.name, handle_color(k), handle.pose, gripped))
    return tuple(found)


class InactiveHandles(MouseTool, QObject):
    """Tool to take another handle by its dot or its painted patch, and to move it.

    Parameters
    ----------
    viewport : Viewport
    gizmo : Gizmo
        Drags what was taken.
    handle_at : callable
        From a position in the viewport to the number of the handle that is painted there, or None.

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
        """Show the dots of these pivots."""
        if pivots or self.pivots:
            self.pivots = tuple(pivots)
            self._viewport.tool_layer.update()

    def press(self, event: QMouseEvent) -> bool:
        """Take the handle under the cursor."""
        pans = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        number = self._taken_at(event.position())
        if number is None or pans or event.button() != Qt.MouseButton.LeftButton:
            return False
        self.chosen.emit(number)
        self._gizmo.begin_drag(event.position())
        return True

    def release(self, event: QMouseEvent) -> None:
        """Release the handle."""
        self._gizmo.release(event)

    def move(self, event: QMouseEvent) -> bool:
        """Move the handle taken, or show the name of the one under the cursor."""
        if self._gizmo.is_dragged:
            return self._gizmo.move(event)
        number = self._taken_at(event.position())
        self._show(number)
        if number is not None:
            self._viewport.setCursor(Qt.CursorShape.PointingHandCursor)
        return number is not None

    def leave(self) -> None:
        """Forget the cursor."""
        self._show(None)

    def paint(self, painter: QPainter) -> None:
        """Draw the dots, and the name of the one under the cursor."""
        for pivot in self.pivots:
            at = self._on_screen(pivot)
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

    def _on_screen(self, pivot: HandlePivot) -> np.ndarray | None:
        eye = self._viewport.camera_controller.camera
        if float(eye.depth(pivot.centre)) <= 1e-6 * eye.distance:
            return None
        at: np.ndarray = eye.project(pivot.centre[None])[0]
        return at

    def _dot_at(self, position: QPointF) -> int | None:
        cursor = np.array([position.x(), position.y()])
        for pivot in self.pivots:
            at = self._on_screen(pivot)
            if at is not None and np.linalg.norm(at - cursor) <= PICK_RADIUS:
                return pivot.number
        return None

    def _taken_at(self, position: QPointF) -> int | None:
        """Number of the handle with a dot or paint at a position."""
        dot = self._dot_at(position)
        if dot is not None or not self.pivots:
            return dot
        number = self._handle_at(position)
        return number if number in {pivot.number for pivot in self.pivots} else None

    def _show(self, number: int | None) -> None:
        if number != self._hot:
            self._hot = number
            self._viewport.tool_layer.update()
