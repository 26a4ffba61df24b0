"""A study: its plan, its folder and its engine."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

from apd_viewer.cases.case_file import FAILED
from apd_viewer.cases.case_runner import CaseRunner, Engine
from apd_viewer.cases.case_session import INPUTS_FOLDER
from apd_viewer.cases.input_files import InputFiles
from apd_viewer.cases.plan import Plan, read_plan
from apd_viewer.cases.progress_meter import CaseCounts, ProgressMeter
from apd_viewer.cases.results import ResultTable, write_curves, write_results
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.cases.study_store import StudyStore
from apd_viewer.errors import InputError
from apd_viewer.language import tr

# Seconds between two tables written on the way, and how many times longer than writing took that is at least.
_TABLE, _TIMES = 20.0, 50.0


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
        check_links(folder)
        self.plan: Plan = read_plan(plan, InputFiles(folder / INPUTS_FOLDER))
        self._store = StudyStore(folder)
        try:
            self._cases = self.plan.cases
            self._done = self._store.begin_plan(self.plan, retry_failed)
        except BaseException:
            self._store.close()
            raise
        self._runner: CaseRunner | None = None
        self._stopping = False
        self._table, self._took = time.monotonic(), 0.0

    @property
    def damaged_count(self) -> int:
        """Number of damaged results; their cases are left, or were run again."""
        return self._store.damaged_count

    @property
    def unfinished_cases(self) -> dict[str, StudyCase]:
        """Unfinished cases by their keys."""
        return {key: case for key, case in self._cases.items() if key not in self._done}

    def _failed(self, table: ResultTable) -> int:
        """Number of finished cases that failed."""
        return sum(row.status == FAILED and row.key in self._done for row in table.rows)

    def run(
        self,
        engine: Engine,
        limit: float | None = None,
        on_progress: Callable[[CaseCounts], object] = lambda _: None,
    ) -> ResultTable:
        """Run the unfinished cases; write and return the results.

        Parameters
        ----------
        engine : Engine
        limit : float, optional
            Seconds that a case may take.
        on_progress : callable
            Called with the progress, twice a second and after every case.

        Raises
        ------
        InputError
            If the engine is gone or the folder cannot be written; what is done is kept.
        """
        table = self._round(engine, limit, on_progress)
        if self.unfinished_cases and not self._stopping:  # files that were found damaged at the end
            table = self._round(engine, limit, on_progress)
        return table

    def _round(
        self, engine: Engine, limit: float | None, on_progress: Callable[[CaseCounts], object]
    ) -> ResultTable:
        failed = self._failed(self._store.results())
        pace = ProgressMeter(len(self._cases), len(self._done), failed)

        def finished(content: bytes) -> None:
            result = self._store.add_result(content)
            self._done.add(result.key)
            pace.count_case(result.status == FAILED)

        def tick(running: int) -> None:
            on_progress(pace.counts(running))
            self._write_now_and_then()

        self._runner = CaseRunner(self.unfinished_cases, engine, finished, limit, tick)
        if self._stopping:
            self._runner.stop()
        try:
            self._runner.run()
        except InputError:
            self.write_table()
            raise
        return self.finish()

    def finish(self) -> ResultTable:
        """Write all tables and return the results, without damaged cases."""
        curves = self._store.curves(self._done)
        self._done &= curves.keys()
        table = self.write_table()
        write_curves(self.folder, table, curves)
        return table

    def stop(self) -> None:
        """Start no more cases, and finish the running ones; safe in a signal handler."""
        self._stopping = True
        if self._runner is not None:
            self._runner.stop()

    def write_table(self) -> ResultTable:
        """Write the table of the results as they are, and return it."""
        started = time.monotonic()
        self._store.commit()
        table = self._store.results()
        write_results(self.folder, table)
        self._table = time.monotonic()
        self._took = self._table - started
        return table

    def _write_now_and_then(self) -> None:
        if time.monotonic() - self._table > max(_TABLE, _TIMES * self._took):
            self.write_table()

    def close(self) -> None:
        """Let others write into the folder."""
        self._store.close()


# All that is written there, but for the files of cases, which take the place of links.
_WRITTEN = (
    ".lock",
    "study.sqlite*",
    "results.*",
    "curves.csv",
    "cases",
    "cases/*",
    "inputs",
    "inputs/*",
    "inputs/*/*",
)


def check_links(folder: Path) -> None:
    """Raise InputError for a link out of the folder."""
    inside = os.path.realpath(folder)
    for path in (path for pattern in _WRITTEN for path in folder.glob(pattern)):
        if path.is_symlink() and not Path(os.path.realpath(path)).is_relative_to(inside):
            raise InputError(tr("{path} is a link that leads out of the study; remove it.").format(path=path))
