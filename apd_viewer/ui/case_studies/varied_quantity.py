"""Quantities that a study can vary, and the ends of their ranges as typed."""

from __future__ import annotations

import math
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.motion import MOTION_KINDS
from apd_viewer.session.quantities.expressions import (
    parse_angle,
    parse_length,
    parse_number,
    unambiguous_text,
)
from apd_viewer.session.quantities.units import Unit
from apd_viewer.studies.plans.design import DesignVariable, parse_variable
from apd_viewer.studies.plans.plan_columns import SETTING_COLUMNS

DEGREES, PERCENT, NO_UNIT = "deg", "%", ""
SHARE_COLUMN = "to"
_DIGITS = 10  # of a number in a plan


class VariedQuantity(NamedTuple):
    """Quantity to be varied by a study.

    Attributes
    ----------
    name : str
        Its column in a plan, or its word in a motion.
    title, note, tip : str
        The note stands beside it.
    unit : str
        DEGREES, PERCENT or PLAIN.
    low, high : str
        Ends of its range at first.
    is_motion : bool
        Whether it moves the handle, typed instead of the motion of the session.
    by_factors : bool
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
    by_factors: bool = False


class QuantityRange(NamedTuple):
    """Typed range of a quantity; without an end it has one value.

    Attributes
    ----------
    quantity : VariedQuantity
    low : str
        Its number and unit, as a plan has it.
    high : str or None
    """

    quantity: VariedQuantity
    low: str
    high: str | None

    @property
    def varied(self) -> DesignVariable:
        """The range for a design; raises InputError if its ends are exchanged."""
        by = ":log" if self.quantity.by_factors else ""
        unit = PERCENT if self.low.endswith(PERCENT) else self.quantity.unit.replace(PERCENT, "")
        low = self.low.removesuffix(unit)
        return parse_variable(f"{self.quantity.name}={low}..{self.high}{by}")

    def end(self, upper: bool) -> str:
        """One end of the range."""
        return self.high if upper and self.high is not None else self.low


def varied_quantities(state: State) -> list[VariedQuantity]:
    """Quantities that can be varied on a document, in the order of their rows."""
    document = state.document
    found = []
    if document.relative_to_rest.is_posed:
        found.append(_as_it_stands())
    if document.paint_problem is None:
        found += _typed_motions()
    stiffness = max(document.settings.stiffness, 0.001)
    found.append(
        VariedQuantity(
            "stiffness",
            tr("Stiffness"),
            tr("from 0.0001 (cloth) to 0.1 (sheet metal)"),
            tr("Bending stiffness; its range is divided into equal factors"),
            NO_UNIT,
            format_editable(stiffness / 10.0, 3),
            format_editable(stiffness * 10.0, 3),
            by_factors=True,
        )
    )
    note = tr("percent of rest")
    area = tr("Target of the total area, percent of rest")
    found.append(VariedQuantity("area", tr("Target area"), note, area, PERCENT, "95%", "105%"))
    if not state.inspection.missing_volume_phrase:
        volume = tr("Target of the volume, percent of rest")
        found.append(VariedQuantity("volume", tr("Target volume"), note, volume, PERCENT, "60%", "100%"))
    return found


def _as_it_stands() -> VariedQuantity:
    tip = tr("How far the handles go of the way that they have gone; more than 100 % is farther")
    return VariedQuantity(
        SHARE_COLUMN,
        tr("Current motion"),
        tr("share of the way that the handles have gone"),
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
        first = _end(quantity, unambiguous_text(low), state, unit)
        last = _end(quantity, unambiguous_text(high), state, unit) if high.strip() else None
        if last is not None and first.endswith(PERCENT) != last.endswith(PERCENT):
            raise InputError(tr("Give both ends in percent, or both as lengths."))
        if not quantity.is_motion:  # refuse here what every row of the plan would refuse
            for end in filter(None, (first, last)):
                SETTING_COLUMNS[quantity.name].parse(end)
        last = None if last == first else last
        span = QuantityRange(quantity, first, last)
        if last is not None:
            _ = span.varied
    except InputError as error:
        raise InputError(f"{quantity.title}: {error}") from error
    return span


def _end(quantity: VariedQuantity, text: str, state: State, unit: Unit) -> str:
    """Number with its unit, as a plan has it; raises InputError."""
    if quantity.unit == DEGREES:
        return _written(math.degrees(parse_angle(text, {}))) + DEGREES
    if quantity.unit == NO_UNIT:
        return _written(parse_number(text, {}))
    share = text.strip()
    if not (share.endswith(PERCENT) or quantity.is_motion):
        SETTING_COLUMNS[quantity.name].parse(share)  # asks about what could be a factor
    if share.endswith(PERCENT) or not quantity.is_motion:
        return _written(parse_number(share.removesuffix(PERCENT), {})) + PERCENT
    return _written(parse_length(text, unit, state.named_lengths))


def _written(value: float) -> str:
    return f"{float(f'{value:.{_DIGITS}g}'):.{_DIGITS}g}"
