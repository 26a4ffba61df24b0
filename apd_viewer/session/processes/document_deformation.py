"""Deformation of a document, and its iteration along the document's paths."""

import numpy as np

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.linear_solver import Factorizer
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.path_iteration import PathIteration, PathStop
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts, targets_of
from apd_viewer.session.model.handle_paths import intermediate_documents


def deformation_of(
    document: Document, held: Constraints, rest: RestMesh | None = None, factored: Factorizer | None = None
) -> Deformation:
    """Deformation of a document, without handle targets yet."""
    settings = {**vars(document.settings.effective_settings), **targets_of(document)._asdict()}
    del settings["hold_area"]
    return Deformation(
        document.mesh.V,
        document.mesh.F,
        held.fixed,
        handle=held.handles,
        rest=rest,
        factored=factored,
        soft=held.soft,
        loose=document.immobile_components,
        obstacles=document.active_obstacles,
        **settings,
    )


def document_iteration(
    solver: Deformation,
    document: Document,
    U: np.ndarray | None = None,
    along_paths: bool = True,
    start_shifts: np.ndarray | None = None,
) -> PathIteration:
    """Iteration of a document's deformation towards its poses.

    Paths beyond half a turn are followed from the initial positions in steps; otherwise the handles move to
    the poses at once. The shape thus depends on the document alone, and not on the pace of a drag.

    Parameters
    ----------
    U : (n, 3) float array or None
        The shape on screen, to go on from where there is nothing to walk; None goes on from the last
        iteration.
    along_paths : bool
        Whether to follow the paths instead of jumping to the poses.
    start_shifts : (o, 3) float array or None
        Displacements of the obstacles at ``U``; the requested ones if None or of another number.
    """
    held, shifts = document.constraints(), obstacle_shifts(document)
    if start_shifts is not None and start_shifts.shape != shifts.shape:
        start_shifts = None
    end = PathStop(held.targets, held.soft_targets, shifts)
    stops = [*map(_stop, intermediate_documents(document) if along_paths else ()), end]
    if len(stops) == 1:
        return PathIteration(solver, stops, U, start_shifts)
    has_come = start_shifts is None or np.array_equal(start_shifts, shifts)
    is_there = U is not None and has_come and _is_in_place(solver, held, U)
    return PathIteration(
        solver, stops, document.initial_positions, np.zeros_like(shifts), is_path_hidden=is_there
    )


def _stop(document: Document) -> PathStop:
    held = document.constraints()
    return PathStop(held.targets, held.soft_targets, obstacle_shifts(document))


def _is_in_place(solver: Deformation, held: Constraints, U: np.ndarray) -> bool:
    away = float(np.abs(U[held.fixed] - held.targets).max(initial=0.0))
    return away <= solver.rest.in_place_tolerance
