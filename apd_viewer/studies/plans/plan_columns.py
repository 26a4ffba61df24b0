"""Columns of a plan, and their values."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import LEAST_AREA, MOST_AREA
from apd_viewer.geometry.goals.percentage import PERCENT_SIGN, check_no_factor
from apd_viewer.geometry.solver.convergence import LARGEST_TOLERANCE, MOST_ITERATIONS
from apd_viewer.geometry.solver.methods import MOST_VERTICES_IN_CONTACT, method_named
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.session.quantities.units import SYMBOLS
from apd_viewer.session.studies.sweep_setup import MOST_STEPS
from apd_viewer.studies.plans.case import Setting

NOTE_PREFIX = "#"
AUTO = "auto"
_YES, _NO = ("yes", "on", "true", "1"), ("no", "off", "false", "0")
_LARGEST = 1e6
_FACTORS_OF_MOTION = 2.0  # a part of a motion below can be a factor; from 2 on percents are usual
_SHOWN = 40  # characters quoted from invalid input


class PlanColumn(NamedTuple):
    """A column of a plan.

    Attributes
    ----------
    parse : callable
        Makes a setting of what a cell says; raises InputError.
    description : str
        What it is, for the help of the command.
    """

    parse: Callable[[str], Setting]
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
        check_no_factor(value)
    return value


def _part(text: str) -> float:
    value = _number(0.01, 10_000.0)(text.removesuffix(PERCENT_SIGN))
    if not text.endswith(PERCENT_SIGN):
        check_no_factor(value, _FACTORS_OF_MOTION)
    return value / 100.0


def _count(most: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        value = parse_number(text, {})
        if not 1 <= value <= most or value != int(value):
            raise InputError(
                tr("“{text}” is no whole number from 1 to {most:,}.").format(text=text[:_SHOWN], most=most)
            )
        return int(value)

    return read


def _switch(text: str) -> bool:
    if text.lower() not in (*_YES, *_NO):
        raise InputError(tr("“{text}” is neither yes nor no.").format(text=text[:_SHOWN]))
    return text.lower() in _YES


def _contact(text: str) -> bool | int:
    """Yes, no, or the number of vertices up to which contact is on."""
    if text.lower() == AUTO:
        return MOST_VERTICES_IN_CONTACT
    if text.lower() not in (*_YES, *_NO):
        raise InputError(tr("“{text}” is none of yes, no and auto.").format(text=text[:_SHOWN]))
    return _switch(text)


def _method(text: str) -> str:
    method_named(text)
    return text


def parse_unit(text: str) -> str:
    """Symbol of a unit of length; raises InputError."""
    if text not in SYMBOLS:
        raise InputError(
            tr("“{text}” is no unit of length; use {units}.").format(
                text=text[:_SHOWN], units=", ".join(SYMBOLS)
            )
        )
    return text


# What belongs together in a case: files, motion, and the number of its steps.
CASE_COLUMNS = {
    "mesh": tr("mesh file, or a session (.apd)"),
    "session": tr("session (.apd) with its paint, instead of mesh and selection"),
    "selection": tr("what of the mesh is base and handle"),
    "motion": tr("of the handles, such as twist 120deg; push 30%; without, that of the session"),
    "unit": tr("of the mesh: mm, cm, m, in or ft"),
    "steps": tr("of the motion; default: 10"),
}
SETTING_COLUMNS = {
    "method": PlanColumn(_method, tr("arap, paper, exact, local or sr-arap; default: exact")),
    "to": PlanColumn(_part, tr("percent of the motion at the last step; default: 100")),
    "iterations": PlanColumn(_count(MOST_ITERATIONS), tr("at most so many a step; default: as sweep")),
    "stiffness": PlanColumn(_number(0.0, _LARGEST), tr("bending stiffness, 0 (cloth) to 0.1 (sheet metal)")),
    "area_stiffness": PlanColumn(
        _number(0.0, _LARGEST), tr("of local: how strongly triangles keep their area")
    ),
    "shear_stiffness": PlanColumn(
        _number(0.0, _LARGEST), tr("of local: how strongly triangles keep their shape")
    ),
    "area": PlanColumn(_percent, tr("target of the total area, percent of rest")),
    "volume": PlanColumn(_percent, tr("target of the volume, percent of rest; empty: free")),
    "tolerance": PlanColumn(_number(1e-12, LARGEST_TOLERANCE), tr("of the area, by paper")),
    "hold_area": PlanColumn(_switch, tr("of local: keep the total area too")),
    "calm": PlanColumn(_switch, tr("of exact: keep the area of calm parts; default: yes")),
    "contact": PlanColumn(
        _contact,
        tr(
            "keep walls from passing through each other: yes, no, or auto (up to {most:,} vertices, by "
            "methods that can); empty: no; of a session auto and empty are what it says"
        ).format(most=MOST_VERTICES_IN_CONTACT),
    ),
    "thickness": PlanColumn(str, tr("length: distance that walls in contact keep")),
}
COLUMNS = (*CASE_COLUMNS, *SETTING_COLUMNS)
COUNT_COLUMNS = ("steps", "iterations")  # whole numbers


def parse_steps(text: str) -> int:
    """Number of steps; raises InputError."""
    return _count(MOST_STEPS)(text)
