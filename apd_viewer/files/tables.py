"""Tables of numbers as comma-separated values."""

import csv
import io
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO, TypeAlias

import numpy as np

from apd_viewer.files.storage.atomic_file import replacing_file

Cell: TypeAlias = float | str | None
_STANDARD_OUTPUT = Path("-")

# Start of a spreadsheet formula; Japanese spreadsheets also accept full-width signs.
_FORMULA = "(?=[ ']*[=+\\-@\uff1d\uff0b\uff0d\uff20])"
# Start of a cell, also for spreadsheets with another separator.
_START = r"(?<![^;\t\r\n])"
_BLANK = r"(?=[ ']*[\t\r\n])"
_UNGUARDED = re.compile(f"{_START}{_FORMULA}|^{_BLANK}")
_GUARDED = re.compile(f"{_START}'{_FORMULA}|^'{_BLANK}")
_NUMBER = re.compile(r"[+-]?[\d.,]*\d[\d.,]*([eE][+-]?\d+)?\s?%?")


def write_table(path: Path, columns: Sequence[str], rows: np.ndarray | Sequence[Sequence[Cell]]) -> None:
    """Write a CSV table atomically; unknown values and NaN are left empty.

    Parameters
    ----------
    path : Path
        ``-`` is the standard output.
    columns : sequence of str
        Names, for the first line.
    rows : (r, c) float array, or sequence of rows that have words too
        Read back, they are the same to the last digit; whole numbers are written as such, and words as by
        :func:`escaped_cell`.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path == _STANDARD_OUTPUT:
        table = io.StringIO(newline="")
        _write_rows(table, columns, rows)
        sys.stdout.buffer.write(table.getvalue().encode())
        return
    with replacing_file(path) as scratch, scratch.open("w", newline="", encoding="utf-8") as stream:
        _write_rows(stream, columns, rows)


def _write_rows(stream: TextIO, columns: Sequence[str], rows: np.ndarray | Sequence[Sequence[Cell]]) -> None:
    writer = csv.writer(stream)
    writer.writerow([escaped_cell(column) for column in columns])
    writer.writerows([_written_cell(cell) for cell in row] for row in rows)


def _written_cell(cell: Cell) -> str:
    if isinstance(cell, str):
        return escaped_cell(cell)
    if cell is None or cell != cell:
        return ""
    value = float(cell)
    return str(int(value)) if value.is_integer() and abs(value) < 2**53 else repr(value)


def escaped_cell(text: str) -> str:
    """CSV cell for a string; a spreadsheet formula is guarded with '.

    Numbers are unchanged. :func:`unescaped_cell` restores the text.
    """
    return text if _NUMBER.fullmatch(text) else _UNGUARDED.sub("'", text)


def unescaped_cell(cell: str) -> str:
    """Original string of a cell written by :func:`escaped_cell`."""
    return _GUARDED.sub("", cell)
