"""Checks of the newest shape in a process, ended as soon as the shape moves."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.hull_readings import HullReadings
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.turns.held_turn import HeldTurn, Turning
from apd_viewer.session.processes.child_process import START, ChildProcess
from apd_viewer.session.processes.newest_answer import NewestAnswer, waited_for
from apd_viewer.session.processes.shape_check_main import NOBODY_LOOKED

_START = START.format(module="processes.shape_check_main")
# A settled shape is often moved again at once, and a program just starting has more urgent work.
CALM, AT_FIRST = 0.3, 2.0  # s
# Result if the process died or cannot be started.
_NONE = (math.nan, math.nan, math.nan)
UNKNOWN = ShapeCheck(None, _NONE, HullReadings(math.nan, math.nan, _NONE))


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape to check: positions ``U`` (n, 3), welded triangles ``F`` (m, 3), turns."""

    U: np.ndarray
    F: np.ndarray
    turning: Turning | None = None


class ShapeChecker(NewestAnswer[Shape, ShapeCheck]):
    """Checks one shape at a time; the newest wins.

    Parameters
    ----------
    wake : callable
        Called on a thread when there is a check to take.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        process = ChildProcess("shape check", _START)
        super().__init__(wake, process, _answer, UNKNOWN, lambda first: AT_FIRST if first else CALM)


def checked(shape: Shape) -> ShapeCheck:
    """Check a shape in a process of its own, and wait for it."""
    return waited_for(ChildProcess("shape check", _START), _answer, UNKNOWN, shape)


def _answer(process: ChildProcess, shape: Shape) -> ShapeCheck | None:
    """Return the check of a shape; None if the process has died."""
    said = np.ascontiguousarray(shape.F, np.int32), np.ascontiguousarray(shape.U), *_turned(shape.turning)
    if not process.send(*said):
        return None
    crossing, boxes, turned = process.receive(), process.receive(), process.receive()
    if crossing is None or boxes is None or turned is None:
        return None
    ids = None if crossing == NOBODY_LOOKED else np.frombuffer(crossing, dtype=np.int64)
    dx, dy, dz, volume, width, a, b, c = np.frombuffer(boxes).tolist()
    turns = [
        HeldTurn(asked, None if math.isnan(held) else held)
        for asked, held in np.frombuffer(turned).reshape(-1, 2).tolist()
    ]
    return ShapeCheck(ids, (dx, dy, dz), HullReadings(volume, width, (a, b, c)), tuple(turns))


def _turned(turning: Turning | None) -> tuple[bytes | np.ndarray, ...]:
    """The four messages about turns; see :func:`shape_check_main.serve`."""
    if turning is None:
        return (b"",) * 4
    counts = np.array([len(way) for way in turning.ways])
    poses = np.array(list(itertools.chain(*turning.ways)))
    return np.ascontiguousarray(turning.V), turning.labels.astype(np.int64), counts, poses
