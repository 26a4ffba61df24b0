"""A study: its plan, its folder and its engine."""

from __future__ import annotations

import time
from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.studies.case_file import FAILED
from apd_viewer.studies.case_session import INPUTS
from apd_viewer.studies.engine import Runner
from apd_viewer.studies.pace import Pace
from apd_viewer.studies.plans.plan import read_plan
from apd_viewer.studies.plans.sources import Sources
from apd_viewer.studies.results import read_results, write_curves, write_results
from apd_viewer.studies.store import StudyStore

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from apd_viewer.studies.engine import Engine
    from apd_viewer.studies.pace import CaseCounts
    from apd_viewer.studies.plans.case import StudyCase
    from apd_viewer.studies.plans.plan import Plan
    from apd_viewer.studies.results import ResultTable

# Seconds between two tables written on the way, and how many times longer than writing took that is at least.
_TABLE, _TIMES = 20.0, 50.0


class WorkLeft(NamedTuple):
    """Work left of a study.

    Attributes
    ----------
    cases : int
        Different ones of the plan.
    done, failed : int
        Finished ones, and the failed among them.
    wrong : int
        Rows that no case can be made of.
    seconds : float or None
        That the rest takes one process, by what was measured so far; None if nothing was.
    """

    cases: int
    done: int
    failed: int
    wrong: int
    seconds: float | None


class Study:
    """A plan and the folder of its results.

    Parameters
    ----------
    plan : Path
        Table to read.
    folder : Path
    retry_failed : bool
        Whether failed cases are tried again.

    Raises
    ------
    InputError
        If the plan cannot be read, or the folder not written.
    """

    def __init__(self, plan: Path, folder: Path, retry_failed: bool = False) -> None:
        self.folder = folder
        self.plan: Plan = read_plan(plan, Sources(folder / INPUTS))
        self._store = StudyStore(folder)
        try:
            self._cases = self.plan.cases
            self._done = self._store.begin(self.plan, retry_failed)
        except BaseException:
            self._store.close()
            raise
        self._runner: Runner | None = None
        self._stopping = False
        self._table, self._took = time.monotonic(), 0.0

    @property
    def left(self) -> dict[str, StudyCase]:
        """Unfinished cases by their keys."""
        return {key: case for key, case in self._cases.items() if key not in self._done}

    def forecast(self) -> WorkLeft:
        """Work left, and its time."""
        table = read_results(self.folder)
        failed = self._failed(table)
        wrong = sum(row.case is None for row in self.plan.rows)
        return WorkLeft(len(self._cases), len(self._done), failed, wrong, self._seconds(table))

    def _failed(self, table: ResultTable) -> int:
        """Number of finished cases that failed."""
        return sum(row.status == FAILED and row.key in self._done for row in table.rows)

    def _seconds(self, table: ResultTable) -> float | None:
        """Seconds of the rest, from those of a step on the same mesh, or on any."""
        measured: dict[object, list[float]] = defaultdict(list)
        for row in table.rows:
            seconds, case = row.readings.get("seconds"), self._cases.get(row.key)
            if seconds is not None and case is not None:
                for kind in (_kind(case), None):
                    measured[kind].append(seconds / (case.steps + 1))
        if not self.left:
            return 0.0
        if not measured:
            return None
        mean = {kind: sum(each) / len(each) for kind, each in measured.items()}
        return sum(mean.get(_kind(case), mean[None]) * (case.steps + 1) for case in self.left.values())

    def run(
        self,
        engine: Engine,
        limit: float | None = None,
        told: Callable[[CaseCounts], object] = lambda _: None,
    ) -> ResultTable:
        """Run the unfinished cases; write and return the results.

        Parameters
        ----------
        engine : Engine
        limit : float, optional
            Seconds that a case may take.
        told : callable
            Called with the progress, twice a second and after every case.

        Raises
        ------
        InputError
            If the engine is gone or the folder cannot be written; what is done is kept.
        """
        failed = self._failed(read_results(self.folder))
        pace = Pace(len(self._cases), len(self._done), failed)

        def finished(content: bytes) -> None:
            result = self._store.add(content)
            self._done.add(result.key)
            pace.finished(result.status == FAILED)

        def tick(running: int) -> None:
            told(pace.progress(running))
            self._write_now_and_then()

        self._runner = Runner(self.left, engine, finished, limit, tick)
        if self._stopping:
            self._runner.stop()
        try:
            self._runner.run()
        except InputError:
            self.write()
            raise
        return self.finish()

    def finish(self) -> ResultTable:
        """Write all tables; return the results."""
        table = self.write()
        write_curves(self.folder, table)
        return table

    def stop(self) -> None:
        """Start no more cases, and finish the running ones; safe in a signal handler."""
        self._stopping = True
        if self._runner is not None:
            self._runner.stop()

    def write(self) -> ResultTable:
        """Write the table of the results as they are, and return it."""
        started = time.monotonic()
        self._store.commit()
        table = read_results(self.folder)
        write_results(self.folder, table)
        self._table = time.monotonic()
        self._took = self._table - started
        return table

    def _write_now_and_then(self) -> None:
        if time.monotonic() - self._table > max(_TABLE, _TIMES * self._took):
            self.write()

    def close(self) -> None:
        """Let others write into the folder."""
        self._store.close()


def _kind(case: StudyCase) -> tuple[str, object]:
    return case.mesh.digest, dict(case.settings).get("method")
