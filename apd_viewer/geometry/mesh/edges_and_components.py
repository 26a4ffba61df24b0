"""Edges and components of triangles: half-edges, edge defects, flood fill.

Throughout, ``F`` is an (m, 3) int array of triangles, and ``opposite`` its :func:`opposite_half_edges`.
"""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import distinct_keys
from apd_viewer.language import tr, trn

BOUNDARY = -1  # edge of only one triangle
NON_MANIFOLD = -2  # edge of more than two triangles, or of one with a repeated corner
# Doubled area of a degenerate triangle, relative to its squared edges.
_NO_AREA = 1e-9


@njit(cache=True, nogil=True)
def opposite_half_edges(F: np.ndarray, n: int) -> np.ndarray:
    """Opposite half-edge of each half-edge of the triangles.

    Parameters
    ----------
    F : (m, 3) int array
    n : int
        Number of vertices.

    Returns
    -------
    (m, 3) int32 array
        ``3 * s + d`` for the edge from ``F[t, c]`` to ``F[t, (c + 1) % 3]`` if it is that of triangle ``s``
        between its corners ``d`` and ``(d + 1) % 3``, in either direction; ``BOUNDARY`` or ``NON_MANIFOLD``
        if there is no triangle or more than one. A triangle that has a corner twice counts for nothing.
    """
    start, edges = _edges_by_lower_end(F, n)
    opposite = np.full(F.size, NON_MANIFOLD, dtype=np.int32)
    seen_from, first = np.full(n, -1, dtype=np.int32), np.empty(n, dtype=np.int32)
    for v in range(n):
        for i in range(start[v], start[v + 1]):
            h = edges[i]
            t, c = h // 3, h % 3
            w = max(F[t, c], F[t, (c + 1) % 3])
            if seen_from[w] != v:
                seen_from[w], first[w] = v, h
                opposite[h] = BOUNDARY
            elif opposite[first[w]] == BOUNDARY:
                opposite[h], opposite[first[w]] = first[w], h
            elif opposite[first[w]] >= 0:
                opposite[opposite[first[w]]] = opposite[first[w]] = NON_MANIFOLD
    return opposite.reshape(F.shape)


@njit(cache=True, nogil=True)
def _edges_by_lower_end(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Half-edges ``3 t + c`` by lower end ``v``: ``start[v]`` up to ``start[v + 1]``."""
    start = np.zeros(n + 2, dtype=np.int32)
    for t in range(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        if i != j and j != k and k != i:
            start[min(i, j) + 2] += 1
            start[min(j, k) + 2] += 1
            start[min(k, i) + 2] += 1
    for v in range(n):
        start[v + 2] += start[v + 1]
    edges = np.empty(start[n + 1], dtype=np.int32)
    for t in range(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        if i != j and j != k and k != i:
            for h, v in ((3 * t, min(i, j)), (3 * t + 1, min(j, k)), (3 * t + 2, min(k, i))):
                edges[start[v + 1]] = h
                start[v + 1] += 1
    return start[:-1], edges


def undirected_edges(F: np.ndarray, n: int) -> np.ndarray:
    """Edges (e, 2) of triangles with ``n`` vertices, the lower end first, ascending."""
    a, b = F.ravel(), np.roll(F, -1, axis=1).ravel()
    low, high = np.minimum(a, b).astype(np.int64), np.maximum(a, b)
    key = distinct_keys((low * n + high)[low != high])
    return np.column_stack([key // n, key % n])


def boundary_edges(F: np.ndarray, opposite: np.ndarray) -> np.ndarray:
    """Edges (b, 2) of exactly one triangle, in its direction, by lower and higher end."""
    ends = _half_edge_ends(F, np.flatnonzero(opposite.ravel() == BOUNDARY))
    return ends[np.lexsort((ends.max(axis=1), ends.min(axis=1)))]


def boundary_vertices(F: np.ndarray, n: int) -> np.ndarray:
    """Vertices of boundary edges, ascending; ``n`` is the number of vertices."""
    return np.unique(boundary_edges(F, opposite_half_edges(F, n)))


def crowded_half_edges(F: np.ndarray, opposite: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Half-edges of non-manifold edges, by edge.

    Returns
    -------
    half_edges : (k,) int array
        ``3 t + c``; those of edge ``e`` are ``half_edges[start[e]:start[e + 1]]``.
    start : (edges + 1,) int array
    ends : (edges, 2) int array
        Ends of the edges, the lower one first.
    """
    crowded = np.flatnonzero(opposite.ravel() == NON_MANIFOLD)
    i, j, k = F[crowded // 3].T
    crowded = crowded[(i != j) & (j != k) & (k != i)]
    ends = np.sort(_half_edge_ends(F, crowded), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, is_first = ends[order], np.ones(len(order) + 1, dtype=bool)  # the last one is the end
    is_first[1:-1] = (ends[1:] != ends[:-1]).any(axis=1)
    start = np.flatnonzero(is_first)
    return crowded[order], start, ends[start[:-1]]


def _half_edge_ends(F: np.ndarray, half_edges: np.ndarray) -> np.ndarray:
    t, c = np.divmod(half_edges, 3)
    return np.column_stack([F[t, c], F[t, (c + 1) % 3]])


def missing_volume_reason(F: np.ndarray, opposite: np.ndarray) -> str | None:
    """Reason for a missing volume, as a phrase; None if the surface is closed.

    A surface is closed when every edge is used once in each direction.
    """
    border, crowded, one_way = edge_defect_counts(F, opposite)
    # Openings come last: they can be capped, whereas the defects before them cannot be repaired.
    if crowded:
        return trn(
            "the surface is not manifold ({n:,} edge with more than two faces)",
            "the surface is not manifold ({n:,} edges with more than two faces)",
            crowded,
        ).format(n=crowded)
    if one_way:
        return tr("the faces are not consistently oriented")
    if border:
        return trn(
            "the surface is open ({n:,} boundary edge)", "the surface is open ({n:,} boundary edges)", border
        ).format(n=border)
    return None


class EdgeDefectCounts(NamedTuple):
    """Counts of defective edges; triangles with a corner twice do not count.

    Attributes
    ----------
    border : int
        Edges of one triangle.
    crowded : int
        Non-manifold edges, of more than two.
    one_way : int
        Edges that two triangles pass in the same direction.
    """

    border: int
    crowded: int
    one_way: int


def edge_defect_counts(F: np.ndarray, opposite: np.ndarray) -> EdgeDefectCounts:
    """Counts of border, non-manifold and inconsistently oriented edges."""
    border, one_way = _border_and_one_way_edges(F, opposite)
    return EdgeDefectCounts(int(border), len(crowded_half_edges(F, opposite)[2]), int(one_way))


@njit(cache=True, nogil=True)
def _border_and_one_way_edges(F: np.ndarray, opposite: np.ndarray) -> tuple[int, int]:
    """Counts of edges of one triangle, and of those that two pass the same way."""
    border = one_way = 0
    for t in range(len(F)):
        for c in range(3):
            h = opposite[t, c]
            border += h == BOUNDARY
            one_way += h > 3 * t + c and F[h // 3, h % 3] == F[t, c]
    return border, one_way


@njit(cache=True, nogil=True)
def flood_fill(F: np.ndarray, opposite: np.ndarray, U: np.ndarray, face: int, crease: float) -> np.ndarray:
    """Vertices reached by flood fill from a face without crossing a crease.

    Triangles without area (less than 1e-9 of the squares of their edges) are always entered, and left as if
    they were part of the triangle from which they were entered.

    Parameters
    ----------
    F : (m, 3) int array
    opposite : (m, 3) int array
        Its :func:`opposite_half_edges`; edges of one triangle or of more than two are not crossed.
    U : (n, 3) float array
    face : int
        Where to begin.
    crease : float
        Edges with a larger angle are not crossed; radians, 0 is flat. It does not matter which way the
        triangles look.

    Returns
    -------
    (n,) bool array
    """
    reached, member = np.zeros(len(F), dtype=np.bool_), np.zeros(len(U), dtype=np.bool_)
    front, normals = np.empty(len(F), dtype=np.int32), np.empty((len(F), 3))
    least = np.cos(min(crease, np.pi)) - 1e-12  # rounding must not count as a crease
    reached[face], front[0], head, count = True, face, 0, 1
    normals[face] = _normal(U, F, face)
    while head < count:
        t = front[head]
        head += 1
        nx, ny, nz = normals[t, 0], normals[t, 1], normals[t, 2]
        for c in range(3):
            member[F[t, c]] = True
            h = opposite[t, c]
            if h < 0 or reached[h // 3]:
                continue
            s = h // 3
            x, y, z = _normal(U, F, s)
            side = -1.0 if F[s, h % 3] == F[t, c] else 1.0
            if x == y == z == 0.0:
                x, y, z = side * nx, side * ny, side * nz
            elif side * (x * nx + y * ny + z * nz) < least and not nx == ny == nz == 0.0:
                continue
            normals[s, 0], normals[s, 1], normals[s, 2] = x, y, z
            reached[s] = True
            front[count] = s
            count += 1
    return member


@njit(inline="always")
def _normal(U: np.ndarray, F: np.ndarray, t: int) -> tuple[float, float, float]:
    """Unit normal of triangle ``t``; zero if it has no area."""
    i, j, k = F[t, 0], F[t, 1], F[t, 2]
    ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
    bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    size = np.sqrt(x * x + y * y + z * z)
    if size <= _NO_AREA * (ax * ax + ay * ay + az * az + bx * bx + by * by + bz * bz):
        return 0.0, 0.0, 0.0
    return x / size, y / size, z / size


@njit(cache=True, nogil=True)
def vertex_components(F: np.ndarray, n: int) -> np.ndarray:
    """Number of the connected component of each vertex, from 0.

    Parameters
    ----------
    F : (m, 3) int array
    n : int
        Number of vertices.

    Returns
    -------
    (n,) int array
        Equal for two vertices exactly if a path of edges joins them.
    """
    # scipy's connected_components would hold the interpreter lock, and thus block the window.
    parent = np.arange(n)
    for t in range(F.shape[0]):
        for c in range(2):
            join(parent, F[t, c], F[t, c + 1])
    number, count = np.empty(n, dtype=np.int64), 0
    for v in range(n):
        if parent[v] == v:
            number[v] = count
            count += 1
        else:  # the parent is a lower vertex and already numbered
            number[v] = number[parent[v]]
    return number


class LooseComponent(NamedTuple):
    """Connected component with triangles but without held vertices.

    Attributes
    ----------
    first : int
        Its lowest vertex, which tells it from others.
    triangles : int
        How many it has.
    """

    first: int
    triangles: int


def face_components(F: np.ndarray) -> np.ndarray:
    """Lowest vertex of each triangle's connected component, for ``F`` (m, 3), (m,)."""
    number = vertex_components(F, int(F.max()) + 1)
    lowest = np.empty(number.max() + 1, dtype=np.int64)
    lowest[number[::-1]] = np.arange(len(number))[::-1]  # the last of repeated indices takes effect
    return lowest[number[F[:, 0]]]


def loose_components(component: np.ndarray, F: np.ndarray, is_held: np.ndarray) -> tuple[LooseComponent, ...]:
    """Components without held vertices, the largest first.

    Parameters
    ----------
    component : (m,) int array
        See :func:`face_components`.
    F : (m, 3) int array
    is_held : (n,) bool array
    """
    sizes = np.bincount(component)
    sizes[component[is_held[F].any(axis=1)]] = 0
    loose = np.flatnonzero(sizes)
    loose = loose[np.argsort(-sizes[loose], kind="stable")]
    return tuple(LooseComponent(int(first), int(sizes[first])) for first in loose)


@njit(cache=True, nogil=True)
def root(parent: np.ndarray, k: int) -> int:
    """Root of ``k`` in a union-find forest, the lowest of its set; with path halving."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@njit(cache=True, nogil=True)
def join(parent: np.ndarray, a: int, b: int) -> None:
    """Unite the sets of ``a`` and ``b`` in a union-find forest."""
    a, b = root(parent, a), root(parent, b)
    parent[max(a, b)] = min(a, b)
