"""Progress of a study: finished cases, rate, time left; remaining work of a plan."""

import errno
import os
import time
from collections import defaultdict, deque
from pathlib import Path
from typing import NamedTuple

from apd_viewer.cases.case_file import FAILED, case_sizes, read_case
from apd_viewer.cases.database import DatabaseRow, case_rows, reading_database
from apd_viewer.cases.plan import Plan
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import folder_write_error

_WINDOW = 600.0  # seconds over which the rate is measured
_LEAST = 1  # cases needed for a rate


class CaseCounts(NamedTuple):
    """Case counts of a running study, with its rate and time left.

    Attributes
    ----------
    cases : int
        All different ones of the plan.
    finished : int
        The failed among them.
    rate : float or None
        Cases a second; None while it is not known.
    """

    cases: int
    finished: int
    running: int
    failed: int
    rate: float | None = None
    seconds_left: float | None = None

    @property
    def fraction(self) -> float:
        """Finished fraction of the cases."""
        return self.finished / max(1, self.cases)


class ProgressMeter:
    """Counts finished cases and measures their rate.

    Parameters
    ----------
    done, failed : int
        Numbers of finished cases and of failed ones among them.
    """

    def __init__(self, cases: int, done: int, failed: int) -> None:
        self._cases, self._done, self._failed = cases, done, failed
        self._started = time.monotonic()
        self._times: deque[float] = deque()
        self._new = 0

    def count_case(self, failed: bool) -> None:
        """Count one more finished case."""
        now = time.monotonic()
        self._done, self._new, self._failed = self._done + 1, self._new + 1, self._failed + failed
        self._times.append(now)
        while now - self._times[0] > _WINDOW:
            self._times.popleft()

    def counts(self, running: int) -> CaseCounts:
        """Current counts, rate and time left."""
        rate = self._rate()
        left = None if not rate else (self._cases - self._done) / rate
        return CaseCounts(self._cases, self._done, running, self._failed, rate, left)

    def _rate(self) -> float | None:
        if self._new < _LEAST:
            return None
        begin = max(self._started, time.monotonic() - _WINDOW)
        return len(self._times) / max(time.monotonic() - begin, 1e-3)


class StudyForecast(NamedTuple):
    """Remaining work of a study.

    Attributes
    ----------
    cases : int
        Different ones of the plan.
    done, failed : int
        Finished ones, and the failed among them.
    wrong : int
        Rows that no case can be made of.
    seconds : float or None
        Expected seconds of the remaining cases in one process; None if nothing was measured.
    """

    cases: int
    done: int
    failed: int
    wrong: int
    seconds: float | None


def study_forecast(plan: Plan, folder: Path, retry_failed: bool = False) -> StudyForecast:
    """Remaining work of a plan and its time; the results folder may be missing.

    Raises
    ------
    InputError
        If the folder is a file.
    """
    if folder.exists() and not folder.is_dir():
        raise folder_write_error(folder, NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR)))
    cases, known = plan.cases, _finished_rows(folder)
    sizes = case_sizes(folder)
    done = {key for key in cases if key in sizes and _is_intact(folder, key, sizes[key], known)}
    failed = {key for key in done if key in known and known[key].status == FAILED}
    if retry_failed:
        done, failed = done - failed, set()
    wrong = sum(row.case is None for row in plan.rows)
    left = [case for key, case in cases.items() if key not in done]
    timed = [(cases[key], each.readings.get("seconds")) for key, each in known.items() if key in cases]
    return StudyForecast(len(cases), len(done), len(failed), wrong, _remaining_seconds(left, timed))


def _finished_rows(folder: Path) -> dict[str, DatabaseRow]:
    """Database records of finished cases by key; empty if unreadable."""
    try:
        with reading_database(folder) as base:
            return case_rows(base)
    except InputError:
        return {}


def _is_intact(folder: Path, key: str, size: int, known: dict[str, DatabaseRow]) -> bool:
    """True if a file matches its database record or can be read in full."""
    if key in known and known[key].size == size:
        return True
    try:
        return bool(read_case(folder, key))
    except InputError:
        return False


def _remaining_seconds(left: list[StudyCase], timed: list[tuple[StudyCase, float | None]]) -> float | None:
    """Expected seconds left for cases, from mean step times per mesh and method."""
    if not left:
        return 0.0
    measured: dict[object, list[float]] = defaultdict(list)
    for case, seconds in timed:
        if seconds is not None:
            for kind in (_kind(case), None):
                measured[kind].append(seconds / (case.steps + 1))
    if not measured:
        return None
    mean = {kind: sum(each) / len(each) for kind, each in measured.items()}
    return sum(mean.get(_kind(case), mean[None]) * (case.steps + 1) for case in left)


def _kind(case: StudyCase) -> tuple[str, object]:
    return case.mesh.digest, dict(case.settings).get("method")
