"""Reachability in the one-ring graph, border loops and polygons."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.adjacency import BOUNDARY
from apd_viewer.geometry.mesh.components import vertex_components


@njit(cache=True, nogil=True)
def _walk(start: np.ndarray, neighbour: np.ndarray, seeds: np.ndarray, rings: int) -> np.ndarray:
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
    """Connected component of the vertex ``seed``, (n,) bool array."""
    member = np.zeros(len(start) - 1, dtype=bool)
    member[_walk(start, neighbour, np.array([seed]), len(member))] = True
    return member


def border_loop(
    F: np.ndarray, opposite: np.ndarray, start: np.ndarray, neighbour: np.ndarray, seeds: np.ndarray
) -> np.ndarray:
    """Border loop fewest rings away from some vertices.

    Parameters
    ----------
    F : (m, 3) int array
    opposite : (m, 3) int array
        Its :func:`opposite_corners`.
    start, neighbour : int arrays
        As for :func:`grown`.
    seeds : (s,) int array

    Returns
    -------
    (n,) bool array
        Its vertices; loops that touch in a vertex are one. None if no seed is connected with a border.
    """
    t, c = np.nonzero(opposite == BOUNDARY)
    a, b = F[t, c], F[t, (c + 1) % 3]
    border = np.zeros(len(start) - 1, dtype=bool)
    border[a] = border[b] = True
    reached = _walk(start, neighbour, np.array(seeds, dtype=np.int64), len(border))
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
        Those that are not a number lie outside.
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
