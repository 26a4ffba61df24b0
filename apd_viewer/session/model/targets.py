"""Targets of area and volume of a document."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.goals.percentage import percentage_text

if TYPE_CHECKING:
    from apd_viewer.geometry.goals.goals import Region
    from apd_viewer.session.model.document import Document


class Targets(NamedTuple):
    """Area and volume targets, as arguments of :meth:`Deformation.keep`."""

    area: float | str | None
    volume: float | str | None
    regions: tuple[Region, ...]


def kept_percentages(document: Document) -> tuple[float | None, ...]:
    """Percentages passed to the method; None for a region without a triangle."""
    method = document.settings.traits
    keeps_area = method.keeps_total_area or (method.may_keep_total_area and document.settings.hold_area)
    only_area = method.keeps_only_total_area
    return (
        document.settings.area if keeps_area else None,
        None if only_area else document.settings.volume,
        *(
            part.area if at_rest > 0.0 and not only_area else None
            for part, at_rest in zip(document.regions, document.rest_areas, strict=True)
        ),
    )


def targets_of(document: Document) -> Targets:
    """Targets passed to the method, with the vertices of the regions."""
    # Imported here: it loads scipy and numba, and the panel of the first picture needs the percentages alone.
    from apd_viewer.geometry.goals.goals import Region

    area, volume, *areas = map(percentage_text, kept_percentages(document))
    regions = tuple(
        Region(part.name, np.flatnonzero(document.member == k), percent)
        for k, (part, percent) in enumerate(zip(document.regions, areas, strict=True), start=1)
    )
    return Targets(area, volume, regions)
