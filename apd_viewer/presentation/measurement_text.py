"""Measurements as text: values with units, at rest and now."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from apd_viewer.files.tables import escaped_cell
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_grouped, format_signed, format_significant
from apd_viewer.presentation.readings import NO_VALUE, PENDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from apd_viewer.session.measurement_readings import MeasurementReading
    from apd_viewer.session.quantities.units import Unit

_DIGITS = 5
_NAMES = {
    MeasurementKind.SECTION: (tr("Length"), tr("Enclosed area"), tr("Volume below")),
    MeasurementKind.FILL_LEVEL: (tr("Fill level"), tr("Freeboard"), tr("Spilled volume")),
}


def value_names(reading: MeasurementReading) -> tuple[str, ...]:
    """Names of the values of a measurement."""
    kind = reading.measurement.kind
    return _NAMES.get(kind, (kind.title,))


def value_text(number: float | None, power: int, unit: Unit) -> str:
    """Text of a length, an area or a volume, by its power, or of an angle (power 0)."""
    if number is None:
        return PENDING
    if math.isnan(number):
        return NO_VALUE
    if power == 0:
        return f"{format_grouped(math.degrees(number), 2)}°"
    if power == 1:
        return unit.format_length(format_significant(number, _DIGITS))
    larger, factor = unit.legible_unit(number, power)
    written = format_significant(factor * number, _DIGITS)
    return larger.format_area(written) if power == 2 else larger.format_volume(written)


def change_text(rest: float | None, now: float | None) -> str:
    """Change from rest in percent; empty if unknown."""
    if rest is None or now is None or math.isnan(now) or not rest > 0.0:
        return ""
    return tr("{change} %").format(change=format_signed(100.0 * (now / rest - 1.0), 2))


def change_texts(reading: MeasurementReading) -> tuple[str, ...]:
    """Change of each value in percent; empty for the rest shape."""
    if reading.now is reading.rest:
        return ("",) * len(reading.now.values)
    return tuple(change_text(*pair) for pair in zip(reading.rest.values, reading.now.values, strict=True))


def current_texts(reading: MeasurementReading, unit: Unit) -> tuple[str, ...]:
    """Texts of the values of the displayed shape."""
    powers = reading.measurement.kind.powers
    return tuple(value_text(x, power, unit) for x, power in zip(reading.now.values, powers, strict=True))


def rest_texts(reading: MeasurementReading, unit: Unit) -> tuple[str, ...]:
    """Texts of the values of the rest shape."""
    powers = reading.measurement.kind.powers
    return tuple(value_text(x, power, unit) for x, power in zip(reading.rest.values, powers, strict=True))


def short_text(reading: MeasurementReading, unit: Unit) -> str:
    """First value with its change, for a row of a list."""
    return "  ".join(filter(None, (current_texts(reading, unit)[0], change_texts(reading)[0])))


def detail_text(reading: MeasurementReading, unit: Unit) -> str:
    """Current and rest values, and the reason for missing ones, one per line."""
    lines = [_detail(*line) for line in zip(value_names(reading), *_values(reading, unit), strict=True)]
    return "\n".join([*lines, *filter(None, [missing_reason(reading)])])


def _values(reading: MeasurementReading, unit: Unit) -> tuple[tuple[str, ...], ...]:
    return current_texts(reading, unit), rest_texts(reading, unit), change_texts(reading)


def _detail(name: str, current: str, at_rest: str, change: str) -> str:
    if not change:
        return tr("{name}: {now}").format(name=name, now=current)
    return tr("{name}: {now}, {change} from {rest}").format(
        name=name, now=current, change=change, rest=at_rest
    )


def missing_reason(reading: MeasurementReading) -> str:
    """Sentence saying why a value is missing; empty if it is not."""
    kind, values = reading.measurement.kind, reading.now.values
    if None in values or None in reading.rest.values:
        return tr("Measured when the shape stops moving.")
    missing = [math.isnan(x) for x in values if x is not None]
    if kind is MeasurementKind.SECTION and all(missing):
        return tr("The plane misses the shape.")
    if kind is MeasurementKind.SECTION and missing[1]:
        return tr("The contour is open, or faces along it are flipped: it encloses no area.")
    if kind is MeasurementKind.SECTION and missing[2]:
        return tr("Below the plane the surface is open, or faces are flipped: it encloses no volume there.")
    if kind is MeasurementKind.FILL_LEVEL and any(missing):
        return tr("It holds nothing this way up: an opening is at the lowest point, or the mesh has defects.")
    if kind is MeasurementKind.GEODESIC and any(missing):
        return tr("No path over the surface joins the points.")
    return ""


def value_rows(readings: Sequence[MeasurementReading], unit: Unit) -> list[tuple[str, str, str, str]]:
    """Rows of name, current value, rest value and change, one per value."""
    return [
        (_title(reading, name), here, there, by)
        for reading in readings
        for name, here, there, by in zip(value_names(reading), *_values(reading, unit), strict=True)
    ]


def measurement_report_rows(
    readings: Sequence[MeasurementReading], unit: Unit
) -> tuple[tuple[str, str, str], ...]:
    """Rows of name, current value and change from rest, for a static report page."""
    changed = tr("{change} from {rest}")
    return tuple(
        (name, here, changed.format(change=by, rest=there) if by else "")
        for name, here, there, by in value_rows(readings, unit)
    )


def value_table(readings: Sequence[MeasurementReading], unit: Unit) -> str:
    """Tab-separated table of all values, for a spreadsheet."""
    head = tr("Measurement"), tr("Now"), tr("At rest"), tr("Change")
    return "\n".join("\t".join(map(escaped_cell, row)) for row in (head, *value_rows(readings, unit))) + "\n"


def _title(reading: MeasurementReading, name: str) -> str:
    single = len(reading.now.values) == 1
    own = reading.measurement.name
    return own if single else tr("{measurement}, {value}").format(measurement=own, value=name.lower())
