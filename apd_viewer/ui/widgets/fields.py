"""Controls for one value: a choice, a check box, a number."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import (
    QFocusEvent,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QValidator,
    QWheelEvent,
)
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QToolButton,
    QWidget,
)


class Choice(QComboBox):
    """Combo box ignoring the wheel, for a scrolled panel."""

    def sizeHint(self) -> QSize:
        """As high as a field."""
        return QSize(super().sizeHint().width(), max(28, self.fontMetrics().height() + 12))

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Leave the wheel to the panel."""
        event.ignore()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the choice and a chevron."""
        room, ink = QRectF(self.rect()), self.palette().windowText().color()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        _draw_field(painter, self)
        painter.setPen(ink)
        painter.drawText(room.adjusted(8, 0, -28, 0), Qt.AlignmentFlag.AlignVCenter, self.currentText())
        painter.setPen(QPen(ink, 1.5, c=Qt.PenCapStyle.RoundCap, j=Qt.PenJoinStyle.RoundJoin))
        tip = room.center() + QPointF(room.width() / 2 - 14, 2)
        painter.drawPolyline([tip - QPointF(4, 4), tip, tip + QPointF(4, -4)])


class Check(QCheckBox):
    """Check box visible on a dark panel too."""

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the box, its tick and the words."""
        palette, on = self.palette(), self.isChecked()
        accent, line = palette.highlight().color(), palette.placeholderText().color()
        box = QRectF(0.75, self.height() / 2 - 7.25, 14.5, 14.5)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(accent if on or self.hasFocus() else line, 1.5))
        painter.setBrush(accent if on else palette.base())
        painter.drawRoundedRect(box, 4, 4)
        if on:
            painter.setPen(QPen(palette.highlightedText().color(), 1.75, c=Qt.PenCapStyle.RoundCap))
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
        """Box and words."""
        width = 24 + self.fontMetrics().horizontalAdvance(self.text()) + 2
        return QSize(width, max(22, self.fontMetrics().height() + 4))

    def minimumSizeHint(self) -> QSize:
        """The same."""
        return self.sizeHint()


class Number(QDoubleSpinBox):
    """Number field ignoring the wheel; Enter and Esc return the focus.

    Parameters
    ----------
    brief : bool
        Whether zeros at the end are left out.
    properties
        Of the spin box.
    """

    def __init__(self, brief: bool = False, **properties: Any) -> None:
        self._brief = brief
        super().__init__(keyboardTracking=False, alignment=Qt.AlignmentFlag.AlignRight, **properties)
        self.setButtonSymbols(QDoubleSpinBox.ButtonSymbols.NoButtons)
        self.setFixedSize(84, max(28, self.fontMetrics().height() + 12))
        self.lineEdit().setTextMargins(4, 0, 4, 0)
        self.lineEdit().returnPressed.connect(self.clearFocus)

    def show_value(self, value: float) -> None:
        """Show a value without emitting a choice."""
        if value != self.value():
            self.blockSignals(True)
            self.setValue(value)
            self.blockSignals(False)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the field; its letters are those of the line edit within."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        _draw_field(painter, self)

    def textFromValue(self, value: float) -> str:
        """Number with all digits, ungrouped, as Enter reads it."""
        return f"{value:.10g}" if self._brief else super().textFromValue(value)

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Accept any text while typing; Enter restores invalid ones."""
        fits = self._typed(text) is not None
        return (QValidator.State.Acceptable if fits else QValidator.State.Intermediate), text, position

    def fixup(self, _: str) -> str:
        """Previous number."""
        return f"{self.prefix()}{self.textFromValue(self.value())}{self.suffix()}"

    def valueFromText(self, text: str) -> float:
        """Number typed, such as 1e-3 or 0,5."""
        typed = self._typed(text)
        return self.value() if typed is None else typed

    def _typed(self, text: str) -> float | None:
        try:
            # The suffix remains after the typed text, which may repeat it.
            number = text.removesuffix(self.suffix()).strip().removesuffix(self.suffix().strip())
            value = float(number.strip(" %").replace(",", "."))
        except ValueError:
            return None
        return value if self.minimum() <= value <= self.maximum() else None

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Select the number for overwriting."""
        super().focusInEvent(event)
        if event.reason() in (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason):
            self.selectAll()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Restore the number on Esc."""
        if event.key() == Qt.Key.Key_Escape:
            self.lineEdit().setText(f"{self.prefix()}{self.textFromValue(self.value())}{self.suffix()}")
            self.clearFocus()
        else:
            super().keyPressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Leave the wheel to the panel unless the field is in use."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


def percent_field(name: str, tip: str) -> Number:
    """Field for a target in percent of the rest value."""
    return Number(
        accessibleName=name, toolTip=tip, minimum=1.0, maximum=1000.0, value=100.0, decimals=2, suffix=" %"
    )


def small_button(name: str, tip: str) -> QToolButton:
    """Quiet icon button."""
    return QToolButton(objectName="small", accessibleName=name, toolTip=tip, iconSize=QSize(16, 16))


def _draw_field(painter: QPainter, field: QWidget) -> None:
    """Draw the field's background; the platform's is lost on a dark panel."""
    palette = field.palette()
    painter.setPen(palette.highlight().color() if field.hasFocus() else palette.mid().color())
    painter.setBrush(palette.base())
    painter.drawRoundedRect(QRectF(field.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6)
