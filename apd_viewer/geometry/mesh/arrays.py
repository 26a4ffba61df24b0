"""Validated and read-only arrays, and validation of arguments by their names."""

import inspect
import math
import os
from collections.abc import Callable, Sequence
from functools import wraps
from numbers import Integral, Real
from typing import NamedTuple, ParamSpec, TypeVar

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trn

# Of lengths, too: larger ones exceed single precision, and products of their squares overflow.
LARGEST_COORDINATE = 1e38


def largest_coordinate(X: np.ndarray) -> float:
    """Largest absolute coordinate."""
    return max(float(X.max()), -float(X.min()))


def frozen(array: np.ndarray) -> np.ndarray:
    """Return ``array`` marked read-only (in place: no copy)."""
    array.flags.writeable = False
    return array


def diagonal(points: np.ndarray) -> float:
    """Diagonal of the bounding box of points (k, 3), possibly repeated."""
    return float(np.linalg.norm(extents(points)))


def extents(points: np.ndarray) -> np.ndarray:
    """Extents (3,) of points (k, 3) along x, y and z."""
    low, high = bounding_box(points)
    return high - low


def bounding_box(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest coordinates (3,) of points (k, 3)."""
    # One coordinate after the other: NumPy is slow across rows of three.
    return np.array([x.min() for x in points.T]), np.array([x.max() for x in points.T])


def mesh_size(V: np.ndarray, F: np.ndarray) -> float:
    """Diagonal of the bounding box of the triangles ``F`` (m, 3)."""
    return diagonal(V[used_vertices(F)])


def used_vertices(F: np.ndarray) -> np.ndarray:
    """Distinct vertices of triangles ``F`` (m, 3), or integers from 0, ascending."""
    # np.unique hashes integers, and takes a hundred times as long for a million triangles.
    is_used = np.zeros(int(F.max()) + 1 if F.size else 0, dtype=bool)
    is_used[F] = True
    return np.flatnonzero(is_used)


def distinct_keys(keys: np.ndarray) -> np.ndarray:
    """Distinct integers (k,) of ``keys``, ascending."""
    keys = np.sort(keys, axis=None)  # np.unique hashes integers, which takes longer
    return keys[np.concatenate([np.ones(min(len(keys), 1), dtype=bool), keys[1:] != keys[:-1]])]


def local_origin(points: np.ndarray) -> np.ndarray:
    """Local origin (3,) near ``points`` (k, 3); zero if they lie near zero.

    A multiple of a power of two, at least four times the diagonal: subtracting and adding it rounds nothing
    but the last bit, and what lies about the origin keeps its coordinates.
    """
    low, high = (0.5 * corner for corner in bounding_box(points))  # halved, as the full size may overflow
    half = float((high - low).max())
    if not half > 0.0:
        return np.zeros(3)
    grid = np.ldexp(1.0, min(1000, int(np.ceil(np.log2(half))) + 4))
    return np.round((low + high) / grid) * grid + 0.0


def significant_digits(x: float, size: float, digits: int) -> int:
    """Significant digits of a coordinate: ``digits`` near the origin, at most 15.

    They leave as many to a mesh of this ``size`` as it has at the origin.
    """
    return min(15, digits + max(0, int(np.log10(max(abs(x) / size, 1.0))))) if size > 0.0 else digits


def checked_floats(value: object, name: str) -> np.ndarray:
    """Float64 copy, row by row, of a caller's array; else raises InputError."""
    try:
        array = np.asarray(value)
    except ValueError:  # NumPy rejects rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "iuf":
        raise InputError(
            tr("{what} must be an array of real numbers with rows of equal length.").format(what=name)
        )
    return array.astype(np.float64, order="C")  # of columns, every kernel would be compiled anew


def checked_vectors(value: object, count: int, name: str) -> np.ndarray:
    """``value`` (count, 3) as floats; raises InputError for other shapes or values."""
    array = checked_floats(value, name)
    if array.shape != (count, 3) or not np.isfinite(array).all():
        raise InputError(tr("{what} must be {n:,} finite vectors.").format(what=name, n=count))
    return array


def checked_point(value: object) -> np.ndarray:
    """``value`` (3,) as floats; raises InputError unless it is a finite point."""
    x = _as_vector(value)
    if x is None:
        raise InputError(tr("A place must be three finite numbers."))
    return x


def checked_direction(value: object) -> np.ndarray:
    """``value`` (3,) scaled to length 1; raises InputError if it has no direction."""
    x = _as_vector(value)
    length = 0.0 if x is None else float(np.linalg.norm(x))
    if x is None or not 0.0 < length < np.inf:
        raise InputError(tr("A direction must be three numbers, not all of them 0."))
    return x / length


def _as_vector(value: object) -> np.ndarray | None:
    try:
        x = np.asarray(value)
    except ValueError:  # NumPy rejects rows of different lengths
        return None
    x = x.astype(float) if x.dtype.kind in "iuf" else np.empty(0)
    return x if x.shape == (3,) and np.isfinite(x).all() else None


def checked_integers(value: object, name: str) -> np.ndarray:
    """Int64 copy of a caller's array; raises InputError for fractional values."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "b":
        said = tr("{what} must be vertex IDs, not a mask; give numpy.flatnonzero(mask).")
        raise InputError(said.format(what=name))
    array = checked_floats(value, name)
    if not (np.abs(array) < 2.0**53).all() or (array != np.rint(array)).any():
        raise InputError(tr("{what} must be whole numbers: vertex IDs, counted from 0.").format(what=name))
    return array.astype(np.int64)


def mesh_arrays(V: object, F: object) -> tuple[np.ndarray, np.ndarray]:
    """Copies of a caller's arrays (n, 3) and (m, 3); raises InputError if invalid."""
    arrays = checked_floats(V, tr("Vertices")), checked_integers(F, tr("Faces"))
    check_mesh(*arrays)
    return arrays


def check_mesh(V: np.ndarray, F: np.ndarray) -> None:
    """Raise InputError unless ``V`` (n, 3) and ``F`` (m, 3) form a mesh with area."""
    if V.ndim != 2 or V.shape[1] != 3:
        raise InputError(
            tr("Vertices must be an (n, 3) array, not {shape}; give one row x y z per vertex.").format(
                shape=V.shape
            )
        )
    if F.ndim != 2 or F.shape[1] != 3:
        raise InputError(
            tr("Faces must be an (m, 3) array of triangles, not {shape}; triangulate the mesh first.").format(
                shape=F.shape
            )
        )
    if len(V) == 0:
        raise InputError(tr("There are no vertices; export the mesh again."))
    if len(F) == 0:
        raise InputError(tr("No faces: this looks like a point cloud; reconstruct a surface first."))
    if not np.isfinite(V).all():
        bad = np.flatnonzero(~np.isfinite(V).all(axis=1))
        said = trn(
            "{n:,} vertex has a coordinate that is not a number (the first is vertex {first}); "
            "repair the file.",
            "{n:,} vertices have a coordinate that is not a number (the first is vertex {first}); "
            "repair the file.",
            len(bad),
        )
        raise InputError(said.format(n=len(bad), first=bad[0]))
    if (size := largest_coordinate(V)) > LARGEST_COORDINATE:
        said = tr("There are coordinates as large as {size:.3g}; repair the file, or choose a larger unit.")
        raise InputError(said.format(size=size))
    if F.min() < 0 or F.max() >= len(V):
        missing = int(((F < 0) | (len(V) <= F)).any(axis=1).sum())
        said = trn(
            "{n:,} face refers to missing vertices (there are {there:,}); "
            "repair the file or export it again.",
            "{n:,} faces refer to missing vertices (there are {there:,}); "
            "repair the file or export it again.",
            missing,
        )
        raise InputError(said.format(n=missing, there=len(V)))


P = ParamSpec("P")
R = TypeVar("R")
MOST_HARDENING = 0.99
MOST_STIFFNESS = 1e9  # products with areas, and their squares, keep enough digits
_MOST_ITERATIONS = 10**9


class _Kind(NamedTuple):
    """Kind of value expected for an argument.

    Attributes
    ----------
    holds : callable
        True for a valid value.
    sentence : str
        About one that is none, with the ``{name}`` of the argument.
    """

    holds: Callable[[object], bool]
    sentence: str


def as_float(value: object) -> float:
    """Float of a number; NaN for anything else, such as a bool or a string."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def is_whole_number(value: object) -> bool:
    """True for a whole number, but not for a bool."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def _number_kind(least: float, most: float) -> _Kind:
    words = tr("{name} must be a number from {least} to {most}.")
    sentence = words.format(name="{name}", least=f"{least:g}", most=f"{most:g}")
    return _Kind(lambda given: least <= as_float(given) <= most, sentence)


_FLAG = _Kind(lambda given: isinstance(given, bool | np.bool_), tr("{name} must be True or False."))
_LENGTH = _Kind(
    lambda given: 1.0 / LARGEST_COORDINATE <= as_float(given) <= LARGEST_COORDINATE,
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
_STIFFNESS = _number_kind(0.0, MOST_STIFFNESS)

_KINDS = {
    **dict.fromkeys(("calm", "contact", "plain", "weld", "release", "tension_field", "held"), _FLAG),
    **dict.fromkeys(("stiffness", "area_stiffness", "shear_stiffness"), _STIFFNESS),
    **dict.fromkeys(("thickness", "yield_radius", "radius", "size"), _LENGTH),
    "wall_thickness": _Kind(lambda given: np.ndim(given) == 1 or _LENGTH.holds(given), _LENGTH.sentence),  # type: ignore[arg-type]
    **dict.fromkeys(("iterations", "steps", "buckling_modes.count"), _COUNT),
    **dict.fromkeys(("dented_shape.depth", "dented_shape.length", "open_mesh.chord"), _LENGTH),
    "open_mesh.edge": _number_kind(0.0, LARGEST_COORDINATE),
    "dented_shape.seed": _Kind(
        lambda given: is_whole_number(given) and given >= 0,  # type: ignore[operator]
        tr("{name} must be a whole number of at least 0."),
    ),
    "regions": _LIST,
    "poisson": _number_kind(0.0, 0.5),
    "hardening": _number_kind(0.0, MOST_HARDENING),
    "tolerance": _number_kind(1e-12, 1e9),
    **dict.fromkeys(
        ("gas", "filled_volume"),
        _Kind(
            lambda given: 0.0 < as_float(given) <= LARGEST_COORDINATE,
            tr("{name} must be a number greater than 0 and at most 1e38."),
        ),
    ),
    "pressure": _number_kind(-LARGEST_COORDINATE, LARGEST_COORDINATE),
    "container": _number_kind(0.0, LARGEST_COORDINATE),
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
    "origin": _Kind(
        lambda given: hasattr(given, "rewritten_content"), tr("{name} must be that of an opened mesh.")
    ),
}


def check_argument(name: str, value: object, kind: _Kind | None = None) -> None:
    """Raise InputError if an argument is not of the kind its name implies.

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
    """Wrap a function to check its arguments, except those left at their defaults."""
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
