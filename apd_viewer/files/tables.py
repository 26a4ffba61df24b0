"""Tables of numbers as comma-separated values."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from apd_viewer.files.replacing import replacing


def write_table(
    path: Path, columns: Sequence[str], rows: np.ndarray | Sequence[Sequence[float | str]]
) -> None:
    """Write a table, whole or not at all; what is not a number is left empty.

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
        lines = rows.tolist() if isinstance(rows, np.ndarray) else rows
        writer.writerows([_written(x) for x in row] for row in lines)


def _written(x: float | str) -> str:
    if isinstance(x, str):
        return x
    if x != x:
        return ""
    return str(int(x)) if x.is_integer() and abs(x) < 2**53 else repr(x)
