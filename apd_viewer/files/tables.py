"""Tables of numbers as comma-separated values."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from apd_viewer.files.storage.atomic_file import replacing

Cell: TypeAlias = float | str | None


def write_table(path: Path, columns: Sequence[str], rows: np.ndarray | Sequence[Sequence[Cell]]) -> None:
    """Write a CSV table atomically; unknown values and NaN are left empty.

    Parameters
    ----------
    path : Path
    columns : sequence of str
        Names, for the first line.
    rows : (r, c) float array, or sequence of rows that have words too
        Read back, they are the same to the last digit; whole numbers are written as such.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with replacing(path) as scratch, scratch.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows([_written(cell) for cell in row] for row in rows)


def _written(cell: Cell) -> str:
    if isinstance(cell, str):
        return cell
    if cell is None or cell != cell:
        return ""
    value = float(cell)
    return str(int(value)) if value.is_integer() and abs(value) < 2**53 else repr(value)
