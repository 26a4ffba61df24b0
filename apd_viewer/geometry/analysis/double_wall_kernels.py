"""Kernels of :mod:`double_wall`: opposite triangles, and the sides of a wall."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.union_find import join, root
from apd_viewer.geometry.picking.picking import ray_hit

# The triangles of a rim may be larger than its wall is thick: so many count as near, too.
_HOPS = 3


@njit(cache=True, nogil=True)
def opposite_triangles(
    V: np.ndarray,
    T: np.ndarray,
    middles: np.ndarray,
    normals: np.ndarray,
    block_boxes: np.ndarray,
    offset: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Distance behind the middle of each triangle to another, and its number or -1."""
    away, partner = np.full(len(T), np.inf), np.full(len(T), -1)
    for i in range(len(T)):
        face, distance, _, _ = ray_hit(middles[i] - offset * normals[i], -normals[i], V, T, block_boxes)
        if face >= 0:
            away[i], partner[i] = distance + offset, face
    return away, partner


@njit(cache=True, nogil=True)
def wall_sides(
    neighbours: np.ndarray,
    middles: np.ndarray,
    normals: np.ndarray,
    partner: np.ndarray,
    facing: np.ndarray,
    reach: float,
) -> np.ndarray:
    """Number of the side of each triangle; those of a rim are sides of their own."""
    m = len(neighbours)
    side, wall = np.arange(m), np.zeros(m, dtype=np.bool_)
    queue, gone, hops, seen = np.zeros(m, np.int64), np.zeros(m), np.zeros(m, np.int64), np.full(m, -1)
    for i in range(m):
        queue[0], gone[i], hops[i], seen[i], begin, end = i, 0.0, 0, i, 0, 1
        while begin < end and seen[partner[i]] != i:
            at = queue[begin]
            begin += 1
            for c in range(3):
                other = neighbours[at, c]
                if other < 0 or seen[other] == i:
                    continue
                way = gone[at] + np.sqrt(((middles[other] - middles[at]) ** 2).sum())
                if way <= reach or hops[at] < _HOPS:
                    seen[other], gone[other], hops[other], queue[end] = i, way, hops[at] + 1, other
                    end += 1
        wall[i] = facing[i] and seen[partner[i]] != i
    for i in range(m):
        for c in range(3):
            other = neighbours[i, c]
            if other >= 0 and wall[i] and wall[other] and (normals[i] * normals[other]).sum() > -0.5:
                join(side, i, other)
    for i in range(m):
        side[i] = root(side, i)
    return side


@njit(cache=True, nogil=True)
def grown_sides(neighbours: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Sides 1 and 2 grown over the triangles of neither, until they meet."""
    side, queue, end = start.copy(), np.zeros(len(start), np.int64), 0
    for i in range(len(start)):
        if side[i]:
            queue[end] = i
            end += 1
    for begin in range(len(start)):
        if begin == end:
            break
        for other in neighbours[queue[begin]]:
            if other >= 0 and not side[other]:
                side[other] = side[queue[begin]]
                queue[end] = other
                end += 1
    return side
