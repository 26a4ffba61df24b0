"""Baking: the shape on screen becomes the rest shape, measured as 100 %."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.language import tr
from apd_viewer.session.model.state import State, rest_frame


def baked_state(state: State) -> State:
    """The state with its shape as the rest shape; raises InputError if it has no area."""
    mesh = state.document.mesh.baked(state.frame.U)
    inspection = inspect(mesh)
    if inspection.area <= 0.0:
        raise InputError(tr("The shape has no area and cannot be a rest shape; undo a step first."))
    # The motions begin from here; pivots are where they were brought.
    handles = tuple(
        replace(handle.regripped(), earlier_poses=(), former_twist_axis=None)
        for handle in state.document.handles
    )
    document = replace(state.document, mesh=mesh, handles=handles).at_rest()
    there = zip(document.obstacles, state.obstacle_shifts, strict=True)
    document = replace(document, obstacles=tuple(each.with_shift_applied(shift) for each, shift in there))
    at_rest = State(document, inspection, state.surface_index, rest_frame(mesh, inspection))
    return at_rest.updated(document, replace(at_rest.frame, regions=document.region_areas(mesh.V)))
