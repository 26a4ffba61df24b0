"""Published figures of crushed bottles, each under the quantity it measures."""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

from apd_viewer.language import tr


class VolumeName(Enum):
    """Volume or derived quantity; its value is its name in reports."""

    ENCLOSED = "enclosed_volume"
    HULL = "hull_volume"
    BOX = "packed_volume"
    SIDES = "packed_sides"
    WIDTH = "minimum_width"
    BULK = "bulk_volume"
    COUNT = "objects_in_bag"
    DENSITY = "bulk_density"
    MATERIAL = "material_volume"


class PublishedFigure(NamedTuple):
    """A published figure in words, its source, and its values.

    Attributes
    ----------
    words, source : str
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
_LB = 0.45359237 / 0.9144**3  # kg/m³ in a pound per cubic yard
_YOKOHAMA = tr("Yokohama Shigen Junkan Kosha (municipal recycling), 23 December 2025")
_SUCKED = tr("Watermelon Headman (blog), 15 September 2022")
_EPA = tr("US EPA, in M. J. Franchetti, Solid Waste Analysis and Minimization, 2009, table 2.2")
_ISRI = tr("ISRI Scrap Specifications Circular, 2022, P-2022")
_AMCOR = tr("Amcor, in Packaging Insights, 17 November 2021; read here as the middle side")
_COLA = tr("Coca-Cola Japan, press release on I LOHAS, 23 April 2009")

# No published figures were found for the other quantities.
PUBLISHED_FIGURES: dict[VolumeName, tuple[PublishedFigure, ...]] = {
    VolumeName.SIDES: (
        PublishedFigure(
            tr("width of a collapsed bottle that can be sorted: above 5 cm (bottles of 50 ml)"),
            _AMCOR,
            "cm",
            5.0,
            math.inf,
        ),
    ),
    VolumeName.BULK: (
        PublishedFigure(tr("bottles of 2 l, crushed by hand: to 0.50"), _YOKOHAMA, _RATIO, 15 / 30, 15 / 30),
        PublishedFigure(
            tr("bottles of 1.5 l, with the air sucked out: to 0.56"), _SUCKED, _RATIO, 18 / 32, 18 / 32
        ),
    ),
    VolumeName.COUNT: (
        PublishedFigure(tr("15 bottles of 2 l; crushed by hand, 30"), _YOKOHAMA, _RATIO, 30 / 15, 30 / 15),
        PublishedFigure(
            tr("18 bottles of 1.5 l; with the air sucked out, 32"), _SUCKED, _RATIO, 32 / 18, 32 / 18
        ),
    ),
    VolumeName.DENSITY: (
        PublishedFigure(
            tr("PET, uncompacted: 18 to 24 kg/m³ (30 to 40 lb/yd³)"),
            _EPA,
            _KG_M3,
            30 * _LB,
            40 * _LB,
        ),
        PublishedFigure(tr("PET, compacted: 71 kg/m³ (120 lb/yd³)"), _EPA, _KG_M3, 120 * _LB, 120 * _LB),
        PublishedFigure(tr("bales: at least 160 kg/m³ (10 lb/ft³)"), _ISRI, _KG_M3, 270 * _LB, math.inf),
    ),
    VolumeName.MATERIAL: (
        PublishedFigure(
            tr("a bottle to be twisted: 40 % less plastic than before (often retold as volume)"),
            _COLA,
            _RATIO,
            0.6,
            0.6,
        ),
    ),
}
