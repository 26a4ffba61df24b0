"""Volumes by name in words: at rest, now, and what others published."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, PACKING
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import (
    format_exact,
    format_grouped,
    format_short,
    format_significant,
)
from apd_viewer.presentation.published_volumes import PUBLISHED_FIGURES, PublishedFigure, VolumeName
from apd_viewer.presentation.readings import NO_VALUE, change_percent
from apd_viewer.session.model.status_text import caps_phrase
from apd_viewer.session.quantities.bulk_density import bulk_density, object_count
from apd_viewer.session.quantities.units import Unit

DEFAULT_BAG = 45.0  # litres, as in the published counts
_DIGITS = 4
_PACKINGS = PACKING, DENSEST, LOOSEST
RestAndCurrent: TypeAlias = tuple[float | None, float | None]
TextWithRange: TypeAlias = tuple[str, str]


class VolumeRow(NamedTuple):
    """A quantity with its definition, its readings and published figures of it.

    A reading comes with its range, or an empty text.
    """

    quantity: VolumeName
    title: str
    definition: str
    rest: TextWithRange
    now: TextWithRange
    change: str
    published: tuple[PublishedFigure, ...]


def volume_rows(
    rest: VolumeReadings, now: VolumeReadings, unit: Unit, density: float | None, bag: float = DEFAULT_BAG
) -> Iterator[VolumeRow]:
    """Rows of all quantities.

    Parameters
    ----------
    rest, now : VolumeReadings
    unit : Unit
    density : float or None
        That of the material, g/cm³.
    bag : float
        Litres.
    """
    yield from _of_one(rest, now, unit)
    yield from _of_many(rest, now, unit, density, bag)
    values = rest.material, now.material
    lacks = now.material is None
    about = (
        tr("needs the thickness of the wall")
        if lacks
        else tr("area × thickness; nothing can be crushed to less")
    )
    if now.capacity is not None:
        about = tr("between two walls; holds {capacity}").format(capacity=_volume(now.capacity, unit))
    yield _volumes(VolumeName.MATERIAL, tr("Material volume"), about, values, unit)


def _of_one(rest: VolumeReadings, now: VolumeReadings, unit: Unit) -> Iterator[VolumeRow]:
    hulls = rest.hull, now.hull
    caps = caps_phrase(rest.openings) if rest.openings else ""
    values: RestAndCurrent = rest.enclosed, now.enclosed
    yield _volumes(VolumeName.ENCLOSED, tr("Enclosed volume"), caps, values, unit)
    values = rest.hull.volume, now.hull.volume
    yield _volumes(VolumeName.HULL, tr("Convex hull volume"), "", values, unit)
    yield _volumes(VolumeName.BOX, tr("Smallest box volume"), "", (rest.hull.box, now.hull.box), unit)
    sides = [unit.format_length(" × ".join(format_short(side) for side in hull.sides)) for hull in hulls]
    yield _row(VolumeName.SIDES, tr("Sides of the smallest box"), "", sides)
    widths = [unit.format_length(format_significant(hull.width, _DIGITS)) for hull in hulls]
    about = tr("between two parallel planes, in any direction")
    yield _row(VolumeName.WIDTH, tr("Least width"), about, widths, (rest.hull.width, now.hull.width))


def _of_many(
    rest: VolumeReadings, now: VolumeReadings, unit: Unit, density: float | None, bag: float
) -> Iterator[VolumeRow]:
    pair = rest, now
    bulks = [[found.hull.bulk(packing) for packing in _PACKINGS] for found in pair]
    about = tr("convex hull over {packing}, the range over {densest} to {loosest}").format(
        packing=PACKING, densest=DENSEST, loosest=LOOSEST
    )
    title = tr("Bulk volume")
    yield _row(VolumeName.BULK, title, about, _spreads(bulks, lambda x: _volume(x, unit)), _first(bulks))
    counts = [[object_count(bag, found, unit, packing) for packing in _PACKINGS] for found in pair]
    title = tr("Objects in a bag of {litres} l").format(litres=format_short(bag))
    about = tr("needs the unit of length") if unit.to_litres(1.0) is None else ""
    yield _row(
        VolumeName.COUNT, title, about, _spreads(counts, lambda n: format_grouped(n, 0)), _first(counts)
    )
    densities = [[bulk_density(density, found, packing) for packing in _PACKINGS] for found in pair]
    about = tr("needs thickness and density of the wall") if densities[1][0] is None else ""
    title = tr("Bulk density")
    yield _row(
        VolumeName.DENSITY,
        title,
        about,
        _spreads(densities, lambda x: f"{format_exact(x, 3)}\u00a0kg/m³"),
        _first(densities),
    )


def _volumes(quantity: VolumeName, title: str, about: str, values: RestAndCurrent, unit: Unit) -> VolumeRow:
    return _row(quantity, title, about, [_volume(value, unit) for value in values], values)


def _row(
    quantity: VolumeName,
    title: str,
    about: str,
    texts: Sequence[str] | Sequence[TextWithRange],
    values: RestAndCurrent = (None, None),
) -> VolumeRow:
    before, after = values
    change = "" if before is None or after is None else change_percent(after, before)
    rest, now = ((text, "") if isinstance(text, str) else text for text in texts)
    return VolumeRow(quantity, title, about, rest, now, change, PUBLISHED_FIGURES.get(quantity, ()))


def _volume(value: float | None, unit: Unit) -> str:
    if value is None:
        return NO_VALUE
    larger, factor = unit.legible_unit(value, 3)
    return larger.format_volume(format_significant(factor * value, _DIGITS))


def _first(readings: Sequence[Sequence[float | None]]) -> RestAndCurrent:
    rest, now = readings
    return rest[0], now[0]


def _spreads(
    readings: Sequence[Sequence[float | None]], written: Callable[[float], str]
) -> list[TextWithRange]:
    """Each reading with its range; a dash where it is not known."""
    texts: list[TextWithRange] = []
    for each in readings:
        known = [value for value in each if value is not None]
        if len(known) < len(_PACKINGS):
            texts.append((NO_VALUE, ""))
            continue
        low, high = written(min(known)), written(max(known))
        texts.append((written(known[0]), tr("{low} to {high}").format(low=low, high=high)))
    return texts
