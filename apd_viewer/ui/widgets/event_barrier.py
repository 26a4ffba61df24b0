"""Keeps the mouse from what lies behind a widget; unshielded, what it does not want goes to the canvas."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QWidget

_KEPT = {
    QEvent.Type.MouseButtonPress,
    QEvent.Type.MouseButtonDblClick,
    QEvent.Type.MouseMove,
    QEvent.Type.Wheel,
}


class _Shield(QObject):
    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Take what neither the widget nor its children had a use for."""
        return event.type() in _KEPT


def shield(widget: QWidget) -> None:
    """Have mouse events end at ``widget``, whose buttons and fields get theirs as ever."""
    widget.installEventFilter(_Shield(widget))
