"""Folder of a study: a file for each case, a database, copies of inputs.

======================  ==================================================================
``cases/KE/KEY.case``   readings, curves and shape of a finished case; what is here is done
``inputs/``             meshes, selections and sessions, named by their content
``study.sqlite``        the plan and the readings; made anew from the files if it is lost
``results.csv``         the same as a table, and ``results.parquet`` where pyarrow is
``curves.csv``          a row a step of every case
======================  ==================================================================
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import folder_write_error
from apd_viewer.files.storage.lock import FileLock, acquire_lock
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.language import tr
from apd_viewer.studies.case_file import (
    FAILED,
    CaseResult,
    Curves,
    case_from_bytes,
    case_path,
    case_sizes,
    write_case,
)
from apd_viewer.studies.database import (
    DATABASE_ERRORS,
    is_damage,
    opened_database,
    rename_damaged,
    write_error,
)
from apd_viewer.studies.database_rows import case_rows, write_plan, write_result
from apd_viewer.studies.plans.plan import Plan
from apd_viewer.studies.results import ResultTable, read_result_table

T = TypeVar("T")

# Seconds between two commits: what is lost with the program is read from the files again.
_COMMIT = 1.0


class StudyStore:
    """Results of a study, written by one program at a time.

    Parameters
    ----------
    folder : Path
        Made where it is not there.

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
            self._lock = self._taken()
        except OSError as error:
            raise folder_write_error(folder, error) from error
        try:
            self._base = opened_database(folder)
        except BaseException:
            self._lock.remove()
            raise
        self._committed = time.monotonic()

    def _taken(self) -> FileLock:
        lock = acquire_lock(self.folder / ".lock")
        if lock is None:
            raise InputError(
                tr(
                    "Another program is running the study in {folder}; wait for it or choose another folder."
                ).format(folder=self.folder)
            )
        return lock

    def close(self) -> None:
        """Write the rest, and let others write."""
        with suppress(*DATABASE_ERRORS):  # the files have it all
            self._base.commit()
        self._base.close()
        self._lock.remove()

    def _safely(self, act: Callable[[], T]) -> T:
        """Act on the database, and again on a new one if damaged; raises InputError."""
        try:
            return act()
        except DATABASE_ERRORS as error:
            if not is_damage(error, self.folder):
                raise write_error(self.folder, error) from error
        try:
            self._make_anew()
            return act()
        except DATABASE_ERRORS as error:
            raise write_error(self.folder, error) from error

    def _make_anew(self) -> None:
        """Make another database, from the files of the cases."""
        self._base.close()
        rename_damaged(self.folder)
        self._base = opened_database(self.folder)
        if self._plan is not None:
            self._begun(self._plan)

    def _path(self, key: str) -> Path:
        return case_path(self.folder, key)

    def begin_plan(self, plan: Plan, retry_failed: bool = False) -> set[str]:
        """Write down a plan; return the keys of finished cases.

        Parameters
        ----------
        plan : Plan
        retry_failed : bool
            Whether failed cases count as not done.
        """
        self._plan = plan
        done = self._safely(lambda: self._begun(plan))
        if retry_failed:  # they stay until there is another result
            known = self._safely(lambda: case_rows(self._base))
            done -= {key for key in done if known[key].status == FAILED}
        return done

    def _begun(self, plan: Plan) -> set[str]:
        """Keys of finished cases, all in the database then, with the plan."""
        write_plan(self._base, plan)
        wanted = set(plan.cases)
        sizes = case_sizes(self.folder)
        known = {key: case.size for key, case in case_rows(self._base).items()}
        done = {key for key in wanted if sizes.get(key) == known.get(key, -1)}
        # Written just before the program was killed, or damaged.
        done |= {key for key in (wanted & sizes.keys()) - done if self._read_again(key) is not None}
        self._forget(wanted & known.keys() - done)
        self._base.commit()
        return done

    def _read_again(self, key: str) -> CaseResult | None:
        """Take the result of a file as the right one; remove a damaged one.

        Raises InputError if it is there and cannot be read now.
        """
        path = self._path(key)
        content = read_content(path) if path.exists() else b""
        try:
            result = case_from_bytes(content, with_shape=False)
            if result.key != key:
                raise ValueError
        except ValueError:
            self.damaged_count += path.exists()
            self._forget({key})
            return None
        write_result(self._base, result, len(content))
        return result

    def curves(self, keys: Iterable[str]) -> dict[str, Curves]:
        """Curves of finished cases; their files are compared with the database.

        A case whose file is damaged is not among them, and no longer finished.
        """
        found = self._safely(lambda: {key: self._read_again(key) for key in sorted(keys)})
        self.commit()
        return {key: result.curves for key, result in found.items() if result is not None}

    def results(self) -> ResultTable:
        """The results so far."""
        return self._safely(lambda: read_result_table(self._base))

    def _forget(self, keys: Iterable[str]) -> None:
        for key in keys:
            self._path(key).unlink(missing_ok=True)
            self._base.execute("delete from cases where key = ?", (key,))

    def add_result(self, content: bytes) -> CaseResult:
        """Write a finished case; return it without its shape.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        result = case_from_bytes(content, with_shape=False)
        write_case(self._path(result.key), content)
        self._safely(lambda: write_result(self._base, result, len(content)))
        if time.monotonic() - self._committed > _COMMIT:
            self.commit()
        return result

    def commit(self) -> None:
        """Commit the results added so far."""
        self._safely(lambda: self._base.commit())
        self._committed = time.monotonic()
