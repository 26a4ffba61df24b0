"""Report block: every volume by its name, beside published figures of the same."""

from __future__ import annotations

import math

from apd_viewer.files.html_page import PageBlock, PageGrid, PageNote
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.presentation.volume_text import volume_rows
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall, wall_density, wall_thickness


def volumes_block(state: State, unit: Unit, wall: Wall, checks: tuple[ShapeCheck, ShapeCheck]) -> PageBlock:
    """Table of the volumes at rest and now; ``checks`` are those of both shapes."""
    at_rest, found = checks
    if math.isnan(found.packed) or math.isnan(at_rest.packed):  # the process that measures has died
        return PageNote(tr("Not measured; create the report again."))
    now, then = readings.volumes(state.frame, state.inspection)
    wall_found = state.inspection.double_wall
    thickness, openings = wall_thickness(wall, unit), state.inspection.openings
    rows = volume_rows(
        VolumeReadings.of(state.inspection.area, then, openings, at_rest.hull, thickness, wall_found),
        VolumeReadings.of(state.frame.area, now, openings, found.hull, thickness, wall_found),
        unit,
        wall_density(wall),
    )
    none = (("", tr("none found")),)
    head = tr("Quantity"), tr("At rest"), tr("Now"), tr("Change"), tr("Published")
    lines = [
        (
            ((row.title, row.definition),),
            (row.rest,),
            (row.now,),
            ((row.change, ""),) if row.change else (),
            tuple((each.words, each.source) for each in row.published) or none,
        )
        for row in rows
    ]
    return PageGrid(head, tuple(lines))
