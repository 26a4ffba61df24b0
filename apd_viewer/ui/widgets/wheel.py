"""Filters for the mouse events that a widget passes to its parent."""

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QWidget


class _WheelIgnorer(QObject):
    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Ignore the wheel, so that Qt passes it to the parent."""
        if event.type() is not QEvent.Type.Wheel:
            return False
        event.ignore()
        return True


def ignore_wheel(control: QWidget) -> None:
    """Stop the wheel from changing a control's value or focus.

    A filter of the whole application would be called in Python for every event of every widget.
    """
    if control.focusPolicy() is Qt.FocusPolicy.WheelFocus:
        control.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    control.installEventFilter(_WheelIgnorer(control))


_KEPT = {
    QEvent.Type.MouseButtonPress,
    QEvent.Type.MouseButtonDblClick,
    QEvent.Type.MouseMove,
    QEvent.Type.Wheel,
}


class _MouseEventBlocker(QObject):
    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Consume events unused by the widget and its children."""
        return event.type() in _KEPT


def block_mouse_events(widget: QWidget) -> None:
    """Keep unhandled mouse events on ``widget`` from reaching its parent."""
    widget.installEventFilter(_MouseEventBlocker(widget))
