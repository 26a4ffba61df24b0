"""Rows of the database of a study, written and read.

Read, they are checked, as anybody may have written them.
"""

from __future__ import annotations

import json
import sqlite3
from typing import Any, NamedTuple, TypeVar

from apd_viewer.cases.case_file import CaseResult, is_reading
from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.cases.plan import Plan

T = TypeVar("T")


class CaseRow(NamedTuple):
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


def write_plan(connection: sqlite3.Connection, plan: Plan) -> None:
    """Write a plan in place of the one before."""
    rows = (
        (k, row.line, row.case and row.case.key, row.mistake, row.same_as, json.dumps(row.cells))
        for k, row in enumerate(plan.rows)
    )
    connection.execute("delete from plan")
    connection.executemany("insert into plan values (?, ?, ?, ?, ?, ?)", rows)
    connection.execute("insert or replace into facts values ('columns', ?)", (json.dumps(plan.columns),))


def write_result(connection: sqlite3.Connection, result: CaseResult, size: int) -> None:
    """Write the result of a case, and the size of its file, unless they are there."""
    readings = result.readings
    row = result.key, size, result.status, result.sentence, readings.get("seconds"), json.dumps(readings)
    known = connection.execute("select * from cases where key = ?", (result.key,)).fetchone()
    if known != row:
        connection.execute("insert or replace into cases values (?, ?, ?, ?, ?, ?)", row)


def case_rows(connection: sqlite3.Connection) -> dict[str, CaseRow]:
    """Finished cases by their keys; raises sqlite3.DatabaseError if a row is damaged."""
    rows = connection.execute("select key, size, status, sentence, readings from cases")
    return {
        checked_value(key, str): CaseRow(
            checked_value(size, int),
            checked_value(status, str),
            checked_value(sentence, str),
            readings_from_json(readings),
        )
        for key, size, status, sentence, readings in rows
    }


def readings_from_json(text: object) -> dict[str, float | None]:
    """Readings of a case from a row; raises sqlite3.DatabaseError."""
    found: dict[str, float | None] = value_from_json(text, dict)
    if not all(map(is_reading, found.values())):
        raise sqlite3.DatabaseError(DATABASE_NAME)
    return found


def value_from_json(text: object, kind: type[T]) -> T:
    """Value of a text in JSON, of this kind; raises sqlite3.DatabaseError."""
    try:
        said: Any = json.loads(checked_value(text, str))
    except (ValueError, RecursionError) as error:
        raise sqlite3.DatabaseError(DATABASE_NAME) from error
    return checked_value(said, kind)


def checked_value(value: object, kind: type[T]) -> T:
    """A value of this kind; raises sqlite3.DatabaseError if it is of another."""
    if not isinstance(value, kind):
        raise sqlite3.DatabaseError(DATABASE_NAME)
    return value
