"""Measurements of a shape over time, from the start of a step until convergence."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.model.state import State

TRACE_COLUMNS = (
    "seconds",
    "iteration",
    "area",
    "area_error",
    "area_miss",
    "volume",
    "energy",
    "local_change",
    "largest_edge_strain",
    "mean_edge_strain",
)
# Largest number of samples, about a plot's width in pixels; even, so that every other one can be dropped.
MOST_SAMPLES = 512


@dataclass(eq=False)
class _Start:
    """Start of a trace: requested document, initial readings and time."""

    requested: Document | None
    readings: list[float]
    moment: float
    released: float | None = None


class Trace:
    """Time series of readings of the displayed frames, in bounded memory.

    A trace begins with the initial shape. When it is full, every other sample is dropped, and from then on
    every other frame is skipped; the latest one is always kept.

    Parameters
    ----------
    clock : callable
        The time in seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._rows = np.empty((MOST_SAMPLES, len(TRACE_COLUMNS)))
        self._start = _Start(None, [], 0.0)
        self._next: _Start | None = None
        self._clear()
        self._total: int | None = None

    def _clear(self) -> None:
        self._count = self._iteration = 0
        self._since = self._stride = 1

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, name: str) -> np.ndarray:
        """Column by its name in ``TRACE_COLUMNS``, read-only; NaN for unknown values.

        Seconds and iterations since the beginning; areas in square lengths; ``area_error`` relative to rest,
        ``area_miss`` to the target; all others as in :class:`apd_viewer.geometry.pose.frame.Frame`.
        """
        return frozen(self._rows[: self._count, TRACE_COLUMNS.index(name)].copy())

    @property
    def rows(self) -> np.ndarray:
        """All samples, (k, 10) float array, read-only."""
        return frozen(self._rows[: self._count].copy())

    @property
    def released_at(self) -> float | None:
        """Seconds from the start to the release of the mouse; None if there is none."""
        moment = self._start.released
        return None if moment is None else moment - self._start.moment

    def begin(self, state: State) -> None:
        """Begin a new trace from ``state``."""
        self._next = self._total = None
        self._begin(_Start(state.document, _readings(state.document, state.frame), self._clock()))

    def begin_with_next_frame(self, requested: Document | None, state: State) -> None:
        """Begin a new trace from ``state`` at the first frame of another document."""
        self._next = _Start(requested, _readings(state.document, state.frame), self._clock())

    def mark_release(self) -> None:
        """Mark the end of the gesture, possibly before convergence."""
        (self._next or self._start).released = self._clock()

    def add_frame(self, document: Document, frame: Frame) -> None:
        """Append a frame of ``document``."""
        coming = self._next
        if coming is not None and document is not coming.requested:
            self._next = None
            self._begin(coming)
        # Undisplayed frames are not measured, but their iterations count.
        more = frame.iteration if self._total is None else frame.total - self._total
        self._iteration += more if more >= 0 else frame.total  # a new solver restarts its iteration count
        self._total = frame.total
        self._store_row([self._clock() - self._start.moment, self._iteration, *_readings(document, frame)])

    def _begin(self, start: _Start) -> None:
        self._start = replace(start, requested=None)  # a stored document would keep its mesh alive
        self._clear()
        self._store_row([0.0, 0.0, *start.readings])

    def _store_row(self, row: list[float]) -> None:
        if self._count > 1 and self._since < self._stride:
            self._since += 1
        else:
            self._since = 1
            if self._count == MOST_SAMPLES:
                self._rows[: MOST_SAMPLES // 2] = self._rows[::2]
                self._count = MOST_SAMPLES // 2
                self._since += self._stride  # account for the last dropped sample
                self._stride *= 2
            self._count += 1
        self._rows[self._count - 1] = row


def _readings(document: Document, frame: Frame) -> list[float]:
    """Readings of a frame, in column order starting with the area."""
    wanted = (goal_percentages(document)[0] or 100.0) / 100.0
    miss = abs((1.0 + frame.area_error) / wanted - 1.0)
    known = frame.volume, frame.energy
    volume, energy = (np.nan if value is None else value for value in known)
    strains = frame.largest_edge_strain, frame.mean_edge_strain
    return [frame.area, frame.area_error, miss, volume, energy, frame.local_change, *strains]
