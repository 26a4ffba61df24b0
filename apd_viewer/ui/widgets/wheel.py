"""The wheel over a control, left to what scrolls around it."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QAbstractSpinBox, QWidget


class _Past(QObject):
    def eventFilter(self, control: QObject, event: QEvent) -> bool:
        """Ignore the wheel, so that it goes on to the parent; a field in use takes it."""
        if event.type() is not QEvent.Type.Wheel:
            return False
        if isinstance(control, QAbstractSpinBox) and control.hasFocus():
            return False
        event.ignore()
        return True


def pass_wheel(control: QWidget) -> None:
    """Let the wheel over a control change neither its value nor the focus."""
    if control.focusPolicy() is Qt.FocusPolicy.WheelFocus:
        control.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    control.installEventFilter(_Past(control))
