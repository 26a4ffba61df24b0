"""Self-intersections of a surface, by a spatial tree and exact predicates.

Which edges are near which triangles is found by a library, in a tree. Whether they meet is looked at here:
it matters where, and not only that they do, and triangles that overlap in one plane count as well.
"""

from __future__ import annotations

import math
from itertools import pairwise
from types import ModuleType
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen, used_vertices
from apd_viewer.language import tr

# Distances below this fraction of the mesh size count as contact; relative rounding error of a determinant.
_TOUCH = 1e-12
_ROUNDING = 1e-14
# Pairs per batch: enough for efficient array operations with little memory.
_PORTION = 200_000
# Triangles searched at once: edges and tree of so many take 0.7 GB.
MOST_AT_ONCE = 1_000_000
# Pairs of triangles with a common point of their boxes that are searched at once: 2.4 GB and 14 s. In a heap
# slabs of space do not part them, and all at once would take all memory.
MOST_PAIRS_AT_ONCE = 5_000_000
_NEIGHBOURS = 20  # whose boxes meet that of a triangle in any surface
_MOST_SLABS = 100
# Triangles that are sampled, as many as are compared with so many boxes.
_SAMPLE, _LEAST_SAMPLE, _MOST_BOXES = 200, 20, 10_000_000
# Of a hash of cells in space.
_PRIMES, _CELLS = np.array([73_856_093, 19_349_663, 83_492_791]), 1 << 20


class _Edges(NamedTuple):
    """Edges of triangles; those at edge e are ``face[start[e] : start[e + 1]]``."""

    ends: np.ndarray
    start: np.ndarray
    face: np.ndarray

    @classmethod
    def from_triangles(cls, F: np.ndarray, n: int) -> _Edges:
        a, b = F.ravel(), np.roll(F, -1, axis=1).ravel()
        key, edge = np.unique(np.minimum(a, b) * n + np.maximum(a, b), return_inverse=True)
        start = np.concatenate([[0], np.cumsum(np.bincount(edge, minlength=len(key)))])
        return cls(np.column_stack([key // n, key % n]), start, np.argsort(edge, kind="stable") // 3)

    def with_faces(self, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Index into ``edge`` (k,) and triangle index, for each incident triangle."""
        count = self.start[edge + 1] - self.start[edge]
        which = np.repeat(np.arange(len(edge)), count)
        within = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
        return which, self.face[self.start[edge][which] + within]


def crossings(U: np.ndarray, F: np.ndarray) -> np.ndarray | None:
    """Triangles piercing or overlapping another one.

    Vertices or edges lying on another triangle do not count, as at T-junctions; nor do two triangles with a
    common edge, however sharp the fold.

    Parameters
    ----------
    U : (n, 3) float array
        Positions of the vertices of the solve mesh: of those at one place only one is named by ``F``.
    F : (m, 3) int array

    Returns
    -------
    (k,) int array or None
        Ascending. None where they are not known: in a heap, or where the library is missing, which is not
        made for every machine.
    """
    try:
        pairs = crossing_pairs(U, F)
    except InputError:
        return None
    return None if pairs is None else frozen(np.unique(pairs))


def crossing_pairs(U: np.ndarray, F: np.ndarray) -> np.ndarray | None:
    """Pairs of triangles piercing or overlapping each other, (p, 2) int array.

    Some pairs occur twice, in either order. See :func:`crossings`. Raises InputError for a heap: thousands of
    triangles in one place, of which nearly each passes through all others.
    """
    try:
        import ipctk  # Imported here: few runs of the program need it.
    except ImportError:
        return None
    proper = np.flatnonzero((F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0]))
    F = F[proper].astype(np.int64)
    if not len(F):
        return np.zeros((0, 2), dtype=np.int64)
    X = _unit_size_positions(U, F)
    return np.concatenate([proper[slab[_pairs_within(ipctk, X, F[slab])]] for slab in _slabs(X, F)])


def _near_pairs(X: np.ndarray, F: np.ndarray) -> float:
    """Estimate of the pairs of triangles ``F`` (m, 3) in each other's way.

    Of a sample, in which triangles with large boxes, and those that share their place with many, are as much
    likelier as they are likely to be in a heap: that may be a small part of the mesh.
    """
    corners = X[F]
    low, high = corners.min(axis=1), corners.max(axis=1)
    size = (high - low).max(axis=1) + 1e-9
    mean = float(size.mean())
    cell = np.floor(corners[:, 0] / mean).astype(np.int64) @ _PRIMES % _CELLS
    chance = (size + mean) ** 2 * np.bincount(cell)[cell]
    chance /= chance.sum()
    axis = int(np.argmax(np.ptp(X, axis=0)))
    order = np.argsort(low[:, axis])
    first, widest = low[order, axis], float(size.max())
    sample = np.random.default_rng(0).choice(len(F), _SAMPLE, p=chance)
    begin = np.searchsorted(first, low[sample, axis] - widest)
    end = np.searchsorted(first, high[sample, axis], side="right")
    sample = sample[: max(_LEAST_SAMPLE, int((np.cumsum(end - begin) <= _MOST_BOXES).sum()))]
    pairs = 0.0
    for i, some in zip(sample, map(slice, begin, end), strict=False):
        others = order[some]
        meet = int(((low[others] <= high[i]) & (high[others] >= low[i])).all(axis=1).sum())
        pairs += 0.5 * max(meet - _NEIGHBOURS, 0) / chance[i]
    return pairs / len(sample)


def _slabs(X: np.ndarray, F: np.ndarray) -> list[np.ndarray]:
    """Triangles (k,) that reach into each slab of space across the longest axis.

    Two triangles that meet both reach into the slab where they do. Raises InputError for a heap.
    """
    pairs = _near_pairs(X, F)
    # Twice as many slabs as pairs ask for, since triangles at a cut are in both.
    share = max(len(F) / MOST_AT_ONCE, 2.0 * pairs / MOST_PAIRS_AT_ONCE)
    count = min(math.ceil(share), _MOST_SLABS)
    along = X[:, np.argmax(np.ptp(X, axis=0))]
    a, b, c = (along[corner] for corner in F.T)
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    cuts = np.quantile(low, np.arange(1, count) / count, method="lower")  # so that no slab is empty
    ends = pairwise([-np.inf, *cuts, np.inf])
    slabs = [np.flatnonzero((high >= begin) & (low <= end)) for begin, end in ends]
    for slab in slabs if pairs > MOST_PAIRS_AT_ONCE else ():
        if _near_pairs(X, F[slab]) > MOST_PAIRS_AT_ONCE:
            said = tr(
                "{n:,} triangles lie in a heap, each through nearly all others, which is too much to search; "
                "remove parts that repeat or are scrambled, or turn contact off."
            )
            raise InputError(said.format(n=len(slab)))
    return slabs


def _pairs_within(ipctk: ModuleType, X: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Pairs (p, 2) of triangles ``F`` (m, 3) piercing or overlapping each other."""
    vertices = used_vertices(F)
    number = np.empty(len(X), dtype=np.int64)
    number[vertices] = np.arange(len(vertices))
    X, F = X[vertices], number[F]
    edges, tree = _Edges.from_triangles(F, len(X)), ipctk.LBVH()
    tree.build(np.asfortranarray(X), edges.ends.astype(np.int32), np.asfortranarray(F, dtype=np.int32))
    near = tree.detect_edge_face_candidates()  # excludes pairs with a common vertex
    numbers = (number for pair in near for number in (pair.edge_id, pair.face_id))
    pairs = np.fromiter(numbers, np.int64, 2 * len(near)).reshape(-1, 2)
    del near
    found = [np.zeros((0, 2), dtype=np.int64)]
    for first in range(0, len(pairs), _PORTION):
        edge, face = pairs[first : first + _PORTION].T
        pierces, lies = _piercing_and_coplanar(X, edges.ends[edge], F[face])
        which, other = edges.with_faces(edge[pierces])
        found.append(np.column_stack([other, face[pierces][which]]))
        which, other = edges.with_faces(edge[lies])
        face = face[lies][which]
        over = _overlap_mask(X, F[face], F[other])
        found.append(np.column_stack([other[over], face[over]]))
    return np.concatenate(found)


def _unit_size_positions(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Positions centred and scaled to unit size, for a single-precision library."""
    used = np.zeros(len(U), dtype=bool)
    used[F.ravel()] = True
    low, high = U[used].min(axis=0), U[used].max(axis=0)
    X = (U - (low + high) / 2.0) / (float((high - low).max()) or 1.0)
    X[~used] = 0.0
    return X


def _heights(X: np.ndarray, T: np.ndarray, *vertices: np.ndarray) -> list[np.ndarray]:
    """Sides of the ``vertices`` (k,) relative to the planes of ``T`` (k, 3): -1, 0, 1."""
    a, b, c = (X[T[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    twice = np.linalg.norm(normal, axis=1)
    reach = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    sides = []
    for vertex in vertices:
        away = X[vertex] - a
        height = np.einsum("ij,ij->i", away, normal)
        least = _TOUCH * twice + _ROUNDING * reach * np.linalg.norm(away, axis=1)
        sides.append(np.where(np.abs(height) > least, np.sign(height), 0.0))
    return sides


def _piercing_and_coplanar(X: np.ndarray, ends: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Masks of the edges ``ends`` (k, 2) piercing ``T`` (k, 3), and coplanar with it."""
    above, below = _heights(X, T, ends[:, 0], ends[:, 1])
    pierces = above * below < 0.0
    p, q = X[ends[pierces, 0]], X[ends[pierces, 1]]
    a, b, c = (X[T[pierces, corner]] - p for corner in range(3))
    turns = [np.einsum("ij,ij->i", q - p, np.cross(*side)) for side in ((a, b), (b, c), (c, a))]
    pierces[pierces] = np.all(np.array(turns) >= 0.0, axis=0) | np.all(np.array(turns) <= 0.0, axis=0)
    return pierces, (above == 0.0) & (below == 0.0)


def _overlap_mask(X: np.ndarray, S: np.ndarray, T: np.ndarray) -> np.ndarray:
    """Mask of the coplanar pairs of ``S`` (k, 3) and ``T`` (k, 3) with common area."""
    over = (S[:, :, None] == T[:, None, :]).sum(axis=(1, 2)) < 2
    for side in _heights(X, S, *T.T):
        over &= side == 0.0
    s, t = X[S[over]], X[T[over]]
    across = np.cross(s[:, 1] - s[:, 0], s[:, 2] - s[:, 0])
    apart = ~across.any(axis=1)
    for triangle in (s, t):
        for corner in range(3):
            axis = np.cross(across, triangle[:, corner] - triangle[:, corner - 1])
            axis /= np.maximum(np.linalg.norm(axis, axis=1), np.finfo(float).tiny)[:, None]
            one, other = np.einsum("ijk,ik->ij", s, axis), np.einsum("ijk,ik->ij", t, axis)
            apart |= np.minimum(one.max(axis=1), other.max(axis=1)) <= (
                np.maximum(one.min(axis=1), other.min(axis=1)) + _TOUCH
            )
    over[over] = ~apart
    return over


def use_one_core_for_search() -> None:
    """Limit the library for intersection candidates to one core, if installed."""
    try:
        import ipctk  # Imported here: few runs of the program need it.
    except ImportError:
        return
    ipctk.set_num_threads(1)
