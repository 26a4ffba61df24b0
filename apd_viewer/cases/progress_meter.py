"""Progress of a study: cases done, rate, time left."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass

_WINDOW = 600.0  # s over which the rate is measured
_LEAST = 2  # cases, of which one may have had to compile


@dataclass(frozen=True)
class CaseCounts:
    """State of a running study.

    Attributes
    ----------
    cases : int
        All different ones of the plan.
    done : int
        Finished ones, the failed among them.
    running, failed : int
    rate : float or None
        Cases a second; None while it is not known.
    seconds_left : float or None
    """

    cases: int
    done: int
    running: int
    failed: int
    rate: float | None = None
    seconds_left: float | None = None


class ProgressMeter:
    """Counts finished cases and measures their rate.

    Parameters
    ----------
    cases : int
    done, failed : int
        So many were there already.
    """

    def __init__(self, cases: int, done: int, failed: int) -> None:
        self._cases, self._done, self._failed = cases, done, failed
        self._started = time.monotonic()
        self._times: deque[float] = deque()
        self._new = 0

    def count_case(self, failed: bool) -> None:
        """Count one more."""
        now = time.monotonic()
        self._done, self._new, self._failed = self._done + 1, self._new + 1, self._failed + failed
        self._times.append(now)
        while now - self._times[0] > _WINDOW:
            self._times.popleft()

    def counts(self, running: int) -> CaseCounts:
        """The state now."""
        rate = self._rate()
        left = None if not rate else (self._cases - self._done) / rate
        return CaseCounts(self._cases, self._done, running, self._failed, rate, left)

    def _rate(self) -> float | None:
        if self._new < _LEAST:
            return None
        begin = max(self._started, time.monotonic() - _WINDOW)
        return len(self._times) / max(time.monotonic() - begin, 1e-3)
