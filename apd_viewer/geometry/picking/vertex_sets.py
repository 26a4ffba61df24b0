"""Sets of vertices, modified by connectivity and shape.

A set is an (n,) bool array. At a seam one vertex represents each position, as in the triangles and one-rings
of :class:`SurfaceIndex`; the membership of the other vertices is ignored.
"""

import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.edges_and_components import boundary_edges, vertex_components
from apd_viewer.geometry.pose.mirror import MirrorPlane

# Smoothing changes nothing beyond this many rings from the border.
RINGS = 5
_ROUNDING = 1e-9


@njit(cache=True, nogil=True)
def grown_set(start: np.ndarray, neighbour: np.ndarray, member: np.ndarray) -> np.ndarray:
    """Dilation of a set by one ring of neighbours.

    Parameters
    ----------
    start : (n + 1,) int array
    neighbour : (k,) int array
        The one-ring graph of :func:`apd_viewer.geometry.mesh.operators.vertex_neighbours`.
    member : (n,) bool array

    Returns
    -------
    (n,) bool array
    """
    out = member.copy()
    for v in range(len(member)):
        if member[v]:
            for e in range(start[v], start[v + 1]):
                out[neighbour[e]] = True
    return out


def shrunk_set(start: np.ndarray, neighbour: np.ndarray, member: np.ndarray) -> np.ndarray:
    """Erosion of a set by one ring; the counterpart of :func:`grown_set`."""
    return ~grown_set(start, neighbour, ~member)


def smoothed_set(start: np.ndarray, neighbour: np.ndarray, U: np.ndarray, member: np.ndarray) -> np.ndarray:
    """The set with a smoother border.

    Membership spreads over the edges, the more the shorter they are, for as many steps as ``RINGS``; a vertex
    then belongs to the set if more than half of it does.

    Parameters
    ----------
    start, neighbour : int arrays
        As for :func:`grown_set`.
    U : (n, 3) float array
    member : (n,) bool array

    Returns
    -------
    (n,) bool array
    """
    border = grown_set(start, neighbour, member) & ~shrunk_set(start, neighbour, member)
    near = _vertices_within(start, neighbour, np.flatnonzero(border), RINGS - 1)
    return _averaged_members(start, neighbour, U, member, near)


@njit(cache=True, nogil=True)
def _averaged_members(
    start: np.ndarray, neighbour: np.ndarray, U: np.ndarray, member: np.ndarray, near: np.ndarray
) -> np.ndarray:
    """Set after its membership is averaged near its border, at ``near`` (k,)."""
    share, after, out = member.astype(np.float64), np.empty(len(near)), member.copy()
    for _ in range(RINGS):
        for i in range(len(near)):
            after[i] = 0.5 * (share[near[i]] + _mean_around(start, neighbour, U, share, near[i]))
        share[near] = after
    for v in near:
        if abs(share[v] - 0.5) > _ROUNDING:
            out[v] = share[v] > 0.5
        share[v] = out[v]
    # A regular zigzag border averages to one half everywhere; updating in place breaks the tie.
    for v in near:
        around = _mean_around(start, neighbour, U, share, v)
        if abs(around - 0.5) > _ROUNDING:
            out[v] = around > 0.5
            share[v] = out[v]
    return out


@njit(inline="always")
def _length(U: np.ndarray, v: int, w: int) -> float:
    x, y, z = U[w, 0] - U[v, 0], U[w, 1] - U[v, 1], U[w, 2] - U[v, 2]
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True, nogil=True)
def _mean_around(start: np.ndarray, neighbour: np.ndarray, U: np.ndarray, share: np.ndarray, v: int) -> float:
    """Mean ``share`` of the neighbours of ``v``, weighted by inverse edge lengths."""
    total = weights = 0.0
    for e in range(start[v], start[v + 1]):
        # A coincident neighbour outweighs all others, while the sum stays finite.
        weight = 1.0 / max(_length(U, v, neighbour[e]), 1e-290)
        total += weight * share[neighbour[e]]
        weights += weight
    return total / weights


def mirrored_set(
    start: np.ndarray, neighbour: np.ndarray, U: np.ndarray, member: np.ndarray, plane: MirrorPlane
) -> np.ndarray:
    """Vertices nearest to the mirror images of the members of a set.

    A member has none if no vertex is as near to its image as half the mean length of its edges.

    Parameters
    ----------
    start, neighbour : int arrays
        As for :func:`grown_set`.
    U : (n, 3) float array
    member : (n,) bool array
    plane : MirrorPlane

    Returns
    -------
    (n,) bool array
    """
    named, out = np.diff(start) > 0, np.zeros(len(U), dtype=bool)
    mine = np.flatnonzero(member & named)
    reach = 0.5 * _mean_edge(start, neighbour, U, mine)
    found = nearest_mirror_vertices(U, mine, named, plane, reach)
    out[found[found >= 0]] = True
    return out


@njit(cache=True, nogil=True)
def _mean_edge(start: np.ndarray, neighbour: np.ndarray, U: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Mean edge length at each of the ``vertices`` (k,), none of them isolated."""
    mean = np.zeros(len(vertices))
    for i in range(len(vertices)):
        v = vertices[i]
        for e in range(start[v], start[v + 1]):
            mean[i] += _length(U, v, neighbour[e])
        mean[i] /= start[v + 1] - start[v]
    return mean


def nearest_mirror_vertices(
    V: np.ndarray, ids: np.ndarray, candidates: np.ndarray, plane: MirrorPlane, reach: np.ndarray
) -> np.ndarray:
    """Vertex nearest to the mirror image of each of the given vertices.

    Parameters
    ----------
    V : (n, 3) float array
    ids : (k,) int array
    candidates : (n,) bool array
        Vertices that count.
    plane : MirrorPlane
    reach : (k,) float array
        Largest distance of each from its image, mesh units.

    Returns
    -------
    (k,) int array
        -1 where none is within reach.
    """
    found = np.full(len(ids), -1)
    if not len(ids):
        return found
    images = plane.image(V[ids])
    low, high = images.min(axis=0) - reach.max(), images.max(axis=0) + reach.max()
    others = np.flatnonzero(candidates & ((low <= V) & (high >= V)).all(axis=1))
    if len(others):
        # A balanced, compact tree would not be worth building for a single query.
        tree = KDTree(V[others], balanced_tree=False, compact_nodes=False)
        distance, which = tree.query(images, workers=-1)
        near = distance <= reach
        found[near] = others[which[near]]
    return found


@njit(cache=True, nogil=True)
def _vertices_within(start: np.ndarray, neighbour: np.ndarray, seeds: np.ndarray, rings: int) -> np.ndarray:
    """Vertices within ``rings`` of the ``seeds`` (s,), nearest first, (k,)."""
    reached, found = np.zeros(len(start) - 1, dtype=np.bool_), np.empty(len(start) - 1, dtype=np.int64)
    head = count = 0
    for v in seeds:
        if not reached[v]:
            reached[v] = True
            found[count] = v
            count += 1
    while head < count and rings > 0:
        rings -= 1
        for i in range(head, count):
            head += 1
            for e in range(start[found[i]], start[found[i] + 1]):
                if not reached[neighbour[e]]:
                    reached[neighbour[e]] = True
                    found[count] = neighbour[e]
                    count += 1
    return found[:count].copy()


def component_of(start: np.ndarray, neighbour: np.ndarray, seed: int) -> np.ndarray:
    """Connected component of the vertex ``seed`` as a mask, (n,) bool array."""
    member = np.zeros(len(start) - 1, dtype=bool)
    member[_vertices_within(start, neighbour, np.array([seed]), len(member))] = True
    return member


def border_loop(
    F: np.ndarray, opposite: np.ndarray, start: np.ndarray, neighbour: np.ndarray, seeds: np.ndarray
) -> np.ndarray:
    """Border loop the fewest rings away from given vertices.

    Parameters
    ----------
    F : (m, 3) int array
    opposite : (m, 3) int array
        Its :func:`opposite_half_edges`.
    start, neighbour : int arrays
        As for :func:`grown_set`.
    seeds : (s,) int array

    Returns
    -------
    (n,) bool array
        Its vertices; loops that touch in a vertex are one. None if no seed is connected with a border.
    """
    a, b = boundary_edges(F, opposite).T
    border = np.zeros(len(start) - 1, dtype=bool)
    border[a] = border[b] = True
    reached = _vertices_within(start, neighbour, np.array(seeds, dtype=np.int64), len(border))
    nearest = reached[border[reached]][:1]
    if not len(nearest):
        return np.zeros_like(border)
    loop = vertex_components(np.column_stack([a, b, b]), len(border))
    return border & (loop == loop[nearest])


@njit(cache=True, nogil=True)
def is_inside_polygon(points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    """Mask of points inside a closed polygon, by the even-odd rule.

    Parameters
    ----------
    points : (k, 2) float array
        Points to test; NaN counts as outside.
    polygon : (p, 2) float array
        Corners in their order; the last is joined with the first.

    Returns
    -------
    (k,) bool array
    """
    out = np.zeros(len(points), dtype=np.bool_)
    lx = ly = np.inf
    hx = hy = -np.inf
    for i in range(len(polygon)):
        lx, ly = min(lx, polygon[i, 0]), min(ly, polygon[i, 1])
        hx, hy = max(hx, polygon[i, 0]), max(hy, polygon[i, 1])
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if not (lx <= x <= hx and ly <= y <= hy):
            continue
        odd, bx, by = False, polygon[-1, 0], polygon[-1, 1]
        for i in range(len(polygon)):
            ax, ay = bx, by
            bx, by = polygon[i, 0], polygon[i, 1]
            if (ay <= y) != (by <= y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
                odd = not odd
        out[k] = odd
    return out
