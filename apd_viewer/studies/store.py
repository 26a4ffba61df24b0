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

import json
import time
from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_folder import not_written
from apd_viewer.files.storage.lock import Lock, take
from apd_viewer.language import tr
from apd_viewer.studies.case_file import CaseResult, case_path, case_sizes, unpacked, write_case
from apd_viewer.studies.database import opened_database

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from apd_viewer.studies.plans.plan import Plan

# Seconds between two commits: what is lost with the program is read from the files again.
_COMMIT = 1.0


class StudyStore:
    """Results of a study, written by one program at a time.

    Parameters
    ----------
    folder : Path
        Made where it is not there.

    Raises
    ------
    InputError
        If it cannot be written, or another program is writing there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            (folder / "cases").mkdir(parents=True, exist_ok=True)
            self._lock = self._taken()
        except OSError as error:
            raise not_written(folder, error) from error
        try:
            self._base = opened_database(folder)
        except BaseException:
            self._lock.remove()
            raise
        self._committed = time.monotonic()

    def _taken(self) -> Lock:
        lock = take(self.folder / ".lock")
        if lock is None:
            raise InputError(
                tr(
                    "Another program is running the study in {folder}; wait for it or choose another folder."
                ).format(folder=self.folder)
            )
        return lock

    def close(self) -> None:
        """Write the rest, and let others write."""
        self._base.commit()
        self._base.close()
        self._lock.remove()

    def path(self, key: str) -> Path:
        """File of a finished case."""
        return case_path(self.folder, key)

    def begin(self, plan: Plan, retry_failed: bool = False) -> set[str]:
        """Write down a plan; return the keys of finished cases.

        Parameters
        ----------
        plan : Plan
        retry_failed : bool
            Whether failed cases count as not done.
        """
        self._write_plan(plan)
        wanted = set(plan.cases)
        sizes = case_sizes(self.folder)
        known = dict(self._base.execute("select key, size from cases"))
        done = {key for key in wanted if sizes.get(key) == known.get(key, -1)}
        for key in (wanted & sizes.keys()) - done:  # written just before the program was killed, or damaged
            if self._read_again(key):
                done.add(key)
        self._forget(wanted & known.keys() - done)
        if retry_failed:  # they stay until there is another result
            done -= {key for (key,) in self._base.execute("select key from cases where status = 'failed'")}
        self._base.commit()
        return done

    def _write_plan(self, plan: Plan) -> None:
        rows = (
            (
                k,
                row.line,
                None if row.case is None else row.case.key,
                row.mistake,
                row.same_as,
                json.dumps(row.cells),
            )
            for k, row in enumerate(plan.rows)
        )
        self._base.execute("delete from plan")
        self._base.executemany("insert into plan values (?, ?, ?, ?, ?, ?)", rows)
        self._base.execute("insert or replace into facts values ('columns', ?)", (json.dumps(plan.columns),))

    def _read_again(self, key: str) -> bool:
        """Take the result of a file; remove a damaged one."""
        try:
            content = self.path(key).read_bytes()
            self._insert(unpacked(content, shape=False), len(content))
        except (ValueError, OSError):
            self.path(key).unlink(missing_ok=True)
            return False
        return True

    def _forget(self, keys: Iterable[str]) -> None:
        for key in keys:
            self.path(key).unlink(missing_ok=True)
            self._base.execute("delete from cases where key = ?", (key,))

    def add(self, content: bytes) -> CaseResult:
        """Write a finished case; return it without its shape.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        result = unpacked(content, shape=False)
        write_case(self.path(result.key), content)
        self._insert(result, len(content))
        if time.monotonic() - self._committed > _COMMIT:
            self.commit()
        return result

    def commit(self) -> None:
        """Commit the results added so far."""
        self._base.commit()
        self._committed = time.monotonic()

    def _insert(self, result: CaseResult, size: int) -> None:
        readings = result.readings
        self._base.execute(
            "insert or replace into cases values (?, ?, ?, ?, ?, ?)",
            (result.key, size, result.status, result.sentence, readings.get("seconds"), json.dumps(readings)),
        )
