"""Events of the mouse that widgets leave to others, or keep from them."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QWidget


class _Past(QObject):
    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Ignore the wheel, so that it goes on to the parent."""
        if event.type() is not QEvent.Type.Wheel:
            return False
        event.ignore()
        return True


def ignore_wheel(control: QWidget) -> None:
    """Let the wheel over a control change neither value nor focus, even in use.

    A filter of the whole application would be called in Python for every event of every widget.
    """
    if control.focusPolicy() is Qt.FocusPolicy.WheelFocus:
        control.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    control.installEventFilter(_Past(control))


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
