"""Picking the point of the mesh that a handle turns about."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QPen

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QPainter

    from apd_viewer.ui.surface import Hit, Surface
    from apd_viewer.ui.viewport import Viewport

_ARM = 9.0


class PivotPicker(QObject):
    """Tool that takes one click on the mesh, once it is asked to; Esc calls it off.

    Attributes
    ----------
    picked : Signal(object)
        The point, (3,) float array.
    """

    picked = Signal(object)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._surface = surface
        self._waits = False
        self._hit: Hit | None = None

    def ask(self) -> None:
        """Take the next click."""
        self._waits = True

    def press(self, event: QMouseEvent) -> bool:
        """Take the point under the cursor."""
        if not self._waits or event.button() != Qt.MouseButton.LeftButton:
            return False
        self._hit = self._surface.hit(event.position())
        return self._hit is not None

    def move(self, event: QMouseEvent) -> bool:
        """Show the point that a click would take."""
        if not self._waits:
            return False
        self._hit = self._surface.hit(event.position())
        if self._hit is not None:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        self._viewport.overlay.update()
        return self._hit is not None

    def release(self, event: QMouseEvent) -> bool:
        """Tell the point."""
        hit = self._surface.hit(event.position())
        if hit is not None:
            self.cancel()
            self.picked.emit(hit.point)
        return True

    def leave(self) -> None:
        """The cursor is somewhere else."""
        if self._hit is not None:
            self._hit = None
            self._viewport.overlay.update()

    def cancel(self) -> bool:
        """Take no click any more; True if one was waited for."""
        waited, self._waits = self._waits, False
        self.leave()
        return waited

    def paint(self, painter: QPainter) -> None:
        """Draw a cross at the point."""
        if self._hit is None:
            return
        at = QPointF(*self._viewport.project(self._hit.point[None])[0])
        for color, width in ((QColor(255, 255, 255, 220), 4.5), (QColor(24, 26, 30), 1.8)):
            painter.setPen(QPen(color, width, c=Qt.PenCapStyle.RoundCap))
            painter.drawLine(at - QPointF(_ARM, 0), at + QPointF(_ARM, 0))
            painter.drawLine(at - QPointF(0, _ARM), at + QPointF(0, _ARM))
