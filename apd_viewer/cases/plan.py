"""Plans of studies: tables with a case a row, checked line by line."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from apd_viewer.cases.input_files import InputFiles
from apd_viewer.cases.plan_columns import COLUMNS, NOTE_PREFIX
from apd_viewer.cases.plan_row import parse_case
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.files.tables import cell_text
from apd_viewer.language import tr

MOST_ROWS = 1_000_000
_SEPARATORS = ",;\t"


@dataclass(frozen=True)
class PlanRow:
    """A row of a plan.

    Attributes
    ----------
    line : int
        Of the file, from 1.
    cells : tuple of str
        In the order of the columns.
    case : StudyCase or None
        None where it is wrong.
    mistake : str
        What is wrong with it, a sentence; empty if nothing is.
    same_as : int or None
        Line of an earlier row that asks for the same.
    """

    line: int
    cells: tuple[str, ...]
    case: StudyCase | None = None
    mistake: str = ""
    same_as: int | None = None


@dataclass(frozen=True)
class Plan:
    """Rows of a plan, in the order of the file.

    Attributes
    ----------
    columns : tuple of str
    rows : tuple of PlanRow
    """

    columns: tuple[str, ...]
    rows: tuple[PlanRow, ...]

    @property
    def cases(self) -> dict[str, StudyCase]:
        """Different cases by their keys, in the order of their first rows."""
        found: dict[str, StudyCase] = {}
        for row in self.rows:
            if row.case is not None and row.same_as is None:
                found[row.case.key] = row.case
        return found


def read_plan(path: Path, sources: InputFiles) -> Plan:
    """Read a plan and check every row.

    Parameters
    ----------
    path : Path
        A table with commas, semicolons or tabs; names of files in it are relative to its folder.
    sources : InputFiles
        For the files that it names.

    Raises
    ------
    InputError
        If it is no such table: a sentence names the column that is wrong. What is wrong with a row is
        written into the row.
    """
    content = read_content(path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(
            tr("{name} is not a text in UTF-8; save it as CSV UTF-8.").format(name=path.name)
        ) from None
    lines = _lines(text, path)
    columns = _columns(next(lines, (1, ()))[1], path)
    rows: list[PlanRow] = []
    seen: dict[str, int] = {}
    for line, cells in lines:
        row = _checked(line, cells, columns, path.absolute().parent, sources)
        if row.case is not None:
            first = seen.setdefault(row.case.key, line)
            if first != line:
                sentence = tr("It asks for the same as line {line}.").format(line=first)
                row = PlanRow(line, row.cells, row.case, sentence, first)
        rows.append(row)
    if not rows:
        raise InputError(tr("{name} has no rows; add a case.").format(name=path.name))
    return Plan(columns, tuple(rows))


def _lines(text: str, path: Path) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Line number and cells of each row, without empty ones."""
    head = text.partition("\n")[0]
    separator = max(_SEPARATORS, key=head.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    before, count = 0, 0
    try:
        for cells in reader:
            line, before = before + 1, reader.line_num
            if any(cell.strip() for cell in cells):
                count += 1
                if count > MOST_ROWS:
                    raise InputError(
                        tr("{name} has more than {most:,} rows; divide it.").format(
                            name=path.name, most=MOST_ROWS
                        )
                    )
                yield line, tuple(cell_text(cell.strip()) for cell in cells)
    except csv.Error as error:
        raise InputError(
            tr("{name} is no table: line {line} cannot be read ({reason}).").format(
                name=path.name, line=reader.line_num, reason=error
            )
        ) from error


def _columns(cells: Sequence[str], path: Path) -> tuple[str, ...]:
    """Names of the columns; raises InputError for unknown ones."""
    names = list(cells)
    while names and not names[-1]:
        names.pop()  # spreadsheets leave empty columns at the end
    where = {"name": path.name}
    for column in names:
        if not column.startswith(NOTE_PREFIX) and column not in COLUMNS:
            raise InputError(
                tr("{name} has an unknown column “{column}”; use {known}, or # before a note.").format(
                    column=column[:40], known=", ".join(COLUMNS), **where
                )
            )
    twice = [column for column, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(
            tr("{name} has the column “{column}” twice; rename one.").format(column=twice[0], **where)
        )
    if not {"mesh", "session"} & set(names):
        raise InputError(
            tr("{name} has neither a column “mesh” nor a column “session”; add one.").format(**where)
        )
    return tuple(names)


def _checked(
    line: int, cells: tuple[str, ...], columns: tuple[str, ...], folder: Path, sources: InputFiles
) -> PlanRow:
    """A row with its case, or with its mistake."""
    whole = (*cells, *[""] * (len(columns) - len(cells)))[: len(columns)]
    try:
        if any(cells[len(columns) :]):
            raise InputError(
                tr(
                    "It has {cells} cells in {columns} columns; put text with commas in quotation marks."
                ).format(cells=len(cells), columns=len(columns))
            )
        said = {
            name: cell for name, cell in zip(columns, whole, strict=True) if cell and name[0] != NOTE_PREFIX
        }
        return PlanRow(line, whole, parse_case(said, folder, sources))
    except InputError as error:
        return PlanRow(line, whole, None, str(error))
