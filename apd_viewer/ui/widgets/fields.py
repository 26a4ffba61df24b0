"""Input fields for one value: combo box, check box, number and text field."""

import re
from contextlib import suppress
from functools import partial
from typing import Any

from PySide6 import QtGui, QtWidgets
from PySide6.QtCore import QPoint, QPointF, QRectF, QSize, Qt, QTimer, Signal

from apd_viewer.errors import InputError
from apd_viewer.geometry.goals import target_values
from apd_viewer.language import tr
from apd_viewer.notation import editable_number, localized_number, notation
from apd_viewer.presentation.number_format import format_short
from apd_viewer.session.quantities.expressions import check_unambiguous, unambiguous_text
from apd_viewer.ui.widgets.thin_bar import elided_text
from apd_viewer.ui.widgets.wheel import ignore_wheel

_UNBOUNDED = 1e9  # limits from here on only guard the arithmetic; not shown to users
_MOST_IN_SIGHT = 24  # entries of a list
_QUOTED = 20  # characters quoted from invalid input
_SYMBOLS = '%°"′″'  # units that are no letters


class ComboBox(QtWidgets.QComboBox):
    """Combo box ignoring the wheel, so that a panel can scroll over it."""

    def __init__(self, **properties: Any) -> None:
        super().__init__(maxVisibleItems=_MOST_IN_SIGHT, **properties)
        self.setItemDelegate(QtWidgets.QStyledItemDelegate(self))  # the style's own ignores the style sheet
        ignore_wheel(self)

    def sizeHint(self) -> QSize:
        """Height of a field, and width of the longest entry."""
        texts = [self.itemText(k) for k in range(self.count())]
        longest = max((self.fontMetrics().horizontalAdvance(text) for text in texts), default=0)
        width = max(super().sizeHint().width(), longest + 40)
        return QSize(width, max(28, self.fontMetrics().height() + 12))

    def minimumSizeHint(self) -> QSize:
        """Preferred size, so that no entry is cut off."""
        return self.sizeHint()

    def paintEvent(self, _: QtGui.QPaintEvent) -> None:
        """Draw the current entry and a chevron."""
        room, ink = QRectF(self.rect()), self.palette().windowText().color()
        painter = QtGui.QPainter(self)
        painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
        _draw_field(painter, self)
        painter.setPen(ink)
        words = room.adjusted(8, 0, -28, 0)
        text = elided_text(self.currentText(), self.fontMetrics(), words.width())
        painter.drawText(words, Qt.AlignmentFlag.AlignVCenter, text)
        painter.setPen(QtGui.QPen(ink, 1.5, c=Qt.PenCapStyle.RoundCap, j=Qt.PenJoinStyle.RoundJoin))
        tip = room.center() + QPointF(room.width() / 2 - 14, 2)
        painter.drawPolyline([tip - QPointF(4, 4), tip, tip + QPointF(4, -4)])


class CheckBox(QtWidgets.QCheckBox):
    """Check box visible on dark panels too."""

    def paintEvent(self, _: QtGui.QPaintEvent) -> None:
        """Draw the box, its check mark and the text."""
        palette, on = self.palette(), self.isChecked()
        accent, line = palette.highlight().color(), palette.placeholderText().color()
        box = QRectF(0.75, self.height() / 2 - 7.25, 14.5, 14.5)
        painter = QtGui.QPainter(self)
        painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
        painter.setPen(QtGui.QPen(accent if on or self.hasFocus() else line, 1.5))
        painter.setBrush(accent if on else palette.base())
        painter.drawRoundedRect(box, 4, 4)
        if on:
            painter.setPen(QtGui.QPen(palette.highlightedText().color(), 1.75, c=Qt.PenCapStyle.RoundCap))
            middle = box.center()
            painter.drawPolyline([middle + QPointF(*p) for p in ((-3.5, 0.25), (-1, 2.75), (3.5, -2.5))])
        painter.setPen(palette.windowText().color())
        room = QRectF(self.rect()).adjusted(24, 0, 0, 0)
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, self.text())
        if self.hasFocus():
            width = self.fontMetrics().horizontalAdvance(self.text())
            under = round(room.center().y() + self.fontMetrics().height() / 2)
            painter.fillRect(QRectF(24, under - 1, width, 2), accent)

    def sizeHint(self) -> QSize:
        """Size of the box and the text."""
        width = 24 + self.fontMetrics().horizontalAdvance(self.text()) + 2
        return QSize(width, max(22, self.fontMetrics().height() + 4))

    def minimumSizeHint(self) -> QSize:
        """Preferred size, so that the text is not cut off."""
        return self.sizeHint()


class NumberField(QtWidgets.QDoubleSpinBox):
    """Number field; Enter and Esc return the focus, invalid input is explained.

    Parameters
    ----------
    brief : bool
        Whether zeros at the end are left out.
    is_percentage : bool
        Whether a small number, typed without a sign of its own, could be meant as a factor.
    is_grouped : bool
        Whether the digits of a whole number are grouped, as in readings.
    properties
        Of the spin box; a ``specialValueText`` stands for its minimum, and can be typed.
    """

    def __init__(
        self, brief: bool = False, is_percentage: bool = False, is_grouped: bool = True, **properties: Any
    ) -> None:
        self._brief, self._is_percentage, self._is_grouped = brief, is_percentage, is_grouped
        super().__init__(keyboardTracking=False, alignment=Qt.AlignmentFlag.AlignRight, **properties)
        self.setButtonSymbols(QtWidgets.QDoubleSpinBox.ButtonSymbols.NoButtons)
        self.setFixedSize(84, max(28, self.fontMetrics().height() + 12))
        self.lineEdit().setTextMargins(4, 0, 4, 0)
        self.error = ErrorBubble(self)
        self.lineEdit().textEdited.connect(self.error.hide)
        self.lineEdit().returnPressed.connect(partial(return_focus, self))
        ignore_wheel(self)

    def show_value(self, value: float) -> None:
        """Set the value without emitting a signal."""
        if value != self.value():
            self.blockSignals(True)
            self.setValue(value)
            self.blockSignals(False)

    def paintEvent(self, _: QtGui.QPaintEvent) -> None:
        """Draw the background; the line edit inside draws the text."""
        painter = QtGui.QPainter(self)
        painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
        _draw_field(painter, self)

    def textFromValue(self, value: float) -> str:
        """Number with all digits, readable as input; only those of a count are grouped."""
        if self._is_count:
            return localized_number(f"{value:,.0f}" if self._is_grouped else f"{value:.0f}")
        return editable_number(f"{value:.10g}" if self._brief else f"{value:.{self.decimals()}f}")

    def validate(self, text: str, position: int) -> tuple[QtGui.QValidator.State, str, int]:
        """Accept any text while typing; loss of focus replaces invalid ones."""
        wrong = self._problem(text)
        return (
            (QtGui.QValidator.State.Intermediate if wrong else QtGui.QValidator.State.Acceptable),
            text,
            position,
        )

    def fixup(self, _: str) -> str:
        """Text of the last valid number."""
        if self.specialValueText() and self.value() == self.minimum():
            return self.specialValueText()
        return f"{self.prefix()}{self.textFromValue(self.value())}{self.suffix()}"

    def valueFromText(self, text: str) -> float:
        """Typed number, such as 1e-3 or 0,5."""
        if self._problem(text):
            return self.value()
        if self._is_special(text):
            return self.minimum()
        value = float(self._digits(text))
        return float(round(value)) if self._is_count else value

    def _digits(self, text: str) -> str:
        return self._number_text(text).replace(",", ".")

    def _is_special(self, text: str) -> bool:
        """True for the word of the minimum."""
        word = self.specialValueText().casefold()
        return bool(word) and text.removesuffix(self.suffix()).strip().casefold() == word

    def _number_text(self, text: str) -> str:
        # The suffix remains after the typed text, which may repeat it.
        number = text.removesuffix(self.suffix()).strip().removesuffix(self.suffix().strip())
        number = number.strip(" %")
        grouped = re.fullmatch(rf"[1-9]\d{{0,2}}([{re.escape(notation().group)}\s]\d{{3}})+", number)
        return re.sub(r"\D", "", number) if self._is_count and grouped else number

    @property
    def _is_count(self) -> bool:
        return self.decimals() == 0

    def _problem(self, text: str) -> str:
        """Error message for an invalid text, with the allowed range; empty if valid."""
        if text == self.fixup("") or self._is_special(text):
            return ""  # the text shown for the current value is always valid
        digits = self._digits(text)
        try:
            if self.minimum() <= float(digits) <= self.maximum():
                return self._doubt(text, float(digits))
            sentence = tr("“{text}” is out of range; enter a number {range}.")
        except ValueError:
            sentence = tr("“{text}” is not a number; enter one {range}.")
            if not digits:
                sentence = tr("Enter a number {range}.")
        return sentence.format(text=digits[:_QUOTED], range=self._range)

    def _doubt(self, text: str, value: float) -> str:
        """Question about an ambiguous number; empty if it is clear."""
        try:
            check_unambiguous(unambiguous_text(self._number_text(text)), ",")
            if self._is_percentage and not text.removesuffix(self.suffix()).rstrip().endswith(
                target_values.PERCENT_SIGN
            ):
                target_values.check_not_factor(value)
        except InputError as error:
            return str(error)
        return ""

    @property
    def _range(self) -> str:
        least, most, unit = self.minimum(), self.maximum(), self.suffix()
        if most < _UNBOUNDED:
            return tr("from {least} to {most}").format(
                least=format_short(least), most=format_short(most) + unit
            )
        if least > 0.0:
            return tr("greater than 0")
        return tr("of at least {least}").format(least=format_short(least) + unit)

    def focusInEvent(self, event: QtGui.QFocusEvent) -> None:
        """Select the number, ready to be overwritten."""
        super().focusInEvent(event)
        if event.reason() in (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason):
            self.selectAll()
        elif event.reason() == Qt.FocusReason.MouseFocusReason:
            QTimer.singleShot(0, self, self.selectAll)  # after the press, which places the cursor

    def focusOutEvent(self, event: QtGui.QFocusEvent) -> None:
        """Restore the number, and show why an entry was invalid."""
        self._refuse()
        super().focusOutEvent(event)
        self.error.hide_later()

    def hideEvent(self, event: QtGui.QHideEvent) -> None:
        """Hide the error together with the field."""
        self.error.hide()
        super().hideEvent(event)

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        """Restore the number on Esc; on Enter keep an invalid text for correction."""
        if event.key() == Qt.Key.Key_Escape:
            self.lineEdit().setText(self.fixup(""))
            self.error.hide()
            return_focus(self)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self._refuse():
            self.selectAll()
        else:
            super().keyPressEvent(event)

    def _refuse(self) -> bool:
        """Explain an invalid text; True if it is invalid."""
        problem = self._problem(self.lineEdit().text())
        if problem:
            self.error.show_message(problem)
        return bool(problem)


class TextField(QtWidgets.QLineEdit):
    """Line edit; Esc restores its text and returns the focus.

    A number without a unit can be followed by one that is no part of the text.

    Attributes
    ----------
    focus_gained, focus_lost : Signal()
        The keys are its own, or no longer.
    """

    focus_gained = Signal()
    focus_lost = Signal()

    def __init__(self, **properties: Any) -> None:
        super().__init__(objectName="typed", **properties)
        self._before, self._unit = self.text(), ""
        self.textChanged.connect(self._leave_room)
        self.editingFinished.connect(self._complete_percentage)

    def focusInEvent(self, event: QtGui.QFocusEvent) -> None:
        """Store the text for Esc to restore."""
        super().focusInEvent(event)
        self._before = self.text()
        self.focus_gained.emit()

    def focusOutEvent(self, event: QtGui.QFocusEvent) -> None:
        """Keep the text, and emit the loss of focus."""
        super().focusOutEvent(event)
        self.focus_lost.emit()

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        """Restore the text on Esc and return the focus."""
        if event.key() == Qt.Key.Key_Escape:
            self.restore()
            return_focus(self)
        else:
            super().keyPressEvent(event)

    def restore(self) -> None:
        """Restore the text from before the field got the focus."""
        self.setText(self._before)

    def show_unit(self, symbol: str) -> None:
        """Set the unit shown after numbers without one; none if empty."""
        if symbol != self._unit:
            self._unit = symbol
            self.setAccessibleDescription(symbol)
            self._leave_room()

    @property
    def shown_unit(self) -> str:
        """The unit after the text; empty if the text is no bare number."""
        text = self.text()
        is_bare = any(map(str.isdigit, text)) and not any(c.isalpha() or c in _SYMBOLS for c in text)
        return self._unit if is_bare else ""

    def _complete_percentage(self) -> None:
        """Write the sign after a bare percentage, unless it could be meant as a factor."""
        if self.shown_unit != target_values.PERCENT_SIGN:
            return
        with suppress(InputError, ValueError):
            number = unambiguous_text(self.text()).strip()
            target_values.check_not_factor(float(number.replace(",", ".")))
            self.setText(f"{number} {target_values.PERCENT_SIGN}")

    def _leave_room(self) -> None:
        unit = self.shown_unit
        self.setTextMargins(0, 0, self.fontMetrics().horizontalAdvance(unit) + _GAP if unit else 0, 0)
        self.update()

    def paintEvent(self, event: QtGui.QPaintEvent) -> None:
        """Draw the text, and the unit after it."""
        super().paintEvent(event)
        if unit := self.shown_unit:
            painter = QtGui.QPainter(self)
            painter.setPen(self.palette().placeholderText().color())
            room = self.rect().adjusted(0, 0, -2 * _GAP, 0)
            painter.drawText(room, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, unit)


def percent_field(name: str, tip: str) -> NumberField:
    """Field for a target in percent of the rest value."""
    return NumberField(
        is_percentage=True,
        accessibleName=name,
        toolTip=tip,
        minimum=target_values.LEAST_PERCENTAGE,
        maximum=target_values.MOST_PERCENTAGE,
        value=100.0,
        decimals=2,
        suffix=" %",
    )


def return_focus(field: QtWidgets.QWidget) -> None:
    """Return the keyboard focus to the window, for the document's shortcuts."""
    field.window().setFocus()


def small_button(name: str, tip: str) -> QtWidgets.QToolButton:
    """Small icon button without a frame."""
    return QtWidgets.QToolButton(objectName="small", accessibleName=name, toolTip=tip, iconSize=QSize(16, 16))


def keep_room(button: QtWidgets.QWidget) -> None:
    """Keep the place of a button in its row while it is hidden."""
    policy = button.sizePolicy()
    policy.setRetainSizeWhenHidden(True)
    button.setSizePolicy(policy)


def attach_menu(button: QtWidgets.QToolButton, menu: QtWidgets.QMenu) -> None:
    """Open a menu at a press of a button; nothing of the press stays on it afterwards."""
    button.setPopupMode(QtWidgets.QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keyboard focus where it is
    button.setMenu(menu)
    menu.aboutToHide.connect(lambda: QTimer.singleShot(0, button, partial(_forget_cursor, button)))


def _forget_cursor(button: QtWidgets.QToolButton) -> None:
    """Unset the hover state of a button whose cursor left under its menu."""
    if not button.rect().contains(button.mapFromGlobal(QtGui.QCursor.pos())):
        button.setAttribute(Qt.WidgetAttribute.WA_UnderMouse, False)
        button.update()


def _draw_field(painter: QtGui.QPainter, field: QtWidgets.QWidget) -> None:
    """Draw the field's background; the style's own is invisible on a dark panel."""
    palette = field.palette()
    painter.setPen(palette.highlight().color() if field.hasFocus() else palette.mid().color())
    painter.setBrush(palette.base())
    painter.drawRoundedRect(QRectF(field.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6)


_WIDTH = 232
_GAP = 4
_AFTER_LEAVING = 6_000  # ms


class ErrorBubble(QtWidgets.QLabel):
    """Error message below a field, floating over the layout."""

    def __init__(self, field: QtWidgets.QWidget) -> None:
        super().__init__(field, objectName="error", wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self._field = field
        self._leaving = QTimer(self, singleShot=True, interval=_AFTER_LEAVING, timeout=self.hide)
        field.destroyed.connect(self.deleteLater)
        self.hide()

    def show_message(self, sentence: str) -> None:
        """Show a message near the field, and announce it to screen readers."""
        self._leaving.stop()
        container = _container(self._field)
        self.setParent(container)
        self.setText(sentence)
        self.setAccessibleName(sentence)
        self.setFixedWidth(_WIDTH)
        self.setFixedHeight(self.heightForWidth(_WIDTH))
        self.move(self._bubble_position(container))
        self.show()
        self.raise_()
        QtGui.QAccessible.updateAccessibility(QtGui.QAccessibleEvent(self, QtGui.QAccessible.Event.Alert))

    def hide_later(self) -> None:
        """Hide the message after 6 s."""
        self._leaving.start()

    def _bubble_position(self, container: QtWidgets.QWidget) -> QPoint:
        """Position below the field, or above it, inside ``container``."""
        field = self._field
        corner = field.mapTo(container, QPoint(field.width() - self.width(), field.height() + _GAP))
        if corner.y() + self.height() > container.height():
            corner.setY(corner.y() - self.height() - field.height() - 2 * _GAP)
        corner.setX(min(max(corner.x(), _GAP), container.width() - self.width() - _GAP))
        return corner


def _container(field: QtWidgets.QWidget) -> QtWidgets.QWidget:
    """Content widget of the scroll area around a field, or its window."""
    container = field
    while (above := container.parentWidget()) is not None and not container.isWindow():
        if isinstance(above.parentWidget(), QtWidgets.QAbstractScrollArea):
            break
        container = above
    return container
