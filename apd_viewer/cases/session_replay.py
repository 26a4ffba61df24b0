"""A saved session gone on with, without a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from apd_viewer.cases.sweep import document_turns
from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import Result, deformation_result, iterate_to_result
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.storage.session_file import open_session


def replay_session(
    path: str | Path,
    from_rest: bool = False,
    progress: Callable[[Frame], None] | None = None,
    on_shape: Callable[[np.ndarray], None] | None = None,
) -> tuple[Document, Result]:
    """Bring the shape of a saved session to rest.

    A saved shape that has settled is the answer already: it is measured anew, and stays as it is.

    Parameters
    ----------
    path : path
    from_rest : bool
        Begin with the rest shape, and go to where the handles are.
    progress : callable, optional
        Called with every Frame.
    on_shape : callable, optional
        Called with the shape (n, 3) that is gone on from, and with that of every frame; not called where the
        shape has settled.

    Raises
    ------
    InputError
        If the session cannot be opened, or nothing can be deformed in it; the message says why.
    """
    state, _ = open_session(path)
    document, started = state.document, time.perf_counter()
    if document.paint_problem:
        raise InputError(f"{Path(path).name}: {document.paint_problem}")
    held = document.constraints()
    solver = deformation_of(document, held)
    if not from_rest and _has_settled(state, held, solver):
        solver.aim(
            held.targets, state.frame.U, held.soft_targets, obstacle_shifts(document), _obstacle_shifts(state)
        )
        frame = replace(state.frame, iteration=0, handle_drift=_drift(held, state.frame.U))
        turns = document_turns(document, frame.U)
        return document, deformation_result(solver, frame, time.perf_counter() - started, 0.0, turns)
    way = document.relative_to_rest if from_rest else document
    walk = document_iteration(
        solver, way, None if from_rest else state.frame.U, start_shifts=_obstacle_shifts(state)
    )
    if on_shape:
        on_shape(way.grip if from_rest else state.frame.U)
    turned = partial(document_turns, document)
    return document, iterate_to_result(solver, walk, started, None, _both(progress, on_shape), turned)


def _both(
    progress: Callable[[Frame], None] | None, on_shape: Callable[[np.ndarray], None] | None
) -> Callable[[Frame], None] | None:
    """A call for both, with a frame and with its shape."""
    if on_shape is None:
        return progress

    def told(frame: Frame) -> None:
        on_shape(frame.U)
        if progress:
            progress(frame)

    return told


def _has_settled(state: State, held: Constraints, solver: Deformation) -> bool:
    """True if the shape is settled: held vertices in place, targets met."""
    frame, document = state.frame, state.document
    if not frame.settled or (frame.converged and state.has_unmet_target):
        return False
    kept = held.fixed
    if document.settings.traits.moves_handles:
        kept = np.setdiff1d(kept, np.concatenate(held.handles))
    away = frame.U[kept] - held.targets[np.searchsorted(held.fixed, kept)]
    return bool(np.abs(away).max(initial=0.0) <= solver.rest.in_place_tolerance)


def _obstacle_shifts(state: State) -> np.ndarray | None:
    """Motion of the obstacles so far; None where that is not known."""
    come = state.frame.shifts
    return come if len(come) == len(obstacle_shifts(state.document)) else None


def _drift(held: Constraints, U: np.ndarray) -> float:
    """Distance of a handle's centre from its target; the largest of all handles."""
    places = [np.searchsorted(held.fixed, ids) for ids in held.handles]
    away = U[held.fixed] - held.targets
    return max((float(np.linalg.norm(away[rows].mean(axis=0))) for rows in places), default=0.0)
