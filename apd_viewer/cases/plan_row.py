"""Rows of a plan as cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from apd_viewer.cases.input_files import InputFiles
from apd_viewer.cases.plan_columns import SETTING_COLUMNS, parse_steps, parse_unit
from apd_viewer.cases.study_case import CaseSetting, StudyCase
from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, MOST_VERTICES_IN_CONTACT
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.posing.motion_text import ANY_LENGTHS, parse_motion
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import NoUnitError, Unit

T = TypeVar("T")

DEFAULT_STEPS = 10
_READERS: dict[str, Callable[[str], CaseSetting]] = {
    "unit": parse_unit,
    "steps": parse_steps,
    **{name: column.parse for name, column in SETTING_COLUMNS.items()},
}
# Of a mesh: who writes down what is usual asks for the same as who does not. Whether walls are kept apart is
# always written down, since new work and plans without that column differ.
_USUAL = asdict(DEFAULT_SETTINGS)
_OLD = {"contact": False}
# Stand-in for the unit of a session, which is read later; no cell is accepted or refused because of it.
_SOME = Unit.MILLIMETRE


def parse_case(cells: Mapping[str, str], folder: Path, sources: InputFiles) -> StudyCase:
    """Case of a row; raises InputError.

    Parameters
    ----------
    cells : mapping of str to str
        Cells that are not empty, by their columns.
    folder : Path
        Where the files are that it names.
    sources : InputFiles
    """
    settings = _settings(cells)
    unit = str(parse_cell("unit", cells["unit"])) if "unit" in cells else ""
    steps = int(parse_cell("steps", cells["steps"])) if "steps" in cells else DEFAULT_STEPS
    name = cells.get("mesh") or cells.get("session")
    if not name or ("mesh" in cells and "session" in cells):
        raise InputError(tr("Give either a mesh or a session."))
    whole = name.lower().endswith(SESSION_SUFFIX)
    if "session" in cells and not whole:
        raise InputError(tr("“{name}” is no session (.apd); give it as the mesh.").format(name=name))
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
    motion = (
        _in_column("motion", lambda text: _motion(text, typed), cells["motion"]) if "motion" in cells else ()
    )
    if "thickness" in cells:
        _in_column("thickness", lambda text: _thickness(text, typed), cells["thickness"])
    mesh = sources.mesh(folder / name)
    if not whole:
        own = {name: value for name, value in settings.items() if name in _OLD or value != _USUAL.get(name)}
        settings = _OLD | own
    elif settings.get("contact") == MOST_VERTICES_IN_CONTACT:
        del settings["contact"]  # the session says it
    selection = None if whole else sources.selection(folder / cells["selection"])
    return StudyCase(mesh, selection, motion, unit, steps, tuple(settings.items()))


def parse_cell(name: str, text: str) -> CaseSetting:
    """Value of a cell on its own; raises InputError."""
    return _in_column(name, _READERS.get(name, str), text)


def _settings(cells: Mapping[str, str]) -> dict[str, CaseSetting]:
    found = {name: parse_cell(name, cells[name]) for name in SETTING_COLUMNS if name in cells}
    method = str(found.get("method", DEFAULT_METHOD))
    if found.get("contact") is True and not METHODS[method].may_use_contact:
        raise InputError(tr("“{method}” knows no contact; choose another method.").format(method=method))
    if "thickness" in found and not found.get("contact", "session" in cells):
        raise InputError(tr("“thickness” is the distance of walls in contact; set “contact” to yes."))
    return found


@lru_cache(maxsize=4096)
def _motion(text: str, unit: Unit) -> tuple[str, ...]:
    steps = parse_motion(text)
    for step in steps:
        step.parse_amounts(unit)
    return tuple(step.text for step in steps)


def _thickness(text: str, unit: Unit) -> float:
    value = parse_length(text, unit, ANY_LENGTHS)
    if not value > 0.0:
        raise InputError(tr("A distance must be greater than 0; enter another one."))
    return value


def _in_column(name: str, read: Callable[[str], T], text: str) -> T:
    """Value of a cell; raises InputError with the column's name."""
    try:
        return read(text)
    except NoUnitError as error:
        raise InputError(
            tr(
                "Column “{name}”: The unit of the mesh is not set; fill in “unit” for a length in {word}."
            ).format(name=name, word=error.word)
        ) from error
    except InputError as error:
        raise InputError(tr("Column “{name}”: {sentence}").format(name=name, sentence=error)) from error
