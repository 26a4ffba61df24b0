"""The database of a study: its plan, and the readings of its cases."""

from __future__ import annotations

import sqlite3
from contextlib import closing, suppress
from typing import TYPE_CHECKING
from urllib.parse import quote

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from pathlib import Path

DATABASE = "study.sqlite"
_PATIENCE = 60.0  # s that a reader or the writer waits for the other
_TABLES = """
create table if not exists facts (name text primary key, value text not null);
create table if not exists plan (
    position integer primary key, line integer not null, key text, mistake text not null, same_as integer,
    cells text not null
);
create table if not exists cases (
    key text primary key, size integer not null, status text not null, sentence text not null,
    seconds real, readings text not null
);
"""


def opened_database(folder: Path) -> sqlite3.Connection:
    """The database for its one writer; raises InputError.

    A damaged one is put aside, and a new one takes its place.
    """
    path, base = folder / DATABASE, None
    try:
        base = _connected(path)
        base.execute("select count(*), max(size) from cases").fetchone()
        return base
    except sqlite3.DatabaseError as error:
        if base is not None:
            base.close()
        if isinstance(error, sqlite3.OperationalError) and not str(error).startswith("no such"):
            # Locked, or the disk is full: nothing is wrong with it.
            raise InputError(
                tr("{path} cannot be opened now ({reason}); try again.").format(path=path, reason=error)
            ) from error
        for each in (path, path.with_name(f"{path.name}-journal")):
            with suppress(OSError):
                each.replace(each.with_name(f"{each.name}.damaged"))
        return _connected(path)


def _connected(path: Path) -> sqlite3.Connection:
    base = sqlite3.connect(path, timeout=_PATIENCE)
    try:
        # Not the write-ahead log: it does not work over a network, where others read.
        base.executescript(f"pragma journal_mode = delete; pragma synchronous = normal; {_TABLES}")
    except BaseException:
        base.close()
        raise
    return base


def unreadable(folder: Path, error: sqlite3.DatabaseError) -> InputError:
    """Sentence on results and the error of reading them."""
    return InputError(
        tr("The results in {folder} cannot be read now ({reason}); try again.").format(
            folder=folder, reason=error
        )
    )


def reading(folder: Path) -> closing[sqlite3.Connection]:
    """The database of a study, for reading only, also while it runs.

    Raises
    ------
    InputError
        If there is none.
    """
    path = folder / DATABASE
    if not path.is_file():
        raise InputError(tr("{folder} holds no study; choose the folder of one.").format(folder=folder))
    # As a path alone: SQLite refuses the URI of a file on another computer.
    place = quote(path.absolute().as_posix())
    place = place if place.startswith("/") else f"/{place}"
    return closing(sqlite3.connect(f"file://{place}?mode=ro", uri=True, timeout=_PATIENCE))
