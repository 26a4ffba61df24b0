"""Rows of quantities with the ends of their ranges."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.studies.varied_quantity import (
    SHARE_COLUMN,
    QuantityRange,
    VariedQuantity,
    quantity_range,
    varied_quantities,
)
from apd_viewer.ui.widgets.fields import CheckBox, TextField

_WIDTH = 104  # px, of an end
TITLE_COLUMN_WIDTH = 140  # px, of the column of titles with its gap


class VariedRow:
    """Row of a quantity: check box to vary it, and the ends of its range."""

    def __init__(self, quantity: VariedQuantity) -> None:
        self.quantity = quantity
        self.check = CheckBox(quantity.title, toolTip=quantity.tip)
        self.low = _end(tr("{name} from").format(name=quantity.title), quantity.low, quantity.tip)
        self.high = _end(tr("{name} to").format(name=quantity.title), quantity.high, quantity.tip)
        self.high.setPlaceholderText(tr("fixed"))
        self.note = QLabel(quantity.note, objectName="quiet", wordWrap=True)

    @property
    def is_checked(self) -> bool:
        """True if it is ticked."""
        return self.check.isChecked()

    @property
    def has_two_ends(self) -> bool:
        """True if its ends differ; with one of them it has a single value."""
        return self.high.text().strip() not in ("", self.low.text().strip())

    def set_enabled(self, on: bool) -> None:
        """Let its ends be typed, or not."""
        for field in (self.low, self.high):
            field.setEnabled(on)


class VariedFields(QWidget):
    """All quantities of a document.

    Parameters
    ----------
    state : State
    unit : Unit
        In which lengths are typed.

    Attributes
    ----------
    rows : dict of str to VariedRow
    changed : Signal()
        Another quantity, or another end.
    end_focused : Signal(str, bool)
        The end of which quantity has the keys; True for the upper one.
    focus_lost : Signal()
        No end has the keys any more.
    """

    changed = Signal()
    end_focused = Signal(str, bool)
    focus_lost = Signal()

    def __init__(self, state: State, unit: Unit) -> None:
        super().__init__()
        self._state, self._unit = state, unit
        self.rows = {quantity.name: VariedRow(quantity) for quantity in varied_quantities(state)}
        self._lay_out()
        for name, row in self.rows.items():
            row.check.toggled.connect(partial(self._choose, name))
            for field, upper in ((row.low, False), (row.high, True)):
                field.textChanged.connect(self._edit)
                field.focus_gained.connect(partial(self.end_focused.emit, name, upper))
                field.focus_lost.connect(self.focus_lost)
            row.set_enabled(False)
        first = SHARE_COLUMN if SHARE_COLUMN in self.rows else "twist"
        if first in self.rows:
            self.rows[first].check.setChecked(True)

    def _lay_out(self) -> None:
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=6)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(4, 1)
        for number, row in enumerate(self.rows.values()):
            grid.addWidget(row.check, number, 0)
            grid.addWidget(row.low, number, 1)
            grid.addWidget(QLabel("–", objectName="quiet"), number, 2)
            grid.addWidget(row.high, number, 3)
            grid.addWidget(row.note, number, 4)
        grid.setColumnMinimumWidth(0, TITLE_COLUMN_WIDTH - 8)

    def _choose(self, name: str, on: bool) -> None:
        """Tick a quantity; a typed motion stands in place of the current one."""
        self.rows[name].set_enabled(on)
        if on:
            typed = self.rows[name].quantity.is_motion
            for row in self.rows.values():
                if (typed and row.quantity.name == SHARE_COLUMN) or (
                    name == SHARE_COLUMN and row.quantity.is_motion
                ):
                    row.check.setChecked(False)
        self.changed.emit()

    def _edit(self) -> None:
        self.changed.emit()
        for name, row in self.rows.items():
            for field, upper in ((row.low, False), (row.high, True)):
                if field.hasFocus():
                    self.end_focused.emit(name, upper)

    def ranges(self) -> tuple[QuantityRange, ...]:
        """Ranges of the ticked quantities; raises InputError."""
        return tuple(
            quantity_range(row.quantity, row.low.text(), row.high.text(), self._state, self._unit)
            for row in self.rows.values()
            if row.is_checked
        )

    def values_at_end(self, name: str, upper: bool) -> dict[str, str]:
        """Values of all ticked quantities at an end of one of them.

        Motions go along to the same end, so that the corners of the ranges are seen; an end of a setting
        is seen where the motions are largest.

        Raises
        ------
        InputError
            If that end is none.
        """
        looked, found = self.rows[name].quantity, {}
        for row in self.rows.values():
            other = row.quantity
            if not row.is_checked or not (other is looked or other.is_motion or other.name == SHARE_COLUMN):
                continue
            moves = looked.is_motion or looked.name == SHARE_COLUMN
            span = self._span_or_none(row)
            if span is not None:
                found[other.name] = span.end(upper if moves or other is looked else True)
        return found

    def _span_or_none(self, row: VariedRow) -> QuantityRange | None:
        try:
            return quantity_range(row.quantity, row.low.text(), row.high.text(), self._state, self._unit)
        except InputError:
            if row.low.hasFocus() or row.high.hasFocus():
                raise
            return None


def _end(name: str, text: str, tip: str) -> TextField:
    field = TextField(toolTip=tip, alignment=Qt.AlignmentFlag.AlignRight)
    field.setAccessibleName(name)
    field.setText(text)
    field.setFixedWidth(_WIDTH)
    return field
