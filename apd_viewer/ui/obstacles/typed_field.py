"""Field of a value that can be typed anew."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal

from apd_viewer.ui.widgets.error_bubble import ErrorBubble
from apd_viewer.ui.widgets.fields import TextField, return_focus

if TYPE_CHECKING:
    from PySide6.QtGui import QFocusEvent, QHideEvent


class TypedField(TextField):
    """Entry that shows a value, and tells of another one on Enter and when it is left.

    Attributes
    ----------
    value_entered : Signal()
    error : ErrorBubble
    """

    value_entered = Signal()

    def __init__(self, name: str, tip: str) -> None:
        super().__init__(accessibleName=name, toolTip=tip)
        self._shown = ""
        self.error = ErrorBubble(self)
        self.textEdited.connect(self.error.hide)
        self.returnPressed.connect(self._enter)

    @property
    def is_changed(self) -> bool:
        """True if its text is not what was shown."""
        return self.text() != self._shown

    def show_text(self, text: str) -> None:
        """Show a value, unless another one is being typed."""
        if not (self.hasFocus() and self.is_changed and text == self._shown):
            self._shown = text
            if self.text() != text:
                self.setText(text)
                self.setCursorPosition(0)

    def show_error(self, sentence: str) -> None:
        """Say what is wrong beneath it; the text stays while the field is used."""
        self.error.show_message(sentence)
        if self.hasFocus():
            self.selectAll()
        else:
            self.setText(self._shown)
            self.error.hide_later()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Tell of another value."""
        super().focusOutEvent(event)
        if self.is_changed and event.reason() is not Qt.FocusReason.PopupFocusReason:
            self.value_entered.emit()
        self.error.hide_later()

    def restore(self) -> None:
        """Show the present value, and take back the error."""
        self.setText(self._shown)  # which may have changed since the field was entered
        self.error.hide()

    def hideEvent(self, event: QHideEvent) -> None:
        """Hide the error too."""
        self.error.hide()
        super().hideEvent(event)

    def _enter(self) -> None:
        if self.is_changed:
            self.value_entered.emit()
        if not self.error.isVisible():
            return_focus(self)
