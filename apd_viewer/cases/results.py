"""Results of a study as a table, readable during a run; CSV and Parquet output."""

import sqlite3
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from apd_viewer.cases import database
from apd_viewer.cases.case_file import DONE, FAILED, Curves
from apd_viewer.cases.plan_columns import SEED_COLUMN
from apd_viewer.cases.run_case import FINAL_READINGS
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.tables import Cell, write_table
from apd_viewer.language import tr

WAITING, WRONG, DUPLICATE = "waiting", "wrong", "duplicate"
_STATES = DONE, FAILED, WAITING, WRONG, DUPLICATE
# Columns after those of the plan; external scripts may rely on their names and order.
PROMISED_READINGS = ("area_error", "volume", "volume_capped", "energy", "crossings", "seconds")
READINGS = (*PROMISED_READINGS, *FINAL_READINGS)
STATUS_COLUMNS = ("status", "sentence")
KEY_COLUMNS = ("line", "key")
# Least relative energy difference of competing folds, and largest energy taken for zero.
_COMPETING, _NO_ENERGY = 0.01, 1e-300


def status_text(status: str) -> str:
    """Displayed word for the status of a row."""
    words = {
        DONE: tr("done"),
        FAILED: tr("failed"),
        WAITING: tr("not done yet"),
        WRONG: tr("wrong"),
        DUPLICATE: tr("duplicate"),
    }
    return words[status]


@dataclass(frozen=True)
class ResultRow:
    """A plan row with its result.

    Attributes
    ----------
    line : int
        Of the plan's file, from 1.
    key : str
        Key of its result; empty for an invalid row.
    cells : tuple of str
        In the order of the plan's columns.
    status : str
        "done", "failed", "waiting", "wrong" (no case can be made of the row) or "duplicate".
    readings : dict
        Numbers by name; empty unless it is done.
    """

    line: int
    key: str
    cells: tuple[str, ...]
    status: str
    sentence: str
    readings: dict[str, float | None]


@dataclass(frozen=True)
class ResultTable:
    """All rows of a study with their results, in the order of its plan.

    Attributes
    ----------
    columns : tuple of str
        Of the plan.
    """

    columns: tuple[str, ...]
    rows: tuple[ResultRow, ...]

    @property
    def smallest_line(self) -> int | None:
        """Plan line of the smallest volume, of several without self-intersections."""
        volumes = []
        for row in self.rows:
            found = row.readings.get("volume") or row.readings.get("volume_capped")
            if found and not row.readings.get("crossings"):  # where walls cross, the volume is wrong
                volumes.append((abs(found), row.line))
        return min(volumes)[1] if len({volume for volume, _ in volumes}) > 1 else None

    @property
    def competing_folds(self) -> dict[tuple[int, ...], float]:
        """Plan lines of cases with energies differing by over 1 % between seeds.

        The value is the largest energy relative to the smallest, less 1.
        """
        if SEED_COLUMN not in self.columns:
            return {}
        place = self.columns.index(SEED_COLUMN)
        alike: dict[tuple[str, ...], list[tuple[int, float]]] = {}
        for row in self.rows:
            energy = row.readings.get("energy")
            if energy is not None:
                others = row.cells[:place] + row.cells[place + 1 :]
                alike.setdefault(others, []).append((row.line, energy))
        spreads = {}
        for cases in alike.values():
            lines, energies = zip(*cases, strict=True)
            if max(energies) > (1.0 + _COMPETING) * min(energies):
                spreads[lines] = max(energies) / max(min(energies), _NO_ENERGY) - 1.0
        return spreads


def read_results(folder: Path) -> ResultTable:
    """Read the results so far; raises InputError without a study."""
    with database.reading_database(folder) as base:
        found = _found(base)
    # The table is built after the database is closed, because open reads block its writer.
    try:
        return _table(*found)
    except sqlite3.DatabaseError as error:
        raise database.read_error(folder, error) from error


def read_result_table(connection: sqlite3.Connection) -> ResultTable:
    """Results in an open database; raises one of DATABASE_ERRORS."""
    return _table(*_found(connection))


def _found(connection: sqlite3.Connection) -> tuple[Any, list[Any]]:
    columns = connection.execute("select value from facts where name = 'columns'").fetchone()
    rows = connection.execute(
        "select line, plan.key, cells, mistake, same_as, status, sentence, readings"
        " from plan left join cases on plan.key = cases.key order by position"
    )
    return columns, rows.fetchall()


def _table(columns: Any, rows: list[Any]) -> ResultTable:
    names = (
        tuple(database.checked_value(name, str) for name in database.value_from_json(columns[0], list))
        if columns
        else ()
    )
    found = tuple(_row(*row) for row in rows)
    if any(len(row.cells) != len(names) for row in found):
        raise sqlite3.DatabaseError(database.DATABASE_NAME)
    return ResultTable(names, found)


def _row(
    line: int,
    key: str | None,
    cells: str,
    mistake: str,
    same_as: int | None,
    status: str | None,
    sentence: str | None,
    readings: str | None,
) -> ResultRow:
    if key is None:
        status, sentence = WRONG, mistake
    elif not database.checked_value(key, str).isalnum():  # the key becomes a file name
        raise sqlite3.DatabaseError(database.DATABASE_NAME)
    elif same_as is not None:
        status, sentence = DUPLICATE, mistake
    found = database.readings_from_json(readings) if readings is not None else {}
    said = tuple(database.checked_value(cell, str) for cell in database.value_from_json(cells, list))
    if (status or WAITING) not in _STATES:
        raise sqlite3.DatabaseError(database.DATABASE_NAME)
    return ResultRow(
        database.checked_value(line, int),
        key or "",
        said,
        status or WAITING,
        database.checked_value(sentence or "", str),
        found,
    )


def write_results(folder: Path, table: ResultTable) -> None:
    """Write ``results.csv``, and ``results.parquet`` if possible; raises InputError."""
    columns = [*table.columns, *STATUS_COLUMNS, *READINGS, *KEY_COLUMNS]
    rows = [_cells(row) for row in table.rows]
    write_table(folder / "results.csv", columns, rows)
    _write_parquet(folder, columns, rows, len(table.columns))


def write_curves(folder: Path, table: ResultTable, known: Mapping[str, Curves]) -> None:
    """Write ``curves.csv``, one row per step of each case with known curves.

    Raises InputError where it cannot be written.
    """
    rows: list[list[Cell]] = []
    names: list[str] = []
    for row in table.rows:
        if row.status != DONE or row.key not in known:
            continue
        curves = known[row.key]
        names = names or list(curves)
        rows += [[row.line, step, *values] for step, values in enumerate(zip(*curves.values(), strict=True))]
    write_table(folder / "curves.csv", ["line", "step", *names], rows)


def _cells(row: ResultRow) -> list[Cell]:
    numbers: list[Cell] = [row.readings.get(name) for name in READINGS]
    return [*row.cells, row.status, row.sentence, *numbers, row.line, row.key]


def _write_parquet(folder: Path, columns: list[str], rows: list[list[Cell]], plan: int) -> None:
    try:
        # Imported here: pyarrow is an optional dependency and slow to import.
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return
    words = {*range(plan + len(STATUS_COLUMNS)), len(columns) - 1}
    arrays = [
        pyarrow.array(
            [row[k] for row in rows] if k in words else [_number(row[k]) for row in rows],
            pyarrow.string() if k in words else pyarrow.float64(),
        )
        for k in range(len(columns))
    ]
    # Column names must be unique: a plan column is renamed if a result has its name.
    asked = [f"plan_{name}" if name in columns[plan:] else name for name in columns[:plan]]
    with replacing_file(folder / "results.parquet") as scratch:
        parquet.write_table(pyarrow.table(arrays, [*asked, *columns[plan:]]), scratch)


def _number(cell: Cell) -> float | None:
    return None if cell is None else float(cell)
