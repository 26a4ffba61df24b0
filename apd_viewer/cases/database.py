"""Database of a study: its plan and the readings of its cases.

A damaged database is rebuilt from the files of the cases; all content is therefore validated on reading.
"""

import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple, TypeVar
from urllib.parse import quote

from apd_viewer.cases.case_file import CaseResult, is_reading
from apd_viewer.cases.plan import Plan
from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import NotRegularFileError, check_regular_file
from apd_viewer.language import tr

DATABASE_NAME = "study.sqlite"
_BESIDE = "-journal", "-wal", "-shm"  # suffixes of SQLite's side files
_PATIENCE = 60.0  # seconds that readers and the writer wait for each other
_TABLES = """
begin;
create table if not exists facts (name text primary key, value text not null);
create table if not exists plan (
    position integer primary key, line integer not null, key text, mistake text not null, same_as integer,
    cells text not null
);
create table if not exists cases (
    key text primary key, size integer not null, status text not null, sentence text not null,
    seconds real, readings text not null
);
commit;
"""
# SQLite's message about a damaged database may quote bytes that are not valid text.
DATABASE_ERRORS = sqlite3.DatabaseError, UnicodeDecodeError
# Messages of errors that do not indicate damage.
_FOR_NOW = "locked", "is full", "unable to open", "disk I/O"
T = TypeVar("T")


def open_database(folder: Path) -> sqlite3.Connection:
    """Open the database for its single writer; raises InputError.

    A damaged database is renamed and replaced by a new one.
    """
    path = folder / DATABASE_NAME
    _check_side_files(path)
    if not path.exists() or path.is_file():
        try:
            return _connect(path)
        except DATABASE_ERRORS as error:
            if not is_damage(error, folder):
                raise write_error(folder, error) from error
    rename_damaged(folder)
    try:
        return _connect(path)
    except DATABASE_ERRORS as error:
        raise write_error(folder, error) from error


def _check_side_files(path: Path) -> None:
    """Raise InputError if a side file of the database is not a regular file."""
    for ending in _BESIDE:
        part = path.with_name(f"{path.name}{ending}")
        try:
            check_regular_file(part)
        except NotRegularFileError as error:
            raise InputError(
                tr("{path} is a folder, a pipe or a device; remove it.").format(path=part)
            ) from error
        except OSError:  # the file is missing, or SQLite will report the error
            continue


def _connect(path: Path) -> sqlite3.Connection:
    base = sqlite3.connect(path, timeout=_PATIENCE)
    base.text_factory = _decode
    try:
        # No write-ahead log: it fails on network file systems, where other machines may read.
        base.executescript(f"pragma journal_mode = delete; pragma synchronous = normal; {_TABLES}")
        _check_tables(base)
        if base.execute("pragma integrity_check(1)").fetchone() != ("ok",):
            raise sqlite3.DatabaseError(DATABASE_NAME)
    except BaseException:
        base.close()
        raise
    return base


def _decode(text: bytes) -> str:
    return text.decode(errors="replace")


def _check_tables(connection: sqlite3.Connection) -> None:
    """Raise sqlite3.DatabaseError unless the schema is exactly the expected one."""
    with closing(sqlite3.connect(":memory:")) as new:
        new.executescript(_TABLES)
        said = "select type, name, sql from sqlite_master order by name"
        if connection.execute(said).fetchall() != new.execute(said).fetchall():
            raise sqlite3.DatabaseError(DATABASE_NAME)


def is_damage(error: Exception, folder: Path) -> bool:
    """True if an error means damage, not a locked database, a full disk or the like."""
    said = str(error)
    if "readonly" in said:  # SQLite also reports this for a moved database
        return os.access(folder, os.W_OK) and (
            not (folder / DATABASE_NAME).exists() or os.access(folder / DATABASE_NAME, os.W_OK)
        )
    return not any(word in said for word in _FOR_NOW)


def rename_damaged(folder: Path) -> None:
    """Rename the damaged database of a study, keeping it for inspection."""
    path = folder / DATABASE_NAME
    for each in (path, path.with_name(f"{path.name}-journal")):
        with suppress(OSError):
            each.replace(each.with_name(f"{each.name}.damaged"))


def write_error(folder: Path, error: Exception) -> InputError:
    """Error for a failed write to the database."""
    return InputError(
        tr("{path} cannot be opened now ({reason}); try again.").format(
            path=folder / DATABASE_NAME, reason=error
        )
    )


def read_error(folder: Path, error: Exception) -> InputError:
    """Error for a failed read of the results."""
    if is_damage(error, folder):
        return InputError(
            tr("The results in {folder} are damaged; run the study again.").format(folder=folder)
        )
    return InputError(
        tr("The results in {folder} cannot be read now ({reason}); try again.").format(
            folder=folder, reason=error
        )
    )


@contextmanager
def reading_database(folder: Path) -> Iterator[sqlite3.Connection]:
    """Open the database of a study read-only, even during a run.

    Raises
    ------
    InputError
        If there is none, or it cannot be read.
    """
    path = folder / DATABASE_NAME
    if not path.is_file():
        raise InputError(tr("{folder} contains no study; choose a study folder.").format(folder=folder))
    _check_side_files(path)
    # A URI without a host: SQLite rejects the URI of a file on another computer.
    place = quote(path.absolute().as_posix())
    place = place if place.startswith("/") else f"/{place}"
    try:
        with closing(sqlite3.connect(f"file://{place}?mode=ro", uri=True, timeout=_PATIENCE)) as base:
            base.text_factory = _decode
            _check_tables(base)
            yield base
    except DATABASE_ERRORS as error:
        raise read_error(folder, error) from error


class DatabaseRow(NamedTuple):
    """Database record of a finished case.

    Attributes
    ----------
    size : int
        Of its file, in bytes.
    """

    size: int
    status: str
    sentence: str
    readings: dict[str, float | None]


def write_plan(connection: sqlite3.Connection, plan: Plan) -> None:
    """Store a plan in the database, replacing the previous one."""
    rows = (
        (k, row.line, row.case and row.case.key, row.mistake, row.same_as, json.dumps(row.cells))
        for k, row in enumerate(plan.rows)
    )
    connection.execute("delete from plan")
    connection.executemany("insert into plan values (?, ?, ?, ?, ?, ?)", rows)
    connection.execute("insert or replace into facts values ('columns', ?)", (json.dumps(plan.columns),))


def write_result(connection: sqlite3.Connection, result: CaseResult, size: int) -> None:
    """Record the result of a case and its file size, if changed."""
    readings = result.readings
    row = result.key, size, result.status, result.sentence, readings.get("seconds"), json.dumps(readings)
    known = connection.execute("select * from cases where key = ?", (result.key,)).fetchone()
    if known != row:
        connection.execute("insert or replace into cases values (?, ?, ?, ?, ?, ?)", row)


def case_rows(connection: sqlite3.Connection) -> dict[str, DatabaseRow]:
    """Records of finished cases by key; raises sqlite3.DatabaseError if damaged."""
    rows = connection.execute("select key, size, status, sentence, readings from cases")
    return {
        checked_value(key, str): DatabaseRow(
            checked_value(size, int),
            checked_value(status, str),
            checked_value(sentence, str),
            readings_from_json(readings),
        )
        for key, size, status, sentence, readings in rows
    }


def readings_from_json(text: object) -> dict[str, float | None]:
    """Readings of a case from JSON text; raises sqlite3.DatabaseError."""
    found: dict[str, float | None] = value_from_json(text, dict)
    if not all(map(is_reading, found.values())):
        raise sqlite3.DatabaseError(DATABASE_NAME)
    return found


def value_from_json(text: object, kind: type[T]) -> T:
    """Value of type ``kind`` from JSON text; raises sqlite3.DatabaseError."""
    try:
        said: Any = json.loads(checked_value(text, str))
    except (ValueError, RecursionError) as error:
        raise sqlite3.DatabaseError(DATABASE_NAME) from error
    return checked_value(said, kind)


def checked_value(value: object, kind: type[T]) -> T:
    """The value if it has type ``kind``; raises sqlite3.DatabaseError otherwise."""
    if not isinstance(value, kind):
        raise sqlite3.DatabaseError(DATABASE_NAME)
    return value
