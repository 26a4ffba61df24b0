"""Many objects in a bag: their number and bulk density, by random packing."""

from __future__ import annotations

from apd_viewer.geometry.analysis.hull_readings import PACKING
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.session.quantities.units import Unit

_KG_M3 = 1000.0  # in a g/cm³


def object_count(bag: float, readings: VolumeReadings, unit: Unit, packing: float = PACKING) -> int | None:
    """Number of objects in a ``bag`` of litres; None without a unit of length."""
    litre = unit.to_litres(1.0)
    return None if litre is None else readings.hull.count_in(bag / litre, packing)


def bulk_density(density: float | None, readings: VolumeReadings, packing: float = PACKING) -> float | None:
    """Mass over bulk volume, kg/m³; None if it is not known.

    Parameters
    ----------
    density : float or None
        That of the material, g/cm³.
    readings : VolumeReadings
    packing : float
        Share of the bag that the hulls fill.
    """
    bulk = readings.hull.bulk(packing)
    if density is None or readings.material is None or not bulk > 0.0:
        return None
    return _KG_M3 * density * readings.material / bulk
