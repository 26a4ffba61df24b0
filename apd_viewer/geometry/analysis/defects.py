"""Topological defects: borders, non-manifold edges and vertices, flipped faces."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.components import join, root

# Number of preceding faces at an edge that each face is compared with.
_MOST_AT_AN_EDGE = 64


class Defects(NamedTuple):
    """Topological defects of the triangles ``F`` (m, 3).

    Attributes
    ----------
    boundary_edges : (b, 2) int array
        Ends of the edges of one triangle.
    non_manifold_edges : (c, 2) int array
        Ends of the edges of more than two.
    non_manifold_vertices : (v,) int array
        Vertices at which surfaces meet that have no edge there in common.
    flipped_faces : (f,) int array
        Triangles that look the other way than most of those they hang together with.
    duplicate_faces : (d,) int array
        Triangles with the same corners as another.
    is_non_orientable : bool
        Whether no choice of sides would make all neighbours look the same way.
    """

    boundary_edges: np.ndarray
    non_manifold_edges: np.ndarray
    non_manifold_vertices: np.ndarray
    flipped_faces: np.ndarray
    duplicate_faces: np.ndarray
    is_non_orientable: bool


def defects(F: np.ndarray, n: int) -> Defects:
    """Defects of triangles ``F`` (m, 3), each with three distinct corners."""
    F = np.ascontiguousarray(F)
    a, b = F.ravel(), np.roll(F, -1, axis=1).ravel()
    low, high = np.minimum(a, b), np.maximum(a, b)
    order = _sorted_by(low, _sorted_by(high, np.arange(len(high)), n), n)
    uses, corner, face, side, doubled, one_sided = _match_half_edges(F, low[order], high[order], order)
    edges = np.column_stack([a, b])
    fans = a[corner == np.arange(len(corner))]  # one corner of each fan of triangles
    many = np.flatnonzero(np.bincount(fans, minlength=n) > 1)
    return Defects(
        boundary_edges=edges[order[uses == 1]],
        non_manifold_edges=edges[order[uses > 2]],
        non_manifold_vertices=many,
        flipped_faces=_minority_triangles(face, side),
        duplicate_faces=np.flatnonzero(doubled),
        is_non_orientable=bool(one_sided),
    )


def _minority_triangles(face: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Triangles of the minority orientation within their connected component."""
    count = np.bincount(2 * face + side, minlength=2 * len(face)).reshape(-1, 2)
    return np.flatnonzero(count[face, side] < count[face, 1 - side])


@njit(cache=True, nogil=True)
def _sorted_by(key: np.ndarray, order: np.ndarray, n: int) -> np.ndarray:
    """``order`` sorted stably by ``key`` (k,), all keys below ``n``."""
    start = np.zeros(n + 1, dtype=np.int64)
    for k in key:
        start[k + 1] += 1
    for k in range(n):
        start[k + 1] += start[k]
    out = np.empty_like(order)
    for i in order:
        out[start[key[i]]] = i
        start[key[i]] += 1
    return out


@njit(cache=True, nogil=True)
def _match_half_edges(
    F: np.ndarray, low: np.ndarray, high: np.ndarray, order: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, bool]:
    """Match half-edges by end vertices ``low`` and ``high``, sorted by ``order``.

    Returns
    -------
    uses : (3 m,) int array
        For the first half of every edge how many there are; 0 for the others.
    corner : (3 m,) int array
        For every corner one that stands for all that edges join it with.
    face, side : (m,) int arrays
        For every triangle one that stands for all it hangs together with, and whether it looks the other way.
    doubled : (m,) bool array
    one_sided : bool
    """
    m = len(F)
    uses = np.zeros(3 * m, dtype=np.int64)
    corner, face = np.arange(3 * m), np.arange(m)
    side, doubled, one_sided = np.zeros(m, dtype=np.int64), np.zeros(m, dtype=np.bool_), False
    begin = 0
    while begin < 3 * m:
        end = begin + 1
        while end < 3 * m and low[end] == low[begin] and high[end] == high[begin]:
            end += 1
        uses[begin] = end - begin
        for i in range(begin + 1, end):
            s, c = order[i] // 3, order[i] % 3
            for j in range(max(begin, i - _MOST_AT_AN_EDGE), i):
                t, d = order[j] // 3, order[j] % 3
                same_way = F[s, c] == F[t, d]
                join(corner, 3 * s + c, 3 * t + (d if same_way else (d + 1) % 3))
                join(corner, 3 * s + (c + 1) % 3, 3 * t + ((d + 1) % 3 if same_way else d))
                if F[s, (c + 2) % 3] == F[t, (d + 2) % 3]:
                    doubled[max(s, t)] = True
                elif end - begin == 2:
                    one_sided |= not _unite_triangles(face, side, s, t, same_way)
        begin = end
    for k in range(3 * m):
        corner[k] = root(corner, k)
    for k in range(m):
        face[k], side[k] = _root_and_side(face, side, k)
    return uses, corner, face, side, doubled, one_sided


@njit(cache=True, nogil=True)
def _root_and_side(parent: np.ndarray, side: np.ndarray, k: int) -> tuple[int, int]:
    """Root of ``k`` and orientation relative to it, with path compression."""
    first, turned = k, 0
    while parent[first] != first:
        turned ^= side[first]
        first = parent[first]
    rest = turned
    while parent[k] != first and k != first:
        above, own = parent[k], side[k]
        parent[k], side[k] = first, rest
        rest ^= own
        k = above
    return first, turned


@njit(cache=True, nogil=True)
def _unite_triangles(parent: np.ndarray, side: np.ndarray, s: int, t: int, same_way: bool) -> bool:
    """Unite two triangles across an edge; False if their orientations conflict."""
    a, turned_a = _root_and_side(parent, side, s)
    b, turned_b = _root_and_side(parent, side, t)
    differ = turned_a ^ turned_b
    if a == b:
        return (differ == 1) == same_way
    low, high = min(a, b), max(a, b)
    parent[high] = low
    side[high] = differ ^ (1 if same_way else 0)
    return True
