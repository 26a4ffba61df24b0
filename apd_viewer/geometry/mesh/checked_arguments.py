"""Arguments of public functions, checked by their names."""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Sequence
from functools import wraps
from numbers import Integral, Real
from typing import NamedTuple, NoReturn, ParamSpec, TypeVar

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr

P = ParamSpec("P")
R = TypeVar("R")
MOST_STIFFNESS = 1e9  # its products with areas and the squares of those have digits left
_LARGEST = 1e38  # length, as of coordinates; squares of larger ones, and their products, overflow
_MOST_ITERATIONS = 10**9


class _Kind(NamedTuple):
    """Kind of an argument.

    Attributes
    ----------
    holds : callable
        True for a value that is one.
    sentence : str
        About one that is none, with the ``{name}`` of the argument.
    """

    holds: Callable[[object], bool]
    sentence: str


def as_float(value: object) -> float:
    """Float of a number; NaN for anything else, such as a truth value or a text."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def is_whole_number(value: object) -> bool:
    """True for a whole number, but not for a truth value."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def _between(least: float, most: float) -> _Kind:
    words = tr("{name} must be a number from {least} to {most}.")
    sentence = words.format(name="{name}", least=f"{least:g}", most=f"{most:g}")
    return _Kind(lambda given: least <= as_float(given) <= most, sentence)


_FLAG = _Kind(lambda given: isinstance(given, bool | np.bool_), tr("{name} must be True or False."))
_LENGTH = _Kind(
    lambda given: 1.0 / _LARGEST <= as_float(given) <= _LARGEST,
    tr("{name} must be a length in mesh units: a number greater than 0 and at most 1e38."),
)
_COUNT = _Kind(
    lambda given: is_whole_number(given) and 1 <= given <= _MOST_ITERATIONS,  # type: ignore[operator]
    tr("{name} must be a whole number of at least 1."),
)
_LIST = _Kind(
    lambda given: isinstance(given, Sequence) and not isinstance(given, str | bytes),
    tr("{name} must be a list."),
)
_CALL = _Kind(callable, tr("{name} must be a function."))
_PROGRESS = _Kind(
    lambda given: callable(given) or isinstance(given, bool | np.bool_),
    tr("{name} must be a function, True or False."),
)
_PATH = _Kind(
    lambda given: isinstance(given, str | os.PathLike),
    tr("{name} must be the path of a file, as text or pathlib.Path."),
)
_TEXT = _Kind(lambda given: isinstance(given, str), tr("{name} must be a text."))
_STIFFNESS = _between(0.0, MOST_STIFFNESS)

_KINDS = {
    **dict.fromkeys(("calm", "contact", "plain", "weld", "release"), _FLAG),
    **dict.fromkeys(("stiffness", "area_stiffness", "shear_stiffness"), _STIFFNESS),
    **dict.fromkeys(("thickness", "yield_radius", "radius", "size"), _LENGTH),
    **dict.fromkeys(("iterations", "steps"), _COUNT),
    "regions": _LIST,
    "tolerance": _between(1e-12, 1e9),
    "gas": _Kind(
        lambda given: 0.0 < as_float(given) <= _LARGEST,
        tr("{name} must be a number greater than 0 and at most 1e38."),
    ),
    "container": _between(0.0, _LARGEST),
    "factored": _CALL,
    "progress": _CALL,
    "deform.progress": _PROGRESS,
    "path": _PATH,
    "unit": _TEXT,
    "name": _TEXT,
    "remarks": _Kind(
        lambda given: isinstance(given, tuple) and all(isinstance(each, str) for each in given),
        tr("{name} must be a tuple of texts."),
    ),
    "origin": _Kind(lambda given: hasattr(given, "rewritten"), tr("{name} must be that of an opened mesh.")),
}


def check_argument(name: str, value: object, kind: _Kind | None = None) -> None:
    """Raise InputError on an argument of another kind than its name says.

    Arrays, and what depends on the mesh, are checked where they are used.
    """
    kind = kind or _KINDS.get(name)
    if kind is not None and not kind.holds(value):
        raise InputError(kind.sentence.format(name=name))


def check_type(name: str, value: object, kind: type) -> None:
    """Raise InputError unless an argument is of a type."""
    if not isinstance(value, kind):
        raise InputError(tr("{name} must be of the type {kind}.").format(name=name, kind=kind.__name__))


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """The function with its arguments checked, but for those left at their defaults."""
    signature = inspect.signature(function)
    default = {name: parameter.default for name, parameter in signature.parameters.items()}
    own = {name: _KINDS.get(f"{function.__name__}.{name}") for name in default}

    @wraps(function)
    def checking(*args: P.args, **named: P.kwargs) -> R:
        for name, given in signature.bind(*args, **named).arguments.items():
            if given is not default[name]:
                check_argument(name, given, own[name])
        return function(*args, **named)

    return checking


class Uncopyable:
    """Object with a factor, refusing to be copied or pickled."""

    def __reduce_ex__(self, _: object) -> NoReturn:
        """Raise InputError."""
        raise InputError(
            tr(
                "A Deformation cannot be copied or pickled; make another one with the same arguments, and "
                "aim it with the U of its last frame."
            )
        )
