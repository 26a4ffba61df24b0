"""Values memoised by array identity, released with the arrays."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import wraps
from typing import TypeVar

import numpy as np

from apd_viewer.geometry.energy import cell_bending
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.components import part_of_triangles
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.mesh.region_areas import region_areas
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, Soft, transform, what_is_missing
from apd_viewer.geometry.pose.falloff import Graph, distances, edge_graph, softened, strengths

T = TypeVar("T")


def once(find: Callable[..., T]) -> Callable[..., T]:
    """Memoise ``find`` by the identity of its arrays, shared between documents.

    What it finds is kept until one of the arrays is gone. What else is given counts by its value.
    """
    known: dict[tuple[object, ...], tuple[list[weakref.ref[np.ndarray]], T]] = {}

    @wraps(find)
    def found(*given: object) -> T:
        key = tuple(id(each) if isinstance(each, np.ndarray) else each for each in given)
        if key not in known:
            arrays = [each for each in given if isinstance(each, np.ndarray)]
            result = find(*given)
            known[key] = [weakref.ref(each, lambda _: known.pop(key, None)) for each in arrays], result
        return known[key][1]

    return found


problem = once(what_is_missing)


@once
def counts(labels: np.ndarray) -> np.ndarray:
    """Number of the vertices with each label or in each region, (256,) int array."""
    return frozen(np.bincount(labels, minlength=256))


@once
def centre(labels: np.ndarray, X: np.ndarray, label: int) -> np.ndarray:
    """Mean of the points of ``X`` (n, 3) with a label, (3,); there must be one."""
    # One axis at a time: ten times faster than all at once.
    return frozen(np.array([x.mean() for x in X[labels == label].T]))


@once
def in_place(V: np.ndarray, weld: Weld) -> float:
    """Tolerance of held vertices in place, mesh units."""
    return weld.in_place(diagonal(V))


@once
def rest_grip(
    V: np.ndarray, grip: np.ndarray, labels: np.ndarray, weld: Weld, *starts: np.ndarray
) -> np.ndarray | None:
    """Grip of held vertices with the earlier motions of their handles undone.

    Parameters
    ----------
    V : (n, 3) float array
        At rest: free vertices stay there.
    grip, labels : (n, 3), (n,) arrays
    weld : Weld
    starts : (4, 4) float arrays
        Pose of each handle at its grip.

    Returns
    -------
    (n, 3) float array or None
        None where that is the rest shape: to return that itself would keep it in memory.
    """
    found = V.copy()
    found[labels == BASE] = grip[labels == BASE]
    for label, start in enumerate(starts, HANDLE):
        mine = labels == label
        found[mine] = transform(np.linalg.inv(start), grip[mine])
    near = np.abs(found - V).max(axis=1) <= in_place(V, weld)
    found[near] = V[near]
    return None if near.all() else frozen(found)


@once
def is_displaced(V: np.ndarray, X: np.ndarray, labels: np.ndarray, label: int) -> bool:
    """True if vertices of a label are elsewhere in ``X`` (n, 3) than in ``V`` (n, 3)."""
    mine = labels == label
    return not np.array_equal(V[mine], X[mine])


@once
def rest_areas(V: np.ndarray, F: np.ndarray, member: np.ndarray, count: int) -> tuple[float, ...]:
    """Area of each region at rest."""
    return tuple(region_areas(V, F, member, count).tolist())


@once
def parts(F: np.ndarray) -> np.ndarray:
    """Lowest vertex of the connected part of each triangle of ``F``, (m,)."""
    return frozen(part_of_triangles(F))


@once
def triangle_areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Area of each triangle at rest, (m,) float array."""
    return frozen(face_areas(V, F))


cell_stiffness = once(cell_bending.cell_stiffness)


@once
def _graph(V: np.ndarray, F: np.ndarray) -> Graph:
    """Lengths of the edges, (n, n)."""
    return edge_graph(V, F)


@once
def _away(
    V: np.ndarray, F: np.ndarray, weld: Weld, labels: np.ndarray, label: int, reach: float
) -> np.ndarray:
    """Distance of every vertex from a label along the edges at rest, (n,)."""
    joined = weld.representative
    start = np.unique(joined[labels == label])
    return frozen(distances(_graph(V, F), start, reach)[joined])


@once
def soft(V: np.ndarray, F: np.ndarray, weld: Weld, labels: np.ndarray, falloffs: tuple[float, ...]) -> Soft:
    """Soft constraints of handles by their falloffs; ``F`` has welded vertices."""
    # A falloff being swept needs a new search only after doubling.
    reaches = [2.0 ** np.ceil(np.log2(r)) if r > 0.0 else 0.0 for r in falloffs]
    strength = np.zeros((len(falloffs), len(labels)))
    for k, (falloff, reach) in enumerate(zip(falloffs, reaches, strict=True)):
        if falloff > 0.0:
            strength[k] = strengths(_away(V, F, weld, labels, HANDLE + k, float(reach)), falloff)
    return softened(labels == FREE, strength, np.array(falloffs))
