"""Error message beneath a field."""

from __future__ import annotations

from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtGui import QAccessible, QAccessibleEvent
from PySide6.QtWidgets import QAbstractScrollArea, QLabel, QWidget

_WIDTH = 232
_GAP = 4
_AFTER_LEAVING = 6_000  # ms


class ErrorBubble(QLabel):
    """Error message floating beneath a field, without moving the layout.

    Parameters
    ----------
    field : QWidget
    """

    def __init__(self, field: QWidget) -> None:
        super().__init__(field, objectName="error", wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self._field = field
        self._leaving = QTimer(self, singleShot=True, interval=_AFTER_LEAVING)
        self._leaving.timeout.connect(self.hide)
        field.destroyed.connect(self.deleteLater)
        self.hide()

    def show_message(self, sentence: str) -> None:
        """Show a sentence for as long as the field is used."""
        self._leaving.stop()
        ground = _ground(self._field)
        self.setParent(ground)
        self.setText(sentence)
        self.setAccessibleName(sentence)
        self.setFixedWidth(_WIDTH)
        self.setFixedHeight(self.heightForWidth(_WIDTH))
        self.move(self._beneath(ground))
        self.show()
        self.raise_()
        QAccessible.updateAccessibility(QAccessibleEvent(self, QAccessible.Event.Alert))

    def hide_later(self) -> None:
        """Hide after a while."""
        self._leaving.start()

    def _beneath(self, ground: QWidget) -> QPoint:
        """Beneath the field, or above it, and within the ground."""
        field = self._field
        corner = field.mapTo(ground, QPoint(field.width() - self.width(), field.height() + _GAP))
        if corner.y() + self.height() > ground.height():
            corner.setY(corner.y() - self.height() - field.height() - 2 * _GAP)
        corner.setX(min(max(corner.x(), _GAP), ground.width() - self.width() - _GAP))
        return corner


def _ground(field: QWidget) -> QWidget:
    """Content of the scroll area around a field, or its window."""
    ground = field
    while (above := ground.parentWidget()) is not None and not ground.isWindow():
        if isinstance(above.parentWidget(), QAbstractScrollArea):
            break
        ground = above
    return ground
