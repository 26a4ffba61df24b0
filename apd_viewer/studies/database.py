"""The database of a study: its plan, and the readings of its cases."""

from __future__ import annotations

import sqlite3
from contextlib import closing, suppress
from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from pathlib import Path

DATABASE = "study.sqlite"
_PATIENCE = 10.0  # s that a reader or the writer waits for the other
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
    """The database for its one writer, a new one in place of a damaged one."""
    path, base = folder / DATABASE, None
    try:
        base = _connected(path)
        base.execute("select count(*), max(size) from cases").fetchone()
        return base
    except sqlite3.DatabaseError:
        if base is not None:
            base.close()
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
    return closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=_PATIENCE))
