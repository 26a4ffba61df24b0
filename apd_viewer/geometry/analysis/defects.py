"""Topological defects: borders, non-manifold edges and vertices, flipped faces."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.edges_and_components import boundary_edges, crowded_half_edges, join

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


def defects(F: np.ndarray, opposite: np.ndarray) -> Defects:
    """Defects of triangles ``F`` (m, 3), each with three distinct corners.

    ``opposite`` (m, 3) are their :func:`.opposite_half_edges`.
    """
    crowded, start, ends = crowded_half_edges(F, opposite)
    corner, face, side, doubled, one_sided = _match_half_edges(F, opposite, crowded, start)
    fans = F.ravel()[corner == np.arange(len(corner))]  # one corner of each fan of triangles
    return Defects(
        boundary_edges=boundary_edges(F, opposite),
        non_manifold_edges=ends,
        non_manifold_vertices=np.flatnonzero(np.bincount(fans) > 1),
        flipped_faces=_minority_triangles(face, side),
        duplicate_faces=np.flatnonzero(doubled),
        is_non_orientable=bool(one_sided),
    )


def _minority_triangles(face: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Triangles of the minority orientation within their connected component.

    Of two halves it is the one without the first triangle.
    """
    count = np.bincount(2 * face + side, minlength=2 * len(face)).reshape(-1, 2)
    own, other = count[face, side], count[face, 1 - side]
    return np.flatnonzero((own < other) | ((own == other) & (side == 1)))


@njit(cache=True, nogil=True)
def _match_half_edges(
    F: np.ndarray, opposite: np.ndarray, crowded: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, bool]:
    """Match half-edges across manifold edges, and across ``crowded`` ones.

    ``crowded`` are half-edges ``3 t + c``, sorted by edge; those of edge ``k`` begin at ``start[k]``.

    Returns
    -------
    corner : (3 m,) int array
        A union-find forest of the corners that edges join.
    face, side : (m,) int arrays
        For every triangle one that stands for all it hangs together with, and whether it looks the other way.
    doubled : (m,) bool array
    one_sided : bool
    """
    m = len(F)
    corner, face = np.arange(3 * m, dtype=np.int32), np.arange(m, dtype=np.int32)
    side, doubled, one_sided = np.zeros(m, dtype=np.int8), np.zeros(m, dtype=np.bool_), False
    for g in range(3 * m):
        h = opposite[g // 3, g % 3]
        if h > g:
            same_way, has_same_corners = _join_corners(F, corner, g, h)
            if has_same_corners:
                doubled[max(g, h) // 3] = True
            else:
                one_sided |= not _unite_triangles(face, side, g // 3, h // 3, same_way)
    for k in range(len(start) - 1):
        for i in range(start[k] + 1, start[k + 1]):
            for j in range(max(start[k], i - _MOST_AT_AN_EDGE), i):
                _, has_same_corners = _join_corners(F, corner, crowded[j], crowded[i])
                if has_same_corners:
                    doubled[crowded[i] // 3] = True
    for t in range(m):
        face[t], side[t] = _root_and_side(face, side, t)
    return corner, face, side, doubled, one_sided


@njit(cache=True, nogil=True)
def _join_corners(F: np.ndarray, corner: np.ndarray, g: int, h: int) -> tuple[bool, bool]:
    """Join the corners at the ends of two half-edges ``3 t + c`` of one edge.

    Returns
    -------
    same_way : bool
        Whether both run in the same direction.
    has_same_corners : bool
        Whether the triangles have the same corners.
    """
    s, c, t, d = g // 3, g % 3, h // 3, h % 3
    after_c, after_d = (c + 1) % 3, (d + 1) % 3
    same_way = F[s, c] == F[t, d]
    join(corner, g, h if same_way else 3 * t + after_d)
    join(corner, 3 * s + after_c, 3 * t + after_d if same_way else h)
    return same_way, F[s, 3 - c - after_c] == F[t, 3 - d - after_d]


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
