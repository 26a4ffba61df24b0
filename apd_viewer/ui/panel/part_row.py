"""Row of a part in its list."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.session.model.named_parts import NO_FLAGS, PartFlags
from apd_viewer.ui.panel.part_buttons import PartButtons
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.theme import mark


class Swatch(QWidget):
    """Square in a part's colour on the mesh."""

    def __init__(self, color: tuple[int, int, int]) -> None:
        super().__init__()
        self.setFixedSize(14, 14)
        self._color = QColor(*color)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the square."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(self._color)
        painter.drawRoundedRect(QRectF(1, 1, 12, 12), 3, 3)


class Name(QLineEdit):
    """Name edited in place: Enter accepts, Esc restores.

    Attributes
    ----------
    chosen : Signal(str)
    """

    chosen = Signal(str)

    def __init__(self, text: str) -> None:
        super().__init__(objectName="name", frame=False)
        self.setAccessibleName(tr("Name"))
        self.setMinimumHeight(self.fontMetrics().height() + 8)
        self._kept = text
        self.rest()

    def show_name(self, text: str) -> None:
        """Show another name."""
        if text != self._kept:
            self._kept = text
            if self.isReadOnly():
                self.rest()

    def edit(self) -> None:
        """Let the user type."""
        self.setReadOnly(False)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents, False)
        self.setFocus()
        self.selectAll()
        self.update_look()

    def rest(self) -> None:
        """Show the name and leave the mouse to the row."""
        self.setReadOnly(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setText(self._kept)
        self.setToolTip(self._kept)
        self.setCursorPosition(0)
        self.deselect()
        self.update_look()

    def update_look(self) -> None:
        """Let the style sheet look at ``readOnly`` again."""
        self.style().unpolish(self)
        self.style().polish(self)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Accept on Enter, restore on Esc."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish(self.text())
        elif event.key() == Qt.Key.Key_Escape:
            self._finish(self._kept)
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Accept the text."""
        super().focusOutEvent(event)
        self._finish(self.text())

    def _finish(self, text: str) -> None:
        if self.isReadOnly():
            return
        before = self._kept
        self.rest()
        row = self.parentWidget()
        if row is not None:
            row.setFocus()
        if text.strip() and text.strip() != before:
            self.chosen.emit(text.strip())


# Tooltips by the kind of part: of its reading, and of the button to remove it.
_SAID = {
    "handle": (tr("Measurement of the handle"), tr("Remove this handle")),
    "region": (tr("Measurement of the region"), tr("Remove this region")),
    "measurement": (tr("Measured value"), tr("Remove this measurement")),
}


class PartRow(QFrame):
    """Row of the list: colour, name, reading, and details of the active part.

    Attributes
    ----------
    chosen, removed : Signal()
    renamed : Signal(str)
    stepped : Signal(int)
        The arrow keys ask for the row above, -1, or below, 1.
    reading : QLabel
    buttons : PartButtons
    details : QWidget
    """

    chosen = Signal()
    removed = Signal()
    renamed = Signal(str)
    stepped = Signal(int)

    def __init__(self, kind: str, name: str, color: tuple[int, int, int], details: QWidget) -> None:
        super().__init__(objectName="part", focusPolicy=Qt.FocusPolicy.StrongFocus)
        self.setToolTip(tr("Click to activate, double-click or F2 to rename, Delete to remove"))
        self.name = Name(name)
        reading, remove = _SAID[kind]
        self.reading = QLabel("", objectName="quiet", accessibleName=reading)
        self.details = details
        self.buttons = PartButtons()
        self.remove = small_button(remove, remove)
        line = QHBoxLayout(spacing=8)
        line.addWidget(Swatch(color))
        line.addWidget(self.name, 1)
        line.addWidget(self.reading)
        line.addWidget(self.remove)
        below = QHBoxLayout(spacing=4)
        below.addWidget(details, 1)
        below.addWidget(self.buttons, 0, Qt.AlignmentFlag.AlignRight)
        column = QVBoxLayout(self, spacing=2)
        column.setContentsMargins(8, 3, 4, 3)
        column.addLayout(line)
        column.addLayout(below)
        self.name.chosen.connect(self.renamed)
        self.remove.clicked.connect(self.removed)
        self.set_active(False)

    def set_active(self, on: bool) -> None:
        """Show whether this is the active part."""
        self.setAccessibleName(tr("{name}, active").format(name=self.name.text()) if on else self.name.text())
        mark(self, "active", on)
        self.details.setVisible(on)
        self._active = on

    def show_flags(self, flags: PartFlags, painted: bool) -> None:
        """Show the buttons where there is something to do or to see."""
        self.buttons.show_flags(flags, painted)
        self.buttons.setVisible(self._active or flags != NO_FLAGS)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Ask to be the active one."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.chosen.emit()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Let the name be edited."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.name.edit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Choose, rename, remove, or go to a neighbour."""
        key = event.key()
        if key in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space):
            self.chosen.emit()
        elif key == Qt.Key.Key_F2:
            self.name.edit()
        elif key == Qt.Key.Key_Delete and not self.remove.isHidden():
            self.removed.emit()
        elif key in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.stepped.emit(-1 if key == Qt.Key.Key_Up else 1)
        else:
            super().keyPressEvent(event)
