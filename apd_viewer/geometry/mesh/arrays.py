"""Validated and read-only arrays."""

from __future__ import annotations

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trn


def frozen(array: np.ndarray) -> np.ndarray:
    """Return ``array`` marked read-only (in place: no copy)."""
    array.flags.writeable = False
    return array


def diagonal(points: np.ndarray) -> float:
    """Diagonal of the bounding box of points (k, 3); a corner may occur twice."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def mesh_size(V: np.ndarray, F: np.ndarray) -> float:
    """Diagonal of the bounding box of the triangles ``F`` (m, 3)."""
    used = np.zeros(len(V), dtype=bool)
    used[F.ravel()] = True
    return diagonal(V[used])


def local_origin(points: np.ndarray) -> np.ndarray:
    """Place (3,) from which points (k, 3) have small coordinates; the origin if near.

    A multiple of a power of two, at least four times the diagonal: subtracting and adding it rounds nothing
    but the last bit, and what lies about the origin keeps its coordinates.
    """
    low, high = 0.5 * points.min(axis=0), 0.5 * points.max(axis=0)  # halves: a whole size may overflow
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
    """Float64 copy of a caller's array, or InputError."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "iuf":
        raise InputError(
            tr("{what} must be an array of real numbers with rows of equal length.").format(what=name)
        )
    return array.astype(np.float64)


def checked_vectors(value: object, count: int, name: str) -> np.ndarray:
    """``value`` (count, 3) as floats; raises InputError unless they are finite."""
    array = checked_floats(value, name)
    if array.shape != (count, 3) or not np.isfinite(array).all():
        raise InputError(tr("{what} must be {n:,} finite vectors.").format(what=name, n=count))
    return array


def checked_point(value: object) -> np.ndarray:
    """``value`` (3,) as floats; raises InputError unless it is a point."""
    x = _three(value)
    if x is None:
        raise InputError(tr("A place must be three finite numbers."))
    return x


def checked_direction(value: object) -> np.ndarray:
    """``value`` (3,) with a length of 1; raises InputError unless it has a direction."""
    x = _three(value)
    length = 0.0 if x is None else float(np.linalg.norm(x))
    if x is None or not 0.0 < length < np.inf:
        raise InputError(tr("A direction must be three numbers, not all of them 0."))
    return x / length


def _three(value: object) -> np.ndarray | None:
    try:
        x = np.asarray(value)
    except ValueError:  # rows of different lengths
        return None
    x = x.astype(float) if x.dtype.kind in "iuf" else np.empty(0)
    return x if x.shape == (3,) and np.isfinite(x).all() else None


def checked_integers(value: object, name: str) -> np.ndarray:
    """Int64 copy of a caller's array; InputError if rounding would be needed."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "b":
        said = tr("{what} must be vertex IDs, not a mask; give numpy.flatnonzero(mask).")
        raise InputError(said.format(what=name))
    array = checked_floats(value, name)
    if not (np.abs(array) < 2.0**53).all() or (array != np.rint(array)).any():
        raise InputError(tr("{what} must be whole numbers: vertex IDs, counted from 0.").format(what=name))
    return array.astype(np.int64)


def mesh_arrays(V: object, F: object) -> tuple[np.ndarray, np.ndarray]:
    """Copies of a caller's arrays (n, 3) and (m, 3); InputError if no mesh."""
    arrays = checked_floats(V, tr("Vertices")), checked_integers(F, tr("Faces"))
    check_mesh(*arrays)
    return arrays


def check_mesh(V: np.ndarray, F: np.ndarray) -> None:
    """Raise InputError unless ``V`` (n, 3), ``F`` (m, 3) are a mesh with area."""
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
