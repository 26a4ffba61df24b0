"""Geodesics of the newest shape in a process, killed when no longer needed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.measuring.surface_point import CarriedPath, SurfacePoint
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess
from apd_viewer.session.processes.newest_answer import NewestAnswer, wait_for_answer

_START = START_SCRIPT.format(module="processes.geodesic_main")
_CALM = 0.1  # seconds; a shape that has just converged is often moved again at once


@dataclass(frozen=True, eq=False)
class GeodesicQuery:
    """Two points of a shape ``U`` (n, 3) with welded triangles ``F`` (m, 3)."""

    U: np.ndarray
    F: np.ndarray
    end_points: tuple[SurfacePoint, ...]


class GeodesicFinder(NewestAnswer[GeodesicQuery, CarriedPath]):
    """Finder of one geodesic at a time; a new query replaces the old one.

    The path is empty if there is none, or if the process has died.

    Parameters
    ----------
    wake : callable
        Called on a thread when there is a path to take.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        process = ChildProcess("geodesic", _START)
        super().__init__(wake, process, _path, CarriedPath.empty(), lambda _: _CALM)


def find_geodesic(query: GeodesicQuery) -> CarriedPath:
    """Find a geodesic in a separate process, and wait for it."""
    return wait_for_answer(ChildProcess("geodesic", _START), _path, CarriedPath.empty(), query)


def _path(process: ChildProcess, query: GeodesicQuery) -> CarriedPath | None:
    ends = np.array([[end.face, *end.weights] for end in query.end_points])
    shape = np.ascontiguousarray(query.F, np.int32), np.ascontiguousarray(query.U)
    if not process.send_messages(*shape, ends):
        return None
    corners, weights = process.receive_message(), process.receive_message()
    if corners is None or weights is None:
        return None
    return CarriedPath(
        np.frombuffer(corners, dtype=np.int64).reshape(-1, 3), np.frombuffer(weights).reshape(-1, 3)
    )
