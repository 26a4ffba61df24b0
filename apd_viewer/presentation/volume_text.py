"""Texts of volumes and derived quantities: rest, current and published values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from typing import NamedTuple, TypeAlias

from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, PACKING
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.language import tr
from apd_viewer.presentation import number_format
from apd_viewer.presentation.readings import NO_VALUE, change_percent
from apd_viewer.session.model.status_text import caps_phrase
from apd_viewer.session.quantities.units import Unit

DEFAULT_BAG = 45.0  # litres, bag size of the published counts of objects per bag
_DIGITS = 4
_PACKINGS = PACKING, DENSEST, LOOSEST
RestAndCurrent: TypeAlias = tuple[float | None, float | None]
TextWithRange: TypeAlias = tuple[str, str]


class VolumeRow(NamedTuple):
    """Quantity with its definition, its readings and published values.

    A reading comes with its range, or an empty text.
    """

    quantity: VolumeName
    title: str
    definition: str
    rest: TextWithRange
    now: TextWithRange
    change: str
    published: tuple[PublishedVolume, ...]


def volume_rows(
    rest: VolumeReadings,
    now: VolumeReadings,
    unit: Unit,
    density: float | None,
    bag: float = DEFAULT_BAG,
    up: str = "",
) -> Iterator[VolumeRow]:
    """Table rows of all volumes and derived quantities.

    Parameters
    ----------
    density : float or None
        Density of the material, g/cm³.
    bag : float
        Litres.
    up : str
        Name of the direction upwards of the brimful volumes.
    """
    yield from _single_object_rows(rest, now, unit)
    yield from _vessel_rows(rest, now, unit, up)
    yield from _bulk_rows(rest, now, unit, density, bag)
    values = rest.material, now.material
    lacks = now.material is None
    about = (
        tr("needs the wall thickness") if lacks else tr("rest area × thickness; the lower limit of crushing")
    )
    if now.capacity is not None:
        about = tr("between two walls; holds {capacity}").format(capacity=_volume(now.capacity, unit))
    yield _volumes(VolumeName.MATERIAL, tr("Material volume"), about, values, unit)


def _single_object_rows(rest: VolumeReadings, now: VolumeReadings, unit: Unit) -> Iterator[VolumeRow]:
    hulls = rest.hull, now.hull
    caps = caps_phrase(rest.openings) if rest.openings else ""
    values: RestAndCurrent = rest.enclosed, now.enclosed
    yield _volumes(VolumeName.ENCLOSED, tr("Enclosed volume"), caps, values, unit)
    values = rest.hull.volume, now.hull.volume
    yield _volumes(VolumeName.HULL, tr("Convex hull volume"), "", values, unit)
    yield _volumes(VolumeName.BOX, tr("Smallest box volume"), "", (rest.hull.box, now.hull.box), unit)
    sides = [
        unit.format_length(" × ".join(number_format.format_short(side) for side in hull.sides))
        for hull in hulls
    ]
    yield _row(VolumeName.SIDES, tr("Sides of the smallest box"), "", sides)
    widths = [unit.format_length(number_format.format_significant(hull.width, _DIGITS)) for hull in hulls]
    about = tr("between two parallel planes, in any direction")
    yield _row(VolumeName.WIDTH, tr("Least width"), about, widths, (rest.hull.width, now.hull.width))


def _vessel_rows(rest: VolumeReadings, now: VolumeReadings, unit: Unit, up: str) -> Iterator[VolumeRow]:
    if now.brimful is None and rest.brimful is None:
        return
    about = tr("with {up} upwards, to the lowest point of the openings; a closed shape to its top")
    about = about.format(up=up)
    yield _volumes(VolumeName.BRIMFUL, tr("Brimful volume"), about, (rest.brimful, now.brimful), unit)
    fillings = rest.filling, now.filling
    if now.filling is None:
        return
    levels, boards, spills = zip(*(each or (None, None, None) for each in fillings), strict=True)
    about = tr("above the lowest point")
    yield _row(VolumeName.LEVEL, tr("Fill level"), about, [_length(x, unit) for x in levels], levels)
    about = tr("from the fill level to the brim")
    yield _row(VolumeName.FREEBOARD, tr("Freeboard"), about, [_length(x, unit) for x in boards])
    yield _volumes(VolumeName.SPILLED, tr("Spilled volume"), "", spills, unit)


def _bulk_rows(
    rest: VolumeReadings, now: VolumeReadings, unit: Unit, density: float | None, bag: float
) -> Iterator[VolumeRow]:
    pair = rest, now
    bulks = [[found.hull.bulk(packing) for packing in _PACKINGS] for found in pair]
    about = tr("convex hull divided by {packing}; range for {densest} to {loosest}").format(
        packing=PACKING, densest=DENSEST, loosest=LOOSEST
    )
    title = tr("Bulk volume")
    yield _row(
        VolumeName.BULK, title, about, _spreads(bulks, lambda x: _volume(x, unit)), _first_readings(bulks)
    )
    counts = [[object_count(bag, found, unit, packing) for packing in _PACKINGS] for found in pair]
    title = tr("Objects in a bag of {litres} l").format(litres=number_format.format_short(bag))
    about = tr("needs the unit of length") if unit.to_litres(1.0) is None else ""
    yield _row(
        VolumeName.COUNT,
        title,
        about,
        _spreads(counts, lambda n: number_format.format_grouped(n, 0)),
        _first_readings(counts),
    )
    densities = [[bulk_density(density, found, packing) for packing in _PACKINGS] for found in pair]
    about = tr("needs wall thickness and density") if densities[1][0] is None else ""
    title = tr("Bulk density")
    yield _row(
        VolumeName.DENSITY,
        title,
        about,
        _spreads(densities, lambda x: f"{number_format.format_exact(x, 3)}\u00a0kg/m³"),
        _first_readings(densities),
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
    return VolumeRow(quantity, title, about, rest, now, change, PUBLISHED_VOLUMES.get(quantity, ()))


def _length(value: float | None, unit: Unit) -> str:
    if value is None:
        return NO_VALUE
    return unit.format_length(number_format.format_significant(value, _DIGITS))


def _volume(value: float | None, unit: Unit) -> str:
    if value is None:
        return NO_VALUE
    larger, factor = unit.legible_unit(value, 3)
    return larger.format_volume(number_format.format_significant(factor * value, _DIGITS))


def _first_readings(readings: Sequence[Sequence[float | None]]) -> RestAndCurrent:
    rest, now = readings
    return rest[0], now[0]


def _spreads(
    readings: Sequence[Sequence[float | None]], written: Callable[[float], str]
) -> list[TextWithRange]:
    """Text of each reading with its range; a dash if unknown."""
    texts: list[TextWithRange] = []
    for each in readings:
        known = [value for value in each if value is not None]
        if len(known) < len(_PACKINGS):
            texts.append((NO_VALUE, ""))
            continue
        low, high = written(min(known)), written(max(known))
        texts.append((written(known[0]), tr("{low} to {high}").format(low=low, high=high)))
    return texts


class VolumeName(Enum):
    """Volume or derived quantity; its value is its name in reports."""

    ENCLOSED = "enclosed_volume"
    HULL = "hull_volume"
    BOX = "packed_volume"
    SIDES = "packed_sides"
    WIDTH = "minimum_width"
    BRIMFUL = "brimful_volume"
    LEVEL = "fill_level"
    FREEBOARD = "freeboard"
    SPILLED = "spilled_volume"
    BULK = "bulk_volume"
    COUNT = "objects_in_bag"
    DENSITY = "bulk_density"
    MATERIAL = "material_volume"


class PublishedVolume(NamedTuple):
    """Published volume or volume ratio, with its text, source and range of values.

    Attributes
    ----------
    unit : str
        Of ``low`` and ``high``; "of rest" for a ratio.
    low, high : float
        Infinite where only the other bound is given.
    """

    words: str
    source: str
    unit: str
    low: float
    high: float


_RATIO, _KG_M3 = "of rest", "kg/m³"
_LB = 0.45359237 / 0.9144**3  # kg/m³ per pound per cubic yard
_YOKOHAMA = tr("Yokohama Shigen Junkan Kosha (municipal recycling), 23 December 2025")
_SUCKED = tr("Watermelon Headman (blog), 15 September 2022")
_EPA = tr("US EPA, in M. J. Franchetti, Solid Waste Analysis and Minimization, 2009, table 2.2")
_ISRI = tr("ISRI Scrap Specifications Circular, 2022, P-2022")
_AMCOR = tr("Amcor, in Packaging Insights, 17 November 2021; read here as the middle side")
_COLA = tr("Coca-Cola Japan, press release on I LOHAS, 23 April 2009")

# No published values were found for the other quantities.
PUBLISHED_VOLUMES: dict[VolumeName, tuple[PublishedVolume, ...]] = {
    VolumeName.SIDES: (
        PublishedVolume(
            tr("width of a collapsed bottle that can be sorted: above 5 cm (bottles of 50 ml)"),
            _AMCOR,
            "cm",
            5.0,
            math.inf,
        ),
    ),
    VolumeName.BULK: (
        PublishedVolume(tr("bottles of 2 l, crushed by hand: to 0.50"), _YOKOHAMA, _RATIO, 15 / 30, 15 / 30),
        PublishedVolume(
            tr("bottles of 1.5 l, with the air sucked out: to 0.56"), _SUCKED, _RATIO, 18 / 32, 18 / 32
        ),
    ),
    VolumeName.COUNT: (
        PublishedVolume(tr("15 bottles of 2 l; crushed by hand, 30"), _YOKOHAMA, _RATIO, 30 / 15, 30 / 15),
        PublishedVolume(
            tr("18 bottles of 1.5 l; with the air sucked out, 32"), _SUCKED, _RATIO, 32 / 18, 32 / 18
        ),
    ),
    VolumeName.DENSITY: (
        PublishedVolume(
            tr("PET, uncompacted: 18 to 24 kg/m³ (30 to 40 lb/yd³)"), _EPA, _KG_M3, 30 * _LB, 40 * _LB
        ),
        PublishedVolume(tr("PET, compacted: 71 kg/m³ (120 lb/yd³)"), _EPA, _KG_M3, 120 * _LB, 120 * _LB),
        PublishedVolume(tr("bales: at least 160 kg/m³ (10 lb/ft³)"), _ISRI, _KG_M3, 270 * _LB, math.inf),
    ),
    VolumeName.MATERIAL: (
        PublishedVolume(
            tr("a bottle to be twisted: 40 % less plastic than before (often retold as volume)"),
            _COLA,
            _RATIO,
            0.6,
            0.6,
        ),
    ),
}


_G_CM3 = 1000.0  # kg/m³ per g/cm³


def object_count(bag: float, readings: VolumeReadings, unit: Unit, packing: float = PACKING) -> int | None:
    """Number of objects in a bag of ``bag`` litres; None without a unit of length."""
    litre = unit.to_litres(1.0)
    return None if litre is None else readings.hull.count_in(bag / litre, packing)


def bulk_density(density: float | None, readings: VolumeReadings, packing: float = PACKING) -> float | None:
    """Mass over bulk volume, kg/m³; None if unknown.

    Parameters
    ----------
    density : float or None
        Density of the material, g/cm³.
    packing : float
        Volume fraction of the hulls in the bag.
    """
    bulk = readings.hull.bulk(packing)
    if density is None or readings.material is None or not bulk > 0.0:
        return None
    return _G_CM3 * density * readings.material / bulk
