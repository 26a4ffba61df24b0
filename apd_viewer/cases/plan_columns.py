"""Columns of a plan and the parsers of their values."""

from collections.abc import Callable
from typing import NamedTuple

from apd_viewer.cases.case import MOST_STEPS
from apd_viewer.cases.study_case import CaseSetting
from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import LEAST_AREA, MOST_AREA
from apd_viewer.geometry.goals.target_values import PERCENT_SIGN, check_not_factor
from apd_viewer.geometry.solver.convergence import CRITERIA, LARGEST_SEED, LARGEST_TOLERANCE, MOST_ITERATIONS
from apd_viewer.geometry.solver.methods import MOST_VERTICES_IN_CONTACT, method_named
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS, Setting, SettingKind
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.session.quantities.units import SYMBOLS
from apd_viewer.session.quantities.volume_target import is_percentage
from apd_viewer.session.quantities.wall_material import parse_pressure_difference, parse_young_modulus

NOTE_PREFIX = "#"
YOUNG_COLUMN = "young"
AUTO = "auto"
_YES, _NO = ("yes", "on", "true", "1"), ("no", "off", "false", "0")
_FACTORS_OF_MOTION = 2.0  # smaller numbers without % could be meant as factors
_SHOWN = 40  # characters quoted from invalid input


class PlanColumn(NamedTuple):
    """Column of a study plan: its parser and its description.

    Attributes
    ----------
    parse : callable
        Makes a setting of what a cell says; raises InputError.
    description : str
        Meaning of the column, for the help of the command.
    """

    parse: Callable[[str], CaseSetting]
    description: str


def _number(least: float, most: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = parse_number(text, {})
        if not least <= value <= most:
            raise InputError(
                tr("{value:g} is out of range; enter {least:g} to {most:g}.").format(
                    value=value, least=least, most=most
                )
            )
        return value

    return read


def _percent(text: str) -> float:
    value = _number(LEAST_AREA, MOST_AREA)(text.removesuffix(PERCENT_SIGN))
    if not text.endswith(PERCENT_SIGN):
        check_not_factor(value)
    return value


def _volume(text: str) -> float | str:
    """Percentage, or the text of a volume, whose unit depends on the mesh."""
    return _percent(text) if is_percentage(text) else text


def _part(text: str) -> float:
    value = _number(0.01, 10_000.0)(text.removesuffix(PERCENT_SIGN))
    if not text.endswith(PERCENT_SIGN):
        check_not_factor(value, _FACTORS_OF_MOTION)
    return value / 100.0


def _count(most: int, least: int = 1) -> Callable[[str], int]:
    def read(text: str) -> int:
        value = parse_number(text, {})
        if not least <= value <= most or value != int(value):
            raise InputError(
                tr("“{text}” is not a whole number from {least} to {most:,}.").format(
                    text=text[:_SHOWN], least=least, most=most
                )
            )
        return int(value)

    return read


def _switch(text: str) -> bool:
    if text.lower() not in (*_YES, *_NO):
        raise InputError(tr("“{text}” is neither yes nor no.").format(text=text[:_SHOWN]))
    return text.lower() in _YES


def _contact(text: str) -> bool | int:
    """Contact setting: yes, no, or the largest number of vertices with contact."""
    if text.lower() == AUTO:
        return MOST_VERTICES_IN_CONTACT
    if text.lower() not in (*_YES, *_NO):
        raise InputError(tr("“{text}” is not yes, no or auto.").format(text=text[:_SHOWN]))
    return _switch(text)


def _method(text: str) -> str:
    method_named(text)
    return text


def parse_unit(text: str) -> str:
    """Validated symbol of a unit of length; raises InputError."""
    if text not in SYMBOLS:
        raise InputError(
            tr("“{text}” is not a unit of length; use {units}.").format(
                text=text[:_SHOWN], units=", ".join(SYMBOLS)
            )
        )
    return text


def _parser(setting: Setting) -> Callable[[str], CaseSetting]:
    match setting.kind:
        case SettingKind.METHOD:
            return _method
        case SettingKind.NUMBER | SettingKind.TOLERANCE | SettingKind.AMOUNT:
            return _number(setting.least, setting.most)
        case SettingKind.PERCENTAGE:
            return _percent
        case SettingKind.SWITCH:
            return _switch
        case _:  # lengths in a unit, and what is no column
            return str


def _with_default(name: str, setting: Setting) -> str:
    """Description of a setting, with its default unless that depends on the method."""
    default = getattr(DEFAULT_SETTINGS, name)
    if default is None or setting.kind is SettingKind.PERCENTAGE:
        return setting.help
    if setting.kind is SettingKind.SWITCH:
        default = tr("yes") if default else tr("no")
    elif setting.kind is not SettingKind.METHOD:
        default = f"{default:g}"
    return tr("{what}; default: {default}").format(what=setting.help, default=default)


# Columns of the input files, the motion and its number of steps.
CASE_COLUMNS = {
    "mesh": tr("mesh file, or a session (.apd)"),
    "session": tr("session (.apd) with its paint, instead of mesh and selection"),
    "selection": tr("selection of base and handle"),
    "motion": tr("motion of the handles, such as twist 120deg; push 30%; default: the session's"),
    "unit": tr("unit of the mesh: mm, cm, m, in or ft"),
    "steps": tr("steps of the motion; default: 10"),
}
SETTING_COLUMNS = {
    **{
        name: PlanColumn(_parser(setting), _with_default(name, setting))
        for name, setting in SETTINGS.items()
        if setting.kind not in (SettingKind.CONVERGENCE, SettingKind.VOLUME, SettingKind.PRESSURE)
    },
    "volume": PlanColumn(_volume, SETTINGS["volume"].help),
    "pressure": PlanColumn(parse_pressure_difference, SETTINGS["pressure"].help),
    YOUNG_COLUMN: PlanColumn(
        parse_young_modulus, tr("Young's modulus of the wall, such as 2.8GPa, for a pressure")
    ),
    "contact": PlanColumn(
        _contact,
        tr(
            "keep walls from passing through each other: yes, no, or auto (up to {most:,} vertices, for "
            "methods that can); empty: no; auto and empty keep the choice of a session"
        ).format(most=MOST_VERTICES_IN_CONTACT),
    ),
    "to": PlanColumn(_part, tr("percent of the motion at the last step; default: 100")),
    "imperfection": PlanColumn(_number(0.0, LARGEST_TOLERANCE), CRITERIA["imperfection"]),
    "seed": PlanColumn(_count(LARGEST_SEED, least=0), CRITERIA["seed"]),
    "iterations": PlanColumn(_count(MOST_ITERATIONS), tr("iteration limit per step; default: as for sweep")),
}
COLUMNS = (*CASE_COLUMNS, *SETTING_COLUMNS)
LENGTH_COLUMNS = {name for name, setting in SETTINGS.items() if setting.kind is SettingKind.LENGTH}
SEED_COLUMN = "seed"
COUNT_COLUMNS = ("steps", "iterations", "seed")  # columns of integers


def parse_steps(text: str) -> int:
    """Validated number of steps; raises InputError."""
    return _count(MOST_STEPS)(text)
