"""Rows of the database of a study, written and read.

Read, they are checked, as anybody may have written them.
"""

from __future__ import annotations

import json
import sqlite3
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from apd_viewer.studies.case_file import is_reading
from apd_viewer.studies.database import DATABASE

if TYPE_CHECKING:
    from apd_viewer.studies.case_file import CaseResult
    from apd_viewer.studies.plans.plan import Plan

T = TypeVar("T")


class KnownCase(NamedTuple):
    """A finished case, as the database knows it.

    Attributes
    ----------
    size : int
        Of its file, in bytes.
    status, sentence : str
    readings : dict
    """

    size: int
    status: str
    sentence: str
    readings: dict[str, float | None]


def write_plan(base: sqlite3.Connection, plan: Plan) -> None:
    """Write a plan in place of the one before."""
    rows = (
        (k, row.line, row.case and row.case.key, row.mistake, row.same_as, json.dumps(row.cells))
        for k, row in enumerate(plan.rows)
    )
    base.execute("delete from plan")
    base.executemany("insert into plan values (?, ?, ?, ?, ?, ?)", rows)
    base.execute("insert or replace into facts values ('columns', ?)", (json.dumps(plan.columns),))


def write_result(base: sqlite3.Connection, result: CaseResult, size: int) -> None:
    """Write the result of a case, and the size of its file, unless they are there."""
    readings = result.readings
    row = result.key, size, result.status, result.sentence, readings.get("seconds"), json.dumps(readings)
    known = base.execute("select * from cases where key = ?", (result.key,)).fetchone()
    if known != row:
        base.execute("insert or replace into cases values (?, ?, ?, ?, ?, ?)", row)


def known_cases(base: sqlite3.Connection) -> dict[str, KnownCase]:
    """Finished cases by their keys; raises sqlite3.DatabaseError if a row is damaged."""
    rows = base.execute("select key, size, status, sentence, readings from cases")
    return {
        checked(key, str): KnownCase(
            checked(size, int), checked(status, str), checked(sentence, str), readings_in(readings)
        )
        for key, size, status, sentence, readings in rows
    }


def readings_in(text: object) -> dict[str, float | None]:
    """Readings of a case from a row; raises sqlite3.DatabaseError."""
    found: dict[str, float | None] = from_json(text, dict)
    if not all(map(is_reading, found.values())):
        raise sqlite3.DatabaseError(DATABASE)
    return found


def from_json(text: object, kind: type[T]) -> T:
    """Value of a text in JSON, of this kind; raises sqlite3.DatabaseError."""
    try:
        said: Any = json.loads(checked(text, str))
    except (ValueError, RecursionError) as error:
        raise sqlite3.DatabaseError(DATABASE) from error
    return checked(said, kind)


def checked(value: object, kind: type[T]) -> T:
    """A value of this kind; raises sqlite3.DatabaseError if it is of another."""
    if not isinstance(value, kind):
        raise sqlite3.DatabaseError(DATABASE)
    return value
