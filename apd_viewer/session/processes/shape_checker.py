"""Checks of the newest shape in a process, killed as soon as the shape moves."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.hull_readings import HullReadings
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.pose.held_turn import HandleTurns, HeldTurn
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess
from apd_viewer.session.processes.newest_answer import NewestAnswer, wait_for_answer
from apd_viewer.session.processes.shape_check_main import NOT_CHECKED

_START = START_SCRIPT.format(module="processes.shape_check_main")
# A converged shape is often moved again at once, and at startup other work is more urgent.
NEXT_PAUSE, FIRST_PAUSE = 0.3, 2.0  # seconds before a check
# Result if the process died or cannot be started.
_NONE = (math.nan, math.nan, math.nan)
UNKNOWN_CHECK = ShapeCheck(None, _NONE, HullReadings(math.nan, math.nan, _NONE))


@dataclass(frozen=True, eq=False)
class ShapeQuery:
    """Shape to check: positions ``U`` (n, 3), welded triangles ``F`` (m, 3), turns."""

    U: np.ndarray
    F: np.ndarray
    handle_turns: HandleTurns | None = None


class ShapeChecker(NewestAnswer[ShapeQuery, ShapeCheck]):
    """Checker of one shape at a time; a new shape replaces the old one.

    Parameters
    ----------
    wake : callable
        Called on a thread when there is a check to take.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        process = ChildProcess("shape check", _START)
        super().__init__(
            wake, process, _answer, UNKNOWN_CHECK, lambda first: FIRST_PAUSE if first else NEXT_PAUSE
        )


def check_shape_in_process(query: ShapeQuery) -> ShapeCheck:
    """Check a shape in a separate process, and wait for the result."""
    return wait_for_answer(ChildProcess("shape check", _START), _answer, UNKNOWN_CHECK, query)


def _answer(process: ChildProcess, query: ShapeQuery) -> ShapeCheck | None:
    """Return the check of a shape; None if the process has died."""
    said = (
        np.ascontiguousarray(query.F, np.int32),
        np.ascontiguousarray(query.U),
        *_turn_messages(query.handle_turns),
    )
    if not process.send_messages(*said):
        return None
    crossing, boxes, turned = process.receive_message(), process.receive_message(), process.receive_message()
    if crossing is None or boxes is None or turned is None:
        return None
    ids = None if crossing == NOT_CHECKED else np.frombuffer(crossing, dtype=np.int64)
    dx, dy, dz, volume, width, a, b, c = np.frombuffer(boxes).tolist()
    turns = [
        HeldTurn(asked, None if math.isnan(held) else held)
        for asked, held in np.frombuffer(turned).reshape(-1, 2).tolist()
    ]
    return ShapeCheck(ids, (dx, dy, dz), HullReadings(volume, width, (a, b, c)), tuple(turns))


def _turn_messages(handle_turns: HandleTurns | None) -> tuple[bytes | np.ndarray, ...]:
    """The four messages about turns; see :func:`shape_check_main.serve`."""
    if handle_turns is None:
        return (b"",) * 4
    counts = np.array([len(way) for way in handle_turns.paths])
    poses = np.array(list(itertools.chain(*handle_turns.paths)))
    return np.ascontiguousarray(handle_turns.V), handle_turns.labels.astype(np.int64), counts, poses
