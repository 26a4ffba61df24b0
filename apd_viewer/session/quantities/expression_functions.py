"""Functions of expressions, such as sqrt or sin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.quantities.quantity import DIMENSIONLESS, Quantity

_OF_ANGLES: dict[str, Callable[[float], float]] = {"sin": math.sin, "cos": math.cos, "tan": math.tan}
_TO_ANGLES: dict[str, Callable[[float], float]] = {"asin": math.asin, "acos": math.acos, "atan": math.atan}
VARIADIC_FUNCTIONS: dict[str, Callable[..., float]] = {"min": min, "max": max}
FUNCTIONS = ("sqrt", *_OF_ANGLES, *_TO_ANGLES, "abs", *VARIADIC_FUNCTIONS)
# Rounding of a cosine at a right angle.
_NO_COSINE = 1e-15


def call_function(name: str, values: list[Quantity]) -> Quantity:
    """Value of a named function."""
    first = values[0]
    if name in VARIADIC_FUNCTIONS:
        for value in values:
            first = first.in_kind_of(value)
        return replace(first, value=VARIADIC_FUNCTIONS[name](value.value for value in values))
    if len(values) != 1:
        raise InputError(
            tr("{name} takes one value, not {n}, as in {name}(1).").format(name=name, n=len(values))
        )
    if name == "abs":
        return replace(first, value=abs(first.value))
    if name == "sqrt":
        return first ** Quantity(0.5)
    return _of_angle(name, first) if name in _OF_ANGLES else _to_angle(name, first)


def _of_angle(name: str, value: Quantity) -> Quantity:
    if value.powers not in (DIMENSIONLESS, (0.0, 1.0)):
        raise InputError(
            tr("{name} does not accept {kind}; enter an angle, as in {name}(30deg).").format(
                name=name, kind=value.kind
            )
        )
    turn = math.radians(value.value)
    if name == "tan" and abs(math.cos(turn)) < _NO_COSINE:
        raise InputError(tr("The tangent of a right angle is infinite; enter another angle."))
    return Quantity(_OF_ANGLES[name](turn))


def _to_angle(name: str, value: Quantity) -> Quantity:
    if value.powers != DIMENSIONLESS:
        raise InputError(
            tr("{name} does not accept {kind}; enter a number, as in {name}(0.5).").format(
                name=name, kind=value.kind
            )
        )
    if name != "atan" and abs(value.value) > 1.0:
        raise InputError(
            tr("{name} accepts only numbers from -1 to 1; enter one of these.").format(name=name)
        )
    return Quantity(math.degrees(_TO_ANGLES[name](value.value)), angle=1.0)
