"""Values memoised by array identity, released with the arrays."""

import weakref
from collections.abc import Callable
from functools import wraps
from typing import TypeVar

import numpy as np

from apd_viewer.geometry.analysis import deviation
from apd_viewer.geometry.energy import cell_bending
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.edges_and_components import face_components
from apd_viewer.geometry.mesh.operators import face_areas, region_areas
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.geometry.pose import constraints
from apd_viewer.geometry.pose.falloff import distances, edge_graph, falloff_strengths, soft_constraints

T = TypeVar("T")


def memoised(compute: Callable[..., T]) -> Callable[..., T]:
    """Memoise ``compute`` by the identity of its arrays, shared between documents.

    Results are kept as long as all of the arrays. Other arguments are compared by value.
    """
    known: dict[tuple[object, ...], tuple[list[weakref.ref[np.ndarray]], T]] = {}

    @wraps(compute)
    def found(*given: object) -> T:
        key = tuple(id(each) if isinstance(each, np.ndarray) else each for each in given)
        if key not in known:
            arrays = [each for each in given if isinstance(each, np.ndarray)]
            result = compute(*given)
            known[key] = [weakref.ref(each, lambda _: known.pop(key, None)) for each in arrays], result
        return known[key][1]

    return found


paint_problem = memoised(constraints.next_paint_sentence)


@memoised
def label_counts(labels: np.ndarray) -> np.ndarray:
    """Number of vertices with each label or in each region, (256,) int array."""
    return frozen(np.bincount(labels, minlength=256))


@memoised
def label_centre(labels: np.ndarray, X: np.ndarray, label: int) -> np.ndarray:
    """Mean (3,) of the points ``X`` (n, 3) with a label in use."""
    # One axis at a time: ten times faster than all at once.
    return frozen(np.array([x.mean() for x in X[labels == label].T]))


@memoised
def in_place_tolerance(V: np.ndarray, weld: Weld) -> float:
    """Tolerated distance of held vertices from rest, mesh units."""
    return weld.in_place_tolerance(diagonal(V))


@memoised
def initial_positions_from_rest(
    V: np.ndarray, initial: np.ndarray, labels: np.ndarray, weld: Weld, *starts: np.ndarray
) -> np.ndarray | None:
    """Positions of held vertices before the earlier motions of their handles.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    initial, labels : (n, 3), (n,) arrays
        Positions after the earlier motions, and labels.
    starts : (4, 4) float arrays
        Pose of each handle, relative to rest, at its initial position.

    Returns
    -------
    (n, 3) float array or None
        None for the rest shape itself: a cached result would keep it in memory.
    """
    found = V.copy()
    found[labels == constraints.BASE] = initial[labels == constraints.BASE]
    for label, start in enumerate(starts, constraints.HANDLE):
        mine = labels == label
        found[mine] = constraints.transform(np.linalg.inv(start), initial[mine])
    near = np.abs(found - V).max(axis=1) <= in_place_tolerance(V, weld)
    found[near] = V[near]
    return None if near.all() else frozen(found)


@memoised
def is_displaced(V: np.ndarray, X: np.ndarray, labels: np.ndarray, label: int) -> bool:
    """True if vertices with a label differ between ``X`` (n, 3) and ``V`` (n, 3)."""
    mine = labels == label
    return not np.array_equal(V[mine], X[mine])


@memoised
def rest_areas(V: np.ndarray, F: np.ndarray, member: np.ndarray, count: int) -> tuple[float, ...]:
    """Area of each region at rest."""
    return tuple(region_areas(V, F, member, count).tolist())


@memoised
def triangle_components(F: np.ndarray) -> np.ndarray:
    """Lowest vertex of the connected part of each triangle of ``F``, (m,)."""
    return frozen(face_components(F))


@memoised
def triangle_areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Area of each triangle at rest, (m,) float array."""
    return frozen(face_areas(V, F))


tightest_bend = memoised(deviation.tightest_bend)


cell_stiffness = memoised(cell_bending.cell_stiffness)


_graph = memoised(edge_graph)


@memoised
def _label_distances(
    V: np.ndarray, F: np.ndarray, weld: Weld, labels: np.ndarray, label: int, reach: float
) -> np.ndarray:
    """Distance of every vertex from a label along the edges at rest, (n,)."""
    joined = weld.representative
    start = np.unique(joined[labels == label])
    return frozen(distances(_graph(V, F), start, reach)[joined])


@memoised
def falloff_constraints(
    V: np.ndarray, F: np.ndarray, weld: Weld, labels: np.ndarray, falloffs: tuple[float, ...]
) -> constraints.SoftConstraints:
    """Soft constraints of handles by their falloffs; ``F`` has welded vertices."""
    # Rounded up to powers of two, so that sweeping a falloff rarely needs a new search.
    reaches = [2.0 ** np.ceil(np.log2(r)) if r > 0.0 else 0.0 for r in falloffs]
    strength = np.zeros((len(falloffs), len(labels)))
    for k, (falloff, reach) in enumerate(zip(falloffs, reaches, strict=True)):
        if falloff > 0.0:
            strength[k] = falloff_strengths(
                _label_distances(V, F, weld, labels, constraints.HANDLE + k, float(reach)), falloff
            )
    return soft_constraints(labels == constraints.FREE, strength, np.array(falloffs))
