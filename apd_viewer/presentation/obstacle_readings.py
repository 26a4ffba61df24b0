"""Texts about obstacles: loads and displacements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.mesh.arrays import significant_digits
from apd_viewer.language import tr
from apd_viewer.notation import notation
from apd_viewer.presentation.number_format import (
    format_editable,
    format_exact,
    format_length,
    format_significant,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from apd_viewer.session.model.named_obstacle import NamedObstacle
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.newton_conversion import NewtonConversion
    from apd_viewer.session.quantities.units import Unit

# Tolerance for a reached obstacle position, relative to the longest side of the mesh.
_THERE = 1e-4
# Largest negligible load, relative to the longest side and for a stiffness of 1: the barrier's tail.
NO_LOAD = 1e-9
LOAD_DIGITS = 3  # significant digits of loads
_DIGITS = 8  # digits of numbers for repeating the deformation
_ESTIMATED = 2  # digits of estimates
_ALWAYS = 0.95  # factors between this and its inverse are not reported
LOAD_TIP = tr("Force on the obstacle, of a material of stiffness 1; in newtons where the wall is known")
HAND_TIP = tr("A hand grips with at most 500\u00a0N (men) or 304\u00a0N (women), in the median")


def inactive_reason(state: State) -> str:
    """Sentence saying why obstacles are inactive; empty if they are active."""
    method = state.document.settings.traits
    if method.obstacle_problem:
        return method.obstacle_problem
    return "" if state.document.settings.contact else tr("Contact is off: obstacles push nothing.")


def newtons_text(force: float) -> str:
    """Text of a force in newtons."""
    return tr("{force} N").format(force=format_significant(force, LOAD_DIGITS))


def force_text(load: float, newtons: NewtonConversion | None) -> str:
    """Text of a load of the model, in newtons if they are known."""
    if newtons is not None:
        return newtons_text(newtons.newtons_per_load * load)
    return tr("{load} at stiffness 1").format(load=format_significant(load, LOAD_DIGITS))


def force_tip(newtons: NewtonConversion | None, *sentences: str) -> str:
    """Tip of a load from sentences; newtons are set beside the force of a hand."""
    return ". ".join((*sentences, *([] if newtons is None else [HAND_TIP])))


def load_text(state: State, k: int, newtons: NewtonConversion | None) -> str:
    """Text of the load on obstacle ``k``; empty without a load."""
    loads = state.frame.loads
    if not state.is_contact_active or len(loads) != len(state.document.obstacles):
        return ""
    force = float(np.linalg.norm(loads[k]))
    if force <= NO_LOAD * float(max(state.inspection.size)):
        return ""
    if not state.frame.settled:  # before convergence the force may be hundreds of times larger
        return tr("touched")
    return tr("load {force}").format(force=force_text(force, newtons))


def excess_phrase(excess: float | None) -> str:
    """Phrase about the expected excess of loads; None means a wall without stiffness."""
    if excess is None:
        return tr("without stiffness, walls crumple and loads mean little")
    return tr("expected excess of loads {percent} %").format(
        percent=format_significant(100.0 * excess, _ESTIMATED)
    )


def error_factor_phrase(factor: float) -> str:
    """Phrase about loads too low or too high by a factor; empty near 1."""
    if factor > 1.0 / _ALWAYS:
        return tr("up to {factor} times too low").format(factor=format_significant(factor, _ESTIMATED))
    if factor < _ALWAYS:
        return tr("up to {factor} times too high").format(factor=format_significant(1.0 / factor, _ESTIMATED))
    return ""


def load_excess_text(state: State, newtons: NewtonConversion | None) -> str:
    """Sentence about the expected error of converged loads; empty if there is none."""
    pressed = any(load_text(state, k, newtons) for k in range(len(state.document.obstacles)))
    if not pressed or not state.frame.settled:
        return ""
    phrase = _error_phrase(state, newtons)
    return phrase[0].upper() + phrase[1:]


def _error_phrase(state: State, newtons: NewtonConversion | None) -> str:
    """Phrase about the expected excess of loads, and about too low newtons."""
    off = "" if newtons is None else error_factor_phrase(newtons.underestimate_factor())
    return "; ".join(filter(None, (excess_phrase(state.load_excess), off)))


def motion_text(state: State, k: int, unit: Unit) -> str:
    """Displacement of obstacle ``k``, and the distance lost to contact."""
    obstacle, size = state.document.obstacles[k], float(max(state.inspection.size))
    distance = format_length(float(np.linalg.norm(obstacle.shift)), size)
    if distance == "0":
        return tr("not moved")
    short_of = float(np.linalg.norm(obstacle.shift - state.obstacle_shifts[k]))
    moved = tr("moved {length}").format(length=unit.format_length(distance))
    if not state.is_contact_active or short_of <= _THERE * size:
        return moved
    if state.frame.settled:
        missing = unit.format_length(format_length(short_of, size))
        sentence = tr("asked for {length}, stopped {missing} short")
        return sentence.format(length=unit.format_length(distance), missing=missing)
    reached = unit.format_length(format_length(float(np.linalg.norm(state.obstacle_shifts[k])), size))
    return tr("{motion}, reached {amount}").format(motion=moved, amount=reached)


def coordinates_text(x: np.ndarray, size: float = 1.0, digits: int = _DIGITS) -> str:
    """Three coordinates as editable text, with rounding errors as 0."""
    between = "; " if notation().point == "," else ", "
    parts = (
        format_editable(c, significant_digits(c, size, digits)) if abs(c) > 10.0**-digits * size else "0"
        for c in x
    )
    return between.join(parts)


def obstacle_report_rows(
    state: State, unit: Unit, newtons: NewtonConversion | None
) -> Iterator[tuple[str, str, str]]:
    """Report rows of the obstacles with displacements, positions and loads."""
    size = float(max(state.inspection.size))
    for k, obstacle in enumerate(state.document.obstacles):
        details = [obstacle.kind.title, *_shape(obstacle, unit, size)]
        if text := load_text(state, k, newtons):
            details.append(f"{text}, {_error_phrase(state, newtons)}" if state.frame.settled else text)
        yield obstacle.name, motion_text(state, k, unit), "; ".join(details)


def _shape(obstacle: NamedObstacle, unit: Unit, size: float) -> Iterator[str]:
    yield tr("place {point}").format(point=unit.format_length(f"({coordinates_text(obstacle.place, size)})"))
    if obstacle.shift.any():
        yield tr("displacement {vector}").format(
            vector=unit.format_length(f"({coordinates_text(obstacle.shift, size)})")
        )
    if not obstacle.radius:
        yield tr("normal {vector}").format(vector=f"({coordinates_text(obstacle.axis)})")
        return
    yield tr("radius {length}").format(length=unit.format_length(format_exact(obstacle.radius, _DIGITS)))
    if obstacle.length:
        yield tr("length {length}").format(length=unit.format_length(format_exact(obstacle.length, _DIGITS)))
        yield tr("axis {vector}").format(vector=f"({coordinates_text(obstacle.axis)})")
