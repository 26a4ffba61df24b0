"""Study plans: tables with one case per row, validated cell by cell."""

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from apd_viewer.cases import plan_columns
from apd_viewer.cases.study_case import CaseSetting, InputFiles, StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import STANDARD_INPUT, read_content, read_standard_input
from apd_viewer.files.tables import unescaped_cell
from apd_viewer.geometry.solver.contact_descent import needs_contact
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, MOST_VERTICES_IN_CONTACT
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.posing.motion_text import ANY_LENGTHS, parse_motion
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import NoUnitError, Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target

T = TypeVar("T")

DEFAULT_STEPS = 10
_READERS: dict[str, Callable[[str], CaseSetting]] = {
    "unit": plan_columns.parse_unit,
    "steps": plan_columns.parse_steps,
    **{name: column.parse for name, column in plan_columns.SETTING_COLUMNS.items()},
}
# Default settings of a mesh are left out, so that plans with and without them give equal keys. Contact is
# always stored: plans without the column and new documents have different defaults.
_USUAL = asdict(DEFAULT_SETTINGS)
_OLD = {"contact": False}
# Placeholder for the unit of a session, which is read later; any unit makes the same cells valid.
_SOME = Unit.MILLIMETRE
MOST_ROWS = 1_000_000
_SEPARATORS = ",;\t"


def parse_case(cells: Mapping[str, str], folder: Path, sources: InputFiles) -> StudyCase:
    """Case of a plan row; raises InputError.

    Parameters
    ----------
    cells : mapping of str to str
        Cells that are not empty, by their columns.
    folder : Path
        Folder of the files named in the cells.
    """
    settings = _settings(cells)
    unit = str(parse_cell("unit", cells["unit"])) if "unit" in cells else ""
    steps = int(parse_cell("steps", cells["steps"])) if "steps" in cells else DEFAULT_STEPS
    name = cells.get("mesh") or cells.get("session")
    if not name or ("mesh" in cells and "session" in cells):
        raise InputError(tr("Give either a mesh or a session."))
    whole = name.lower().endswith(SESSION_SUFFIX)
    if "session" in cells and not whole:
        raise InputError(tr("“{name}” is not a session (.apd); give it as the mesh.").format(name=name))
    if whole == ("selection" in cells):
        raise InputError(
            tr("A session has its own paint; leave “selection” empty.")
            if whole
            else tr("A mesh needs a selection of base and handle; fill in “selection”.")
        )
    if whole and unit:
        raise InputError(tr("A session has its own unit; leave “unit” empty."))
    if not whole and "motion" not in cells:
        raise InputError(tr("Nothing moves; fill in “motion”, such as twist 120deg."))
    typed = _SOME if whole else Unit(unit)
    motion = _parse("motion", lambda text: _motion(text, typed), cells["motion"]) if "motion" in cells else ()
    for column in plan_columns.LENGTH_COLUMNS & cells.keys():
        _parse(column, lambda text: _length(text, typed), cells[column])
    if isinstance(volume := settings.get("volume"), str):
        _parse("volume", lambda text: parse_volume_target(text, typed), volume)
    if "pressure" in settings and not whole:
        _check_pressure(settings)
    mesh = sources.mesh(folder / name)
    if not whole:
        own = {name: value for name, value in settings.items() if name in _OLD or value != _USUAL.get(name)}
        settings = _OLD | own
    elif settings.get("contact") == MOST_VERTICES_IN_CONTACT:
        del settings["contact"]  # the session has its own contact setting
    selection = None if whole else sources.selection(folder / cells["selection"])
    return StudyCase(mesh, selection, motion, unit, steps, tuple(settings.items()))


def parse_cell(name: str, text: str) -> CaseSetting:
    """Value of a single cell; raises InputError."""
    return _parse(name, _READERS.get(name, str), text)


def _settings(cells: Mapping[str, str]) -> dict[str, CaseSetting]:
    found = {name: parse_cell(name, cells[name]) for name in plan_columns.SETTING_COLUMNS if name in cells}
    method = str(found.get("method", DEFAULT_METHOD))
    if found.get("contact") is True and not METHODS[method].may_use_contact:
        raise InputError(tr("“{method}” cannot use contact; choose another method.").format(method=method))
    for name in ("thickness", "yield_radius", "gas"):
        if name in found and not found.get("contact", "session" in cells):
            raise InputError(tr("“{name}” is for walls in contact; set “contact” to yes.").format(name=name))
    resists_bending = METHODS[method].is_wall or found.get("stiffness", "session" in cells)
    if "yield_radius" in found and not resists_bending:
        raise InputError(tr("Walls without bending stiffness keep no creases; enter a stiffness, too."))
    return found


def _check_pressure(settings: Mapping[str, Any]) -> None:
    """Raise InputError unless a mesh with these settings can have their pressure."""
    if plan_columns.YOUNG_COLUMN not in settings:
        raise InputError(tr("A pressure needs Young's modulus of the wall; fill in “young”."))
    method, contact = METHODS[settings.get("method", DEFAULT_METHOD)], bool(settings.get("contact"))
    needs_contact(method, contact, None, *map(settings.get, ("gas", "pressure", "volume")))


@lru_cache(maxsize=4096)
def _motion(text: str, unit: Unit) -> tuple[str, ...]:
    steps = parse_motion(text)
    for step in steps:
        step.parse_amounts(unit)
    return tuple(step.text for step in steps)


def _length(text: str, unit: Unit) -> float:
    value = parse_length(text, unit, ANY_LENGTHS)
    if not value > 0.0:
        raise InputError(tr("A distance must be greater than 0; enter another one."))
    return value


def _parse(name: str, read: Callable[[str], T], text: str) -> T:
    """Parsed value of a cell; raises InputError naming its column."""
    try:
        return read(text)
    except NoUnitError as error:
        raise InputError(
            tr("Column “{name}”: The unit of the mesh is not set; fill in “unit” for {word}.").format(
                name=name, word=error.word
            )
        ) from error
    except InputError as error:
        raise InputError(tr("Column “{name}”: {sentence}").format(name=name, sentence=error)) from error


@dataclass(frozen=True)
class PlanRow:
    """A row of a study plan: a case, or an error message.

    Attributes
    ----------
    line : int
        Of the file, from 1.
    cells : tuple of str
        In the order of the columns.
    case : StudyCase or None
        Valid case, or None.
    mistake : str
        Sentence on the error in the row; empty if it is valid.
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
    """Rows of a plan, in the order of the file."""

    columns: tuple[str, ...]
    rows: tuple[PlanRow, ...]

    @property
    def cases(self) -> dict[str, StudyCase]:
        """Distinct cases by key, in the order of their first rows."""
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
        A table with commas, semicolons or tabs, ``-`` for the standard input; names of files in it are
        relative to its folder.
    sources : InputFiles
        Copies of the files named in the plan.

    Raises
    ------
    InputError
        If it is no such table: a sentence names the column that is wrong. What is wrong with a row is
        written into the row.
    """
    content = read_standard_input() if path == STANDARD_INPUT else read_content(path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(
            tr("{name} is not UTF-8 text; save it as CSV UTF-8.").format(name=path.name)
        ) from None
    lines = _lines(text, path)
    columns = _columns(next(lines, (1, ()))[1], path)
    rows: list[PlanRow] = []
    seen: dict[str, int] = {}
    for line, cells in lines:
        row = _checked_row(line, cells, columns, path.absolute().parent, sources)
        if row.case is not None:
            first = seen.setdefault(row.case.key, line)
            if first != line:
                sentence = tr("It repeats line {line}.").format(line=first)
                row = PlanRow(line, row.cells, row.case, sentence, first)
        rows.append(row)
    if not rows:
        raise InputError(tr("{name} has no rows; add a case.").format(name=path.name))
    return Plan(columns, tuple(rows))


def _lines(text: str, path: Path) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Line number and cells of each non-empty row."""
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
                        tr("{name} has more than {most:,} rows; split it.").format(
                            name=path.name, most=MOST_ROWS
                        )
                    )
                yield line, tuple(unescaped_cell(cell.strip()) for cell in cells)
    except csv.Error as error:
        raise InputError(
            tr("{name} is not a table: line {line} cannot be read ({reason}).").format(
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
        if not column.startswith(plan_columns.NOTE_PREFIX) and column not in plan_columns.COLUMNS:
            raise InputError(
                tr("{name} has an unknown column “{column}”; use {known}, or # before a note.").format(
                    column=column[:40], known=", ".join(plan_columns.COLUMNS), **where
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


def _checked_row(
    line: int, cells: tuple[str, ...], columns: tuple[str, ...], folder: Path, sources: InputFiles
) -> PlanRow:
    """Row with its case, or with an error message."""
    whole = (*cells, *[""] * (len(columns) - len(cells)))[: len(columns)]
    try:
        if any(cells[len(columns) :]):
            raise InputError(
                tr(
                    "It has {cells} cells in {columns} columns; put text with commas in quotation marks."
                ).format(cells=len(cells), columns=len(columns))
            )
        said = {
            name: cell
            for name, cell in zip(columns, whole, strict=True)
            if cell and name[0] != plan_columns.NOTE_PREFIX
        }
        return PlanRow(line, whole, parse_case(said, folder, sources))
    except InputError as error:
        return PlanRow(line, whole, None, str(error))
