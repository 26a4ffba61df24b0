"""Measurements in words: values with their units, at rest and now."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from apd_viewer.files.tables import text_cell
from apd_viewer.geometry.measuring.kinds import Kind
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import grouped, signed, significant
from apd_viewer.presentation.readings import LATER, NOTHING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from apd_viewer.session.measurement_readings import MeasurementReading
    from apd_viewer.session.quantities.units import Unit

_DIGITS = 5
_NAMES = {Kind.SECTION: (tr("Length"), tr("Enclosed area"))}


def names(reading: MeasurementReading) -> tuple[str, ...]:
    """Name of each value of a measurement."""
    kind = reading.measurement.kind
    return _NAMES.get(kind, (kind.title,))


def value(number: float | None, power: int, unit: Unit) -> str:
    """A length, an area (power 2) or an angle (power 0) with its unit."""
    if number is None:
        return LATER
    if math.isnan(number):
        return NOTHING
    if power == 0:
        return f"{grouped(math.degrees(number), 2)}°"
    if power == 1:
        return unit.length(significant(number, _DIGITS))
    larger, factor = unit.legible(number, power)
    return larger.area(significant(factor * number, _DIGITS))


def change(rest: float | None, now: float | None) -> str:
    """Change from rest in percent; empty if there is none to tell."""
    if rest is None or now is None or math.isnan(now) or not rest > 0.0:
        return ""
    return tr("{change} %").format(change=signed(100.0 * (now / rest - 1.0), 2))


def changed(reading: MeasurementReading) -> tuple[str, ...]:
    """Change of each value in percent; empty where it is as at rest."""
    if reading.now is reading.rest:
        return ("",) * len(reading.now.values)
    return tuple(change(*pair) for pair in zip(reading.rest.values, reading.now.values, strict=True))


def now(reading: MeasurementReading, unit: Unit) -> tuple[str, ...]:
    """Each value of the shape on screen."""
    powers = reading.measurement.kind.powers
    return tuple(value(x, power, unit) for x, power in zip(reading.now.values, powers, strict=True))


def rest(reading: MeasurementReading, unit: Unit) -> tuple[str, ...]:
    """Each value at rest."""
    powers = reading.measurement.kind.powers
    return tuple(value(x, power, unit) for x, power in zip(reading.rest.values, powers, strict=True))


def short(reading: MeasurementReading, unit: Unit) -> str:
    """The first value, and its change, for a line of a list."""
    return "  ".join(filter(None, (now(reading, unit)[0], changed(reading)[0])))


def details(reading: MeasurementReading, unit: Unit) -> str:
    """All values with those at rest, and why there is none, a line each."""
    lines = [_detail(*line) for line in zip(names(reading), *_values(reading, unit), strict=True)]
    return "\n".join([*lines, *filter(None, [reason(reading)])])


def _values(reading: MeasurementReading, unit: Unit) -> tuple[tuple[str, ...], ...]:
    return now(reading, unit), rest(reading, unit), changed(reading)


def _detail(name: str, here: str, there: str, by: str) -> str:
    if not by:
        return tr("{name}: {now}").format(name=name, now=here)
    return tr("{name}: {now}, {change} from {rest}").format(name=name, now=here, change=by, rest=there)


def reason(reading: MeasurementReading) -> str:
    """Sentence about a value that is missing; empty if none is."""
    kind, values = reading.measurement.kind, reading.now.values
    if None in values or None in reading.rest.values:
        return tr("Measured when the shape stops moving.")
    missing = [math.isnan(x) for x in values if x is not None]
    if kind is Kind.SECTION and all(missing):
        return tr("The plane misses the shape.")
    if kind is Kind.SECTION and any(missing):
        return tr("The contour is open, or faces along it are flipped: it encloses no area.")
    if kind is Kind.GEODESIC and any(missing):
        return tr("No path over the surface joins the points.")
    return ""


def rows(readings: Sequence[MeasurementReading], unit: Unit) -> list[tuple[str, str, str, str]]:
    """Name, value now, value at rest and change: a row for each value."""
    return [
        (_title(reading, name), here, there, by)
        for reading in readings
        for name, here, there, by in zip(names(reading), *_values(reading, unit), strict=True)
    ]


def report_rows(readings: Sequence[MeasurementReading], unit: Unit) -> tuple[tuple[str, str, str], ...]:
    """Name, value now and change from rest, for a page that is final."""
    return tuple((name, here, _from_rest(there, by)) for name, here, there, by in rows(readings, unit))


def _from_rest(there: str, by: str) -> str:
    return tr("{change} from {rest}").format(change=by, rest=there) if by else ""


def table(readings: Sequence[MeasurementReading], unit: Unit) -> str:
    """All values as lines of text with tabs, for a spreadsheet."""
    head = tr("Measurement"), tr("Now"), tr("At rest"), tr("Change")
    return "\n".join("\t".join(map(text_cell, row)) for row in (head, *rows(readings, unit))) + "\n"


def _title(reading: MeasurementReading, name: str) -> str:
    single = len(reading.now.values) == 1
    own = reading.measurement.name
    return own if single else tr("{measurement}, {value}").format(measurement=own, value=name.lower())
