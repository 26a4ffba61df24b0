"""Barrier for mouse events over the canvas."""

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
        """Consume events unused by the widget and its children."""
        return event.type() in _KEPT


def shield(widget: QWidget) -> None:
    """Stop mouse events at ``widget``; its children still get theirs."""
    widget.installEventFilter(_Shield(widget))
