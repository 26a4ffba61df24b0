"""A card over the canvas with one line to type into."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout

from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.selection_tool import stroke_effect
from apd_viewer.ui.widgets.event_barrier import shield

_WIDTH = 480
_MARGIN = 12


class TextEntryCard(QFrame):
    """Entry line with a live preview.

    Parameters
    ----------
    canvas : Viewport
    title, name, example : str
        What stands before the line, what the line is called, and what could be typed.
    help : str
        How to go on, said where nothing else is.

    Attributes
    ----------
    text_changed : Signal(str)
        The text has changed.
    text_entered : Signal(str, object)
        The text, and the Act.
    closed : Signal()
    message_label : QLabel
        What the text means, or what is wrong with it.
    """

    text_changed = Signal(str)
    text_entered = Signal(str, object)
    closed = Signal()

    def __init__(self, canvas: Viewport, title: str, name: str, example: str, help: str) -> None:  # noqa: A002
        super().__init__(canvas, objectName="notice")
        shield(self)
        self._canvas = canvas
        self.help = help
        self.text = _Line(objectName="typed", placeholderText=example, accessibleName=name)
        self.text.textChanged.connect(self.text_changed)
        self.text.entered.connect(lambda act: self.text_entered.emit(self.text.text(), act))
        self.text.left.connect(self.close_card)
        plain = Qt.TextFormat.PlainText
        self.message_label = QLabel(help, objectName="quiet", wordWrap=True, textFormat=plain)
        line = QHBoxLayout(spacing=8)
        line.addWidget(QLabel(title))
        line.addWidget(self.text, 1)
        column = self._column = QVBoxLayout(self, spacing=6)
        column.setContentsMargins(12, 10, 12, 10)
        column.addLayout(line)
        column.addWidget(self.message_label)
        canvas.resized.connect(self._place)
        self.hide()

    def open_card(self) -> None:
        """Show it, with the cursor in it."""
        self.show()
        self._place()
        self.raise_()
        self.text.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.text.selectAll()
        self.text_changed.emit(self.text.text())

    def close_card(self) -> None:
        """Hide the card and return the focus to the canvas."""
        self.hide()
        self._canvas.setFocus()
        self.closed.emit()

    def show_message(self, sentence: str) -> None:
        """Show a result or an error; the usage if empty."""
        self.message_label.setText(sentence or self.help)
        self._place()

    def _place(self) -> None:
        self.setFixedWidth(min(_WIDTH, self._canvas.width() - 2 * _MARGIN))
        # The height for a width is never less than the smallest height, which the last words have set.
        self.message_label.setMinimumHeight(0)
        edges = self._column.contentsMargins()
        self.message_label.setFixedHeight(
            self.message_label.heightForWidth(self.width() - edges.left() - edges.right())
        )
        self._column.activate()
        self.adjustSize()
        self.move((self._canvas.width() - self.width()) // 2, self._canvas.height() - self.height() - 64)


class _Line(QLineEdit):
    entered = Signal(object)
    left = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Accept on Return, close on Esc."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.entered.emit(stroke_effect(event))
        elif event.key() == Qt.Key.Key_Escape:
            self.left.emit()
        else:
            super().keyPressEvent(event)
