"""Output of the command volumes: lines and report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from apd_viewer.commands.terminal.columns import column_count, padded_text
from apd_viewer.files.report import hull_fields
from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, PACKING
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.language import tr
from apd_viewer.presentation.published_volumes import PUBLISHED_FIGURES
from apd_viewer.presentation.volume_text import TextWithRange, VolumeRow
from apd_viewer.session.quantities.bulk_density import bulk_density, object_count
from apd_viewer.session.quantities.units import Unit

_WIDTH, _GAP = 28, 2


def volume_lines(name: str, rows: Sequence[VolumeRow], has_rest: bool) -> str:
    """Lines on all quantities, for the terminal."""
    lines = [name]
    width = max([_WIDTH, *(column_count(row.title) + _GAP for row in rows)])
    for row in rows:
        said = _reading_text(row.now)
        if has_rest:
            said = tr("{now} of {rest}").format(now=said, rest=_reading_text(row.rest))
            said += f"  {row.change}" if row.change else ""
        lines.append(padded_text(row.title, width) + said)
        lines += [f"    {row.definition}"] if row.definition else []
        for words, source, *_ in row.published:
            lines.append("    " + tr("published: {words} [{source}]").format(words=words, source=source))
    return "\n".join(lines)


def _reading_text(reading: TextWithRange) -> str:
    value, spread = reading
    return f"{value} ({spread})" if spread else value


def volumes_report(
    names: tuple[str, str | None],
    now: VolumeReadings,
    rest: VolumeReadings | None,
    unit: Unit,
    density: float | None,
    bag: float,
) -> dict[str, Any]:
    """Fields of the report.

    Parameters
    ----------
    names : tuple of str
        Of the mesh and of the rest shape, if there is one.
    now, rest : VolumeReadings
    unit, density, bag
        See :func:`~apd_viewer.presentation.volume_text.volume_rows`.
    """
    report: dict[str, Any] = {
        "mesh": names[0],
        "rest": names[1],
        "unit": unit.value or None,
        "packing": PACKING,
        "packing_range": (LOOSEST, DENSEST),
        "bag_litres": bag,
        **_fields(now, unit, density, bag),
    }
    if rest is not None:
        report |= {f"{name}_rest": value for name, value in _fields(rest, unit, density, bag).items()}
    return report | {"published": _published()}


def _fields(found: VolumeReadings, unit: Unit, density: float | None, bag: float) -> dict[str, Any]:
    counts = [object_count(bag, found, unit, packing) for packing in (LOOSEST, DENSEST)]
    densities = [bulk_density(density, found, packing) for packing in (LOOSEST, DENSEST)]
    return {
        "area": found.area,
        "enclosed_volume": found.enclosed,
        "openings": found.openings,
        "packed_volume": found.hull.box,
        **hull_fields(found.hull),
        "objects_in_bag": object_count(bag, found, unit),
        "objects_in_bag_range": counts,
        "bulk_density": bulk_density(density, found),
        "bulk_density_range": densities,
        "material_volume": found.material,
        "capacity": found.capacity,
    }


def _published() -> dict[str, list[dict[str, Any]]]:
    return {
        quantity.value: [
            {name: None if value == math.inf else value for name, value in figure._asdict().items()}
            for figure in figures
        ]
        for quantity, figures in PUBLISHED_FIGURES.items()
    }
