"""A study: its plan, its engine and its folder.

======================  ==================================================================
``cases/KE/KEY.case``   readings, curves and shape of a finished case
``inputs/``             meshes, selections and sessions, named by their content
``study.sqlite``        the plan and the readings; rebuilt from the files if lost
``results.csv``         the same as a table, and ``results.parquet`` where pyarrow is
``curves.csv``          a row a step of every case
======================  ==================================================================
"""

import os
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from apd_viewer.cases import case_file, database
from apd_viewer.cases.case_runner import CaseRunner, Engine
from apd_viewer.cases.plan import Plan, read_plan
from apd_viewer.cases.results import ResultTable, read_result_table, write_curves, write_results
from apd_viewer.cases.run_case import INPUTS_FOLDER
from apd_viewer.cases.study_case import InputFiles, StudyCase
from apd_viewer.cases.study_progress import CaseCounts, ProgressMeter
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import folder_write_error
from apd_viewer.files.storage.lock import FileLock, acquire_lock
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.language import tr

# Least seconds between tables written during a run, and least multiple of the time that writing takes.
_TABLE, _TIMES = 20.0, 50.0
# Paths written in the folder, except the files of cases, which replace links instead of following them.
_WRITTEN = (
    *(".lock", "study.sqlite*", "results.*", "curves.csv"),
    *("cases", "cases/*", "inputs", "inputs/*", "inputs/*/*"),
)
T = TypeVar("T")
# Seconds between commits; results lost in a crash are recovered from the files of the cases.
_COMMIT = 1.0


class Study:
    """A plan and the folder of its results.

    Parameters
    ----------
    plan : Path
        Table to read.
    retry_failed : bool
        Whether to run failed cases again.

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
        """Number of damaged results found; their cases were rerun or are unfinished."""
        return self._store.damaged_count

    @property
    def unfinished_cases(self) -> dict[str, StudyCase]:
        """Unfinished cases by key."""
        return {key: case for key, case in self._cases.items() if key not in self._done}

    def run(
        self,
        engine: Engine,
        limit: float | None = None,
        on_progress: Callable[[CaseCounts], object] = lambda _: None,
    ) -> ResultTable:
        """Run the unfinished cases; write and return the results.

        Parameters
        ----------
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
        if self.unfinished_cases and not self._stopping:  # cases with files found damaged at the end
            table = self._round(engine, limit, on_progress)
        return table

    def _round(
        self, engine: Engine, limit: float | None, on_progress: Callable[[CaseCounts], object]
    ) -> ResultTable:
        rows = self._store.results().rows
        failed = sum(row.status == case_file.FAILED and row.key in self._done for row in rows)
        pace = ProgressMeter(len(self._cases), len(self._done), failed)

        def finished(content: bytes) -> None:
            result = self._store.add_result(content)
            self._done.add(result.key)
            pace.count_case(result.status == case_file.FAILED)

        def tick(running: int) -> None:
            on_progress(pace.counts(running))
            self._write_periodically()

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
        """Start no more cases, but finish the running ones; safe in a signal handler."""
        self._stopping = True
        if self._runner is not None:
            self._runner.stop()

    def write_table(self) -> ResultTable:
        """Write and return the table of the results so far."""
        started = time.monotonic()
        self._store.commit()
        table = self._store.results()
        write_results(self.folder, table)
        self._table = time.monotonic()
        self._took = self._table - started
        return table

    def _write_periodically(self) -> None:
        if time.monotonic() - self._table > max(_TABLE, _TIMES * self._took):
            self.write_table()

    def close(self) -> None:
        """Release the folder for other programs."""
        self._store.close()


def check_links(folder: Path) -> None:
    """Raise InputError for a link leading out of the folder."""
    inside = os.path.realpath(folder)
    for path in (path for pattern in _WRITTEN for path in folder.glob(pattern)):
        if path.is_symlink() and not Path(os.path.realpath(path)).is_relative_to(inside):
            raise InputError(tr("{path} is a link to outside the study; remove it.").format(path=path))


class StudyStore:
    """Results of a study on disk, locked for one writing program.

    Parameters
    ----------
    folder : Path
        Folder of the study, created if missing.

    Attributes
    ----------
    damaged_count : int
        Number of files that were damaged, whose cases count as not done.

    Raises
    ------
    InputError
        If it cannot be written, or another program is writing there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.damaged_count = folder, 0
        self._plan: Plan | None = None
        try:
            (folder / "cases").mkdir(parents=True, exist_ok=True)
            self._lock = self._acquire_lock()
        except OSError as error:
            raise folder_write_error(folder, error) from error
        try:
            self._base = database.open_database(folder)
        except BaseException:
            self._lock.remove()
            raise
        self._committed = time.monotonic()

    def _acquire_lock(self) -> FileLock:
        lock = acquire_lock(self.folder / ".lock")
        if lock is None:
            raise InputError(
                tr(
                    "Another program is running the study in {folder}; wait for it or choose another folder."
                ).format(folder=self.folder)
            )
        return lock

    def close(self) -> None:
        """Commit the results and release the folder for other programs."""
        with suppress(*database.DATABASE_ERRORS):  # the files of the cases hold all results
            self._base.commit()
        self._base.close()
        self._lock.remove()

    def _run_on_database(self, act: Callable[[], T]) -> T:
        """Run a database operation, rebuilding a damaged database; raises InputError."""
        try:
            return act()
        except database.DATABASE_ERRORS as error:
            if not database.is_damage(error, self.folder):
                raise database.write_error(self.folder, error) from error
        try:
            self._rebuild()
            return act()
        except database.DATABASE_ERRORS as error:
            raise database.write_error(self.folder, error) from error

    def _rebuild(self) -> None:
        """Rebuild the database from the files of the cases."""
        self._base.close()
        database.rename_damaged(self.folder)
        self._base = database.open_database(self.folder)
        if self._plan is not None:
            self._store_plan(self._plan)

    def _path(self, key: str) -> Path:
        return case_file.case_path(self.folder, key)

    def begin_plan(self, plan: Plan, retry_failed: bool = False) -> set[str]:
        """Store a plan; return the keys of its finished cases.

        Parameters
        ----------
        retry_failed : bool
            Whether failed cases count as unfinished.
        """
        self._plan = plan
        done = self._run_on_database(lambda: self._store_plan(plan))
        if retry_failed:  # results of failed cases stay until replaced
            known = self._run_on_database(lambda: database.case_rows(self._base))
            done -= {key for key in done if known[key].status == case_file.FAILED}
        return done

    def _store_plan(self, plan: Plan) -> set[str]:
        """Store a plan and its finished cases in the database; return their keys."""
        database.write_plan(self._base, plan)
        wanted = set(plan.cases)
        sizes = case_file.case_sizes(self.folder)
        known = {key: case.size for key, case in database.case_rows(self._base).items()}
        done = {key for key in wanted if sizes.get(key) == known.get(key, -1)}
        # Record files written just before the program was killed, and delete damaged ones.
        done |= {key for key in (wanted & sizes.keys()) - done if self._reread_case(key) is not None}
        self._remove_cases(wanted & known.keys() - done)
        self._base.commit()
        return done

    def _reread_case(self, key: str) -> case_file.CaseResult | None:
        """Record the result of a case's file in the database; delete a damaged file.

        Raises InputError if the file exists but cannot be read now.
        """
        path = self._path(key)
        content = read_content(path) if path.exists() else b""
        try:
            result = case_file.case_from_bytes(content, with_shape=False)
            if result.key != key:
                raise ValueError
        except ValueError:
            self.damaged_count += path.exists()
            self._remove_cases({key})
            return None
        database.write_result(self._base, result, len(content))
        return result

    def curves(self, keys: Iterable[str]) -> dict[str, case_file.Curves]:
        """Curves of finished cases, read from their files; the database is updated, too.

        Cases with damaged files are left out, and count as unfinished.
        """
        found = self._run_on_database(lambda: {key: self._reread_case(key) for key in sorted(keys)})
        self.commit()
        return {key: result.curves for key, result in found.items() if result is not None}

    def results(self) -> ResultTable:
        """Table of the results so far."""
        return self._run_on_database(lambda: read_result_table(self._base))

    def _remove_cases(self, keys: Iterable[str]) -> None:
        for key in keys:
            self._path(key).unlink(missing_ok=True)
            self._base.execute("delete from cases where key = ?", (key,))

    def add_result(self, content: bytes) -> case_file.CaseResult:
        """Write a finished case; return it without its shape.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        result = case_file.case_from_bytes(content, with_shape=False)
        case_file.write_case(self._path(result.key), content)
        self._run_on_database(lambda: database.write_result(self._base, result, len(content)))
        if time.monotonic() - self._committed > _COMMIT:
            self.commit()
        return result

    def commit(self) -> None:
        """Commit the results added so far."""
        self._run_on_database(lambda: self._base.commit())
        self._committed = time.monotonic()
