"""A saved session gone on with, without a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deform import Result, iterated, result_of
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import shifts_of
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.deforming import deformation_of
from apd_viewer.session.processes.walk import Walk
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.session.studies.turns import turns_in


def replay(
    path: str | Path,
    from_rest: bool = False,
    progress: Callable[[Frame], None] | None = None,
    passed: Callable[[np.ndarray], None] | None = None,
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
    passed : callable, optional
        Called with the shape (n, 3) that is gone on from, and with that of every frame; not called where the
        shape has settled.

    Raises
    ------
    InputError
        If the session cannot be opened, or nothing can be deformed in it; the message says why.
    """
    state, _ = open_session(path)
    document, started = state.document, time.perf_counter()
    if document.problem:
        raise InputError(f"{Path(path).name}: {document.problem}")
    held = document.constraints()
    solver = deformation_of(document, held)
    if not from_rest and _has_settled(state, held, solver):
        solver.aim(held.targets, state.frame.U, held.soft_targets, shifts_of(document), _come(state))
        frame = replace(state.frame, iteration=0, handle_drift=_drift(held, state.frame.U))
        turns = turns_in(document, frame.U)
        return document, result_of(solver, frame, time.perf_counter() - started, 0.0, turns)
    way = document.from_rest if from_rest else document
    walk = Walk(solver, way, None if from_rest else state.frame.U, begin=_come(state))
    if passed:
        passed(way.grip if from_rest else state.frame.U)
    told = _both(progress, passed)
    while not walk.arrived:
        walk.iterate()
        if told:
            told(walk.frame())
    turned = partial(turns_in, document)
    return document, iterated(solver, started, progress=told, last=walk.frame, turns=turned)


def _both(
    progress: Callable[[Frame], None] | None, passed: Callable[[np.ndarray], None] | None
) -> Callable[[Frame], None] | None:
    """A call for both, with a frame and with its shape."""
    if passed is None:
        return progress

    def told(frame: Frame) -> None:
        passed(frame.U)
        if progress:
            progress(frame)

    return told


def _has_settled(state: State, held: Constraints, solver: Deformation) -> bool:
    """True if the shape is settled: held vertices in place, targets met."""
    frame, document = state.frame, state.document
    if not frame.settled or (frame.converged and state.lacks):
        return False
    kept = held.fixed
    if document.traits.moves_handles:
        kept = np.setdiff1d(kept, np.concatenate(held.handles))
    away = frame.U[kept] - held.targets[np.searchsorted(held.fixed, kept)]
    return bool(np.abs(away).max(initial=0.0) <= solver.rest.in_place)


def _come(state: State) -> np.ndarray | None:
    """Motion of the obstacles so far; None where that is not known."""
    come = state.frame.shifts
    return come if len(come) == len(shifts_of(state.document)) else None


def _drift(held: Constraints, U: np.ndarray) -> float:
    """Distance of a handle's centre from its target; the largest of all handles."""
    places = [np.searchsorted(held.fixed, ids) for ids in held.handles]
    away = U[held.fixed] - held.targets
    return max((float(np.linalg.norm(away[rows].mean(axis=0))) for rows in places), default=0.0)
