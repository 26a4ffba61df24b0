"""Fields for the quantities of a study and the ends of their ranges."""

import math
from functools import partial
from typing import NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from apd_viewer.cases.design import DesignVariable, parse_variable
from apd_viewer.cases.plan_columns import SETTING_COLUMNS
from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.motion import MOTION_KINDS
from apd_viewer.session.quantities import expressions
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.fields import CheckBox, TextField

DEGREES, PERCENT, NO_UNIT = "deg", "%", ""
SHARE_COLUMN = "to"
_DIGITS = 10  # significant digits of a number in a plan
_WIDTH = 104  # px: width of a field for the start or end of a range
TITLE_COLUMN_WIDTH = 140  # px, of the column of titles with its gap


class VariedQuantity(NamedTuple):
    """Quantity available for variation in a study.

    Attributes
    ----------
    name : str
        Its column in a plan, or its word in a motion.
    title, note, tip : str
        The note stands beside it.
    unit : str
        DEGREES, PERCENT or NO_UNIT.
    low, high : str
        Ends of its range at first.
    is_motion : bool
        Whether it moves the handle, typed instead of the motion of the session.
    is_logarithmic : bool
        Whether its range is divided into equal factors.
    """

    name: str
    title: str
    note: str
    tip: str
    unit: str
    low: str
    high: str
    is_motion: bool = False
    is_logarithmic: bool = False


class QuantityRange(NamedTuple):
    """Range of a quantity as entered; a single value without an upper end.

    Attributes
    ----------
    low : str
        Its number and unit, as a plan has it.
    """

    quantity: VariedQuantity
    low: str
    high: str | None

    @property
    def design_variable(self) -> DesignVariable:
        """Design variable of the range; raises InputError if its ends are reversed."""
        by = ":log" if self.quantity.is_logarithmic else ""
        unit = PERCENT if self.low.endswith(PERCENT) else self.quantity.unit.replace(PERCENT, "")
        low = self.low.removesuffix(unit)
        return parse_variable(f"{self.quantity.name}={low}..{self.high}{by}")

    def end(self, upper: bool) -> str:
        """Lower or upper end of the range."""
        return self.high if upper and self.high is not None else self.low


def varied_quantities(state: State) -> list[VariedQuantity]:
    """Quantities of a document that a study can vary, in row order."""
    document = state.document
    found = []
    if document.relative_to_rest.is_posed:
        found.append(_current_motion())
    if document.paint_problem is None:
        found += _typed_motions()
    stiffness = max(document.settings.stiffness, 0.001)
    found.append(
        VariedQuantity(
            "stiffness",
            tr("Stiffness"),
            tr("from 0.0001 (cloth) to 0.1 (sheet metal)"),
            tr("Bending stiffness, varied on a logarithmic scale"),
            NO_UNIT,
            format_editable(stiffness / 10.0, 3),
            format_editable(stiffness * 10.0, 3),
            is_logarithmic=True,
        )
    )
    note = tr("percent of rest")
    area = tr("Target of the total area, percent of rest")
    found.append(VariedQuantity("area", tr("Target area"), note, area, PERCENT, "95%", "105%"))
    if not state.inspection.missing_volume_phrase:
        volume = tr("Target of the volume, percent of rest")
        found.append(VariedQuantity("volume", tr("Target volume"), note, volume, PERCENT, "60%", "100%"))
    return found


def _current_motion() -> VariedQuantity:
    tip = tr("How far the handles go along their current motion; more than 100 % is farther")
    return VariedQuantity(
        SHARE_COLUMN,
        tr("Current motion"),
        tr("fraction of the current motion of the handles"),
        tip,
        PERCENT,
        "10%",
        "100%",
    )


def _typed_motions() -> list[VariedQuantity]:
    offered = [(kind, kind.study) for kind in MOTION_KINDS.values() if kind.study]
    return [
        VariedQuantity(kind.word, kind.title, note, kind.tip, low.lstrip("0"), low, high, True)
        for kind, (note, low, high) in offered
    ]


def quantity_range(quantity: VariedQuantity, low: str, high: str, state: State, unit: Unit) -> QuantityRange:
    """Range from its typed ends.

    Raises
    ------
    InputError
        If an end is none, or they are of two kinds; a sentence names the quantity.
    """
    try:
        first = _plan_text(quantity, expressions.unambiguous_text(low), state, unit)
        last = _plan_text(quantity, expressions.unambiguous_text(high), state, unit) if high.strip() else None
        if last is not None and first.endswith(PERCENT) != last.endswith(PERCENT):
            raise InputError(tr("Give both ends in percent, or both as lengths."))
        if not quantity.is_motion:  # reject values that every row of the plan would reject
            for end in filter(None, (first, last)):
                SETTING_COLUMNS[quantity.name].parse(end)
        last = None if last == first else last
        span = QuantityRange(quantity, first, last)
        if last is not None:
            _ = span.design_variable
    except InputError as error:
        raise InputError(f"{quantity.title}: {error}") from error
    return span


def _plan_text(quantity: VariedQuantity, text: str, state: State, unit: Unit) -> str:
    """Number with unit in the notation of a plan; raises InputError."""
    if quantity.unit == DEGREES:
        return _rounded_text(math.degrees(expressions.parse_angle(text, {}))) + DEGREES
    if quantity.unit == NO_UNIT:
        return _rounded_text(expressions.parse_number(text, {}))
    fraction = text.strip()
    if not (fraction.endswith(PERCENT) or quantity.is_motion):
        SETTING_COLUMNS[quantity.name].parse(
            fraction
        )  # raises InputError on a bare number that may be a factor
    if fraction.endswith(PERCENT) or not quantity.is_motion:
        return _rounded_text(expressions.parse_number(fraction.removesuffix(PERCENT), {})) + PERCENT
    return _rounded_text(expressions.parse_length(text, unit, state.document.mesh.named_lengths))


def _rounded_text(value: float) -> str:
    return f"{float(f'{value:.{_DIGITS}g}'):.{_DIGITS}g}"


class VariedRow:
    """Row of a quantity: check box to vary it, and fields for its range."""

    def __init__(self, quantity: VariedQuantity) -> None:
        self.quantity = quantity
        self.check = CheckBox(quantity.title, toolTip=quantity.tip)
        self.low = _end_field(tr("{name} from").format(name=quantity.title), quantity.low, quantity.tip)
        self.high = _end_field(tr("{name} to").format(name=quantity.title), quantity.high, quantity.tip)
        self.high.setPlaceholderText(tr("fixed"))
        self.note = QLabel(quantity.note, objectName="quiet", wordWrap=True)

    @property
    def is_checked(self) -> bool:
        """True if the check box is checked."""
        return self.check.isChecked()

    @property
    def has_two_ends(self) -> bool:
        """True if the typed ends differ and the upper one is not empty."""
        return self.high.text().strip() not in ("", self.low.text().strip())

    def set_enabled(self, on: bool) -> None:
        """Enable or disable the fields of the range."""
        for field in (self.low, self.high):
            field.setEnabled(on)


class VariedFields(QWidget):
    """Rows for all quantities available on a document.

    Parameters
    ----------
    unit : Unit
        Unit of typed lengths.

    Attributes
    ----------
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
                field.show_unit(_symbol(row.quantity, unit))
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
        """Check or uncheck a quantity; a typed motion excludes the current motion."""
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
        """Ranges of the checked quantities; raises InputError."""
        return tuple(
            quantity_range(row.quantity, row.low.text(), row.high.text(), self._state, self._unit)
            for row in self.rows.values()
            if row.is_checked
        )

    def values_at_end(self, name: str, upper: bool) -> dict[str, str]:
        """Values of the checked quantities, with ``name`` at one end of its range.

        All motions are at the same end, to show the corners of the ranges; an end of a setting is shown at
        the largest motions.

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


def _symbol(quantity: VariedQuantity, unit: Unit) -> str:
    """Unit of a bare number typed for a quantity."""
    if quantity.unit == PERCENT and quantity.is_motion:
        return unit.format_length("").strip()
    return "°" if quantity.unit == DEGREES else quantity.unit


def _end_field(name: str, text: str, tip: str) -> TextField:
    field = TextField(toolTip=tip, alignment=Qt.AlignmentFlag.AlignRight, accessibleName=name)
    field.setText(text)
    field.setFixedWidth(_WIDTH)
    return field
