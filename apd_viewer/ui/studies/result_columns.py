"""Columns of the results of a study: titles, numbers, texts."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import nlargest
from typing import NamedTuple

import numpy as np

from apd_viewer.cases.case_file import DONE, FAILED
from apd_viewer.cases.plan_columns import COLUMNS, NOTE_PREFIX
from apd_viewer.cases.results import DUPLICATE, READINGS, WAITING, WRONG, ResultTable, status_text
from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_grouped, format_short, format_significant
from apd_viewer.session.posing.motion import Motion
from apd_viewer.session.posing.motion_text import parse_motion

LINE_COLUMN, MOTION_COLUMN, STATUS_COLUMN, REMARK_COLUMN = "line", "motion", "status", "sentence"
_ASKED_FOR = "plan "  # name prefix of a column of the plan
_NOTE = f"{_ASKED_FOR}{NOTE_PREFIX}"
_ORDER = (DONE, FAILED, WRONG, DUPLICATE, WAITING)
_AMOUNT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Z%°]*)\s*")
_MOST_KINDS = 12  # motion columns at most, as more would hide the others
_LONGEST = 20  # number of longest texts to measure, since letters differ in width
# Handle, motion, and index of the amount in the motion.
_Amount = tuple[int, Motion, int]
_DEGREES = {"deg": "°"}


class ReadingTexts(NamedTuple):
    """Title, tooltip and number format of a reading.

    Attributes
    ----------
    percent : bool
        Whether it is a fraction, written in percent.
    """

    title: str
    tip: str
    percent: bool = False
    whole: bool = False


# Titles of the columns of a plan; titles of notes are made from their names.
PLAN_TITLES = {
    "mesh": tr("Mesh"),
    "session": tr("Session"),
    "selection": tr("Selection"),
    "unit": tr("Unit"),
    "to": tr("Fraction of the motion"),
    "steps": tr("Steps"),
    "iterations": tr("Iteration limit"),
    "imperfection": tr("Imperfection"),
    "seed": tr("Seed"),
    "young": tr("Young's modulus"),
    **{name: setting.title for name, setting in SETTINGS.items() if name in COLUMNS},
}
# In the order of the columns; in a narrow table only the first are in sight.
READING_TEXTS = {
    "volume_error": ReadingTexts(
        tr("Volume change"), tr("Change of enclosed volume from rest"), percent=True
    ),
    "area_error": ReadingTexts(tr("Area change"), tr("Change of the total area from rest"), percent=True),
    "local_change": ReadingTexts(tr("Local change"), tr("Largest area change of a triangle"), percent=True),
    "largest_edge_strain": ReadingTexts(
        tr("Edge strain"), tr("Strain of the most stretched (+) or shortened (−) edge"), percent=True
    ),
    "mean_edge_strain": ReadingTexts(
        tr("Mean strain"), tr("Mean absolute strain of the edges, weighted by rest area"), percent=True
    ),
    "energy": ReadingTexts(tr("Energy"), tr("ARAP energy of the deformation")),
    "crossings": ReadingTexts(tr("Self-intersections"), tr("Triangles that pass through others"), whole=True),
    "handle_drift": ReadingTexts(tr("Handle drift"), tr("Largest distance of a handle from its target")),
    "share_reached": ReadingTexts(
        tr("Motion reached"), tr("Fraction of the path that contact allows"), percent=True
    ),
    "least_gap": ReadingTexts(tr("Least gap"), tr("Least gap between walls in contact")),
    "volume": ReadingTexts(tr("Volume"), tr("Enclosed volume, mesh units")),
    "volume_capped": ReadingTexts(tr("Capped volume"), tr("Volume with openings capped, mesh units")),
    "packed_volume": ReadingTexts(tr("Smallest box"), tr("Volume of the smallest box in any orientation")),
    "box_volume": ReadingTexts(tr("Box"), tr("Volume of the box along the axes")),
    "hull_volume": ReadingTexts(tr("Convex hull"), tr("Volume of the convex hull")),
    "area": ReadingTexts(tr("Area"), tr("Total area, mesh units")),
    "area_rest": ReadingTexts(tr("Area at rest"), tr("Total area, mesh units")),
    "volume_rest": ReadingTexts(tr("Volume at rest"), tr("Enclosed volume, mesh units")),
    "iterations": ReadingTexts(tr("Iterations"), tr("Iterations of all steps"), whole=True),
    "unsettled_steps": ReadingTexts(
        tr("Unsettled steps"), tr("Steps that stopped before they converged"), whole=True
    ),
    "saddle_escapes": ReadingTexts(
        tr("Escaped saddles"), tr("Shapes left because they rested on a saddle of the energy"), whole=True
    ),
    "turned": ReadingTexts(
        tr("Turn requested"), tr("Turn of a handle against the base, degrees, with whole turns")
    ),
    "turned_held": ReadingTexts(
        tr("Turn held"), tr("Turn of the surface between base and handle, degrees, with whole turns")
    ),
    "seconds": ReadingTexts(tr("Time (s)"), tr("Computing time of the case, seconds")),
}


@dataclass(frozen=True, eq=False)
class ResultColumn:
    """Column of the result table: title, values and displayed texts of all cases.

    Attributes
    ----------
    values : (n,) float array
        NaN where there is no number.
    suffix : str
        Behind a number on an axis.
    is_from_plan : bool
        Whether it comes from the plan.
    ranks : (n,) float array or None
        Sort keys of its texts, if not alphabetical.
    """

    name: str
    title: str
    tip: str
    values: np.ndarray
    texts: tuple[str, ...]
    suffix: str = ""
    is_from_plan: bool = False
    ranks: np.ndarray | None = None

    @cached_property
    def is_numeric(self) -> bool:
        """True if the column contains a finite number."""
        return bool(np.isfinite(self.values).any())

    @cached_property
    def sort_keys(self) -> np.ndarray:
        """Sort keys (n,): numbers, ranks or the order of the texts; NaN for gaps."""
        if self.is_numeric:
            return self.values
        if self.ranks is not None:
            return self.ranks
        places = {text: float(k) for k, text in enumerate(sorted(set(self.texts)))}
        return np.array([places[text] for text in self.texts])

    @cached_property
    def longest_texts(self) -> list[str]:
        """Texts with the most characters, as candidates for the widest."""
        return nlargest(_LONGEST, set(self.texts), key=len)

    @property
    def has_differing_texts(self) -> bool:
        """True if the texts of the column differ."""
        return len(set(self.texts)) > 1


class ResultsSnapshot(NamedTuple):
    """Results of a study, with the columns of their table."""

    table: ResultTable
    columns: list[ResultColumn]


def shown_columns(table: ResultTable) -> list[ResultColumn]:
    """Columns of the results table, with sort keys and longest texts precomputed."""
    line, *found = result_columns(table)
    plan_columns = [column for column in found if column.is_from_plan]
    readings = [column for column in found if not column.is_from_plan]
    shown = [line, *plan_columns, _statuses(table), *readings, _sentences(table)]
    for column in shown:
        _ = column.sort_keys, column.longest_texts
    return shown


def result_columns(table: ResultTable) -> list[ResultColumn]:
    """Line number, varying columns of the plan, and all readings with numbers."""
    found = [
        _whole_number_column(
            LINE_COLUMN, tr("Line"), tr("Line of the plan"), [float(row.line) for row in table.rows]
        )
    ]
    for k in sorted(range(len(table.columns)), key=lambda k: table.columns[k] != MOTION_COLUMN):
        cells = [row.cells[k] for row in table.rows]
        found += (
            _motions(cells) if table.columns[k] == MOTION_COLUMN else [_plan_column(table.columns[k], cells)]
        )
    readings = [_reading(table, name) for name in sorted(READINGS, key=_reading_position)]
    plan_columns = [each for each in _without_repeated_notes(found[1:]) if each.has_differing_texts]
    return [found[0], *plan_columns, *(each for each in readings if each.is_numeric)]


def _without_repeated_notes(columns: Sequence[ResultColumn]) -> list[ResultColumn]:
    """Columns without the notes whose numbers repeat another column."""
    notes = [each for each in columns if each.name.startswith(_NOTE)]
    others = [each for each in columns if each not in notes]
    repeated = [
        note for note in notes if any(_have_equal_numbers(note.values, each.values) for each in others)
    ]
    return [each for each in columns if each not in repeated]


def _have_equal_numbers(one: np.ndarray, other: np.ndarray) -> bool:
    """True if both columns have equal numbers, except for gaps."""
    both = np.isfinite(one) & np.isfinite(other)
    return bool(both.any() and (one[both] == other[both]).all())


def _reading_position(name: str) -> int:
    """Position of a reading among the columns; unknown readings come last."""
    return list(READING_TEXTS).index(name) if name in READING_TEXTS else len(READING_TEXTS)


def reading_texts(name: str) -> ReadingTexts:
    """Texts of a reading; its name if unknown."""
    return READING_TEXTS.get(name, ReadingTexts(name, ""))


def _whole_number_column(name: str, title: str, tip: str, values: Sequence[float]) -> ResultColumn:
    return ResultColumn(name, title, tip, np.array(values), tuple(f"{value:.0f}" for value in values))


def _plan_column(name: str, cells: Sequence[str]) -> ResultColumn:
    """Column of a plan, with numbers if all share one unit, or texts."""
    title = PLAN_TITLES.get(name, name.lstrip(NOTE_PREFIX).replace("_", " ").strip().capitalize())
    tip = tr("Column “{name}” of the plan").format(name=name)
    return _amounts(f"{_ASKED_FOR}{name}", title, tip, cells)


def _amounts(name: str, title: str, tip: str, cells: Sequence[str]) -> ResultColumn:
    found = [_AMOUNT.fullmatch(cell) for cell in cells]
    units = {match[2] for match in found if match}
    if len(units) != 1 or any(cell.strip() and not match for cell, match in zip(cells, found, strict=True)):
        return ResultColumn(name, title, tip, np.full(len(cells), np.nan), tuple(cells), "", True)
    unit = units.pop()
    suffix = _DEGREES.get(unit, f" {unit}" if unit else "")
    values = np.array([float(match[1]) if match else np.nan for match in found])
    texts = tuple(f"{format_short(v)}{suffix}".replace("-", "−") if np.isfinite(v) else "" for v in values)
    return ResultColumn(name, title, tip, values, texts, suffix, True)


def _motions(cells: Sequence[str]) -> list[ResultColumn]:
    """Columns of the motion amounts; one text column if a row repeats a motion."""
    tip = tr("Motion of the plan")
    nothing = np.full(len(cells), np.nan)
    as_text = [ResultColumn(MOTION_COLUMN, tr("Motion"), tip, nothing, tuple(cells), "", True)]
    found: list[dict[_Amount, str]] = []
    for cell in cells:
        try:
            steps = parse_motion(cell) if cell else ()
        except InputError:  # invalid motion in this row
            steps = ()
        amounts = {
            (step.handle, step.motion, place): text
            for step in steps
            for place, text in enumerate(step.amounts)
        }
        if len(amounts) < sum(len(step.amounts) for step in steps):
            return as_text
        found.append(amounts)
    kinds = list(dict.fromkeys(kind for amounts in found for kind in amounts))
    if len(kinds) > _MOST_KINDS:
        return as_text
    several = len({handle for handle, *_ in kinds}) > 1
    return [
        _amounts(
            _motion_column(*kind),
            _motion_title(*kind, several),
            tip,
            [amounts.get(kind, "") for amounts in found],
        )
        for kind in kinds
    ]


def _motion_column(handle: int, motion: Motion, place: int) -> str:
    return f"{MOTION_COLUMN} {handle} {motion.kind.word} {motion.axis} {place}"


def _motion_title(handle: int, motion: Motion, place: int, several: bool) -> str:
    axis = "xyz"[place] if motion.kind.has_all_axes else motion.axis.lower()
    parts = [motion.kind.title, axis, tr("(handle {n})").format(n=handle + 1) if several else ""]
    return " ".join(filter(None, parts))


def _reading(table: ResultTable, name: str) -> ResultColumn:
    words = reading_texts(name)
    numbers = [row.readings.get(name) for row in table.rows]
    values = np.array([np.nan if number is None else number for number in numbers], dtype=float)
    values = 100.0 * values if words.percent else values
    write = _writer(words)
    texts = tuple(write(value) if np.isfinite(value) else "" for value in values.tolist())
    return ResultColumn(name, words.title, words.tip, values, texts, " %" if words.percent else "")


def _writer(words: ReadingTexts) -> Callable[[float], str]:
    if words.percent:
        return lambda value: f"{format_grouped(value, 2)} %"
    if words.whole:
        return lambda value: format_grouped(value, 0)
    return lambda value: format_significant(value, 4)


def _statuses(table: ResultTable) -> ResultColumn:
    ranks = np.array([_ORDER.index(row.status) for row in table.rows], dtype=float)
    smallest = table.smallest_line
    texts = tuple(
        tr("{state}, smallest volume").format(state=status_text(row.status))
        if row.line == smallest
        else status_text(row.status)
        for row in table.rows
    )
    return ResultColumn(STATUS_COLUMN, tr("State"), tr("State of the case"), _gaps(texts), texts, ranks=ranks)


def _sentences(table: ResultTable) -> ResultColumn:
    texts = tuple(row.sentence for row in table.rows)
    tip = tr("Reason for failure, or a note")
    return ResultColumn(REMARK_COLUMN, tr("Remark"), tip, _gaps(texts), texts)


def _gaps(texts: Sequence[str]) -> np.ndarray:
    return np.full(len(texts), np.nan)
