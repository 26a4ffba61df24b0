"""Distances between vertices and triangles, and between edges.

A pair names four vertices: a vertex and the corners of a triangle, or the ends of two edges. Its gap is the
distance of its two parts, ``|sum_k w_k x_k|`` with the weights of their nearest points
[Ericson 2005, Real-time collision detection, 5.1].
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.threads import parallel

# Edges whose directions differ by a smaller squared sine are compared end by end too: rounding would decide
# where two parallel edges are nearest.
_PARALLEL = 1e-6
# So thin a triangle, by the squared sine of an angle, is as near as its edges are.
_NEEDLE = 1e-12


@njit(inline="always")
def _clamped(x: float) -> float:
    return 0.0 if x < 0.0 else (1.0 if x > 1.0 else x)


@njit(cache=True, nogil=True)
def _on_segment(X: np.ndarray, p: int, a: int, b: int) -> tuple[float, float]:
    """Squared distance of a point from a segment, and the place on it, 0 to 1."""
    ux, uy, uz = X[b, 0] - X[a, 0], X[b, 1] - X[a, 1], X[b, 2] - X[a, 2]
    rx, ry, rz = X[p, 0] - X[a, 0], X[p, 1] - X[a, 1], X[p, 2] - X[a, 2]
    length = ux * ux + uy * uy + uz * uz
    t = _clamped((ux * rx + uy * ry + uz * rz) / length) if length > 0.0 else 0.0
    x, y, z = rx - t * ux, ry - t * uy, rz - t * uz
    return x * x + y * y + z * z, t


@njit(cache=True, nogil=True)
def vertex_triangle(X: np.ndarray, p: int, a: int, b: int, c: int) -> tuple[float, float, float, float]:
    """Squared distance of a vertex from a triangle, and the weights of its corners."""
    abx, aby, abz = X[b, 0] - X[a, 0], X[b, 1] - X[a, 1], X[b, 2] - X[a, 2]
    acx, acy, acz = X[c, 0] - X[a, 0], X[c, 1] - X[a, 1], X[c, 2] - X[a, 2]
    apx, apy, apz = X[p, 0] - X[a, 0], X[p, 1] - X[a, 1], X[p, 2] - X[a, 2]
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    aa = abx * abx + aby * aby + abz * abz
    bb = acx * acx + acy * acy + acz * acz
    ab = abx * acx + aby * acy + abz * acz
    area = aa * bb - ab * ab
    v, w = bb * d1 - ab * d2, aa * d2 - ab * d1
    if v > 0.0 and w > 0.0 and v + w < area and area > _NEEDLE * aa * bb:
        v, w = v / area, w / area
        x, y, z = apx - v * abx - w * acx, apy - v * aby - w * acy, apz - v * abz - w * acz
        return x * x + y * y + z * z, 1.0 - v - w, v, w
    # The nearest point is on an edge; so it is for a triangle without area.
    best, t = _on_segment(X, p, a, b)
    u, v, w = 1.0 - t, t, 0.0
    q, t = _on_segment(X, p, b, c)
    if q < best:
        best, u, v, w = q, 0.0, 1.0 - t, t
    q, t = _on_segment(X, p, c, a)
    if q < best:
        best, u, v, w = q, t, 0.0, 1.0 - t
    return best, u, v, w


@njit(cache=True, nogil=True)
def edge_edge(X: np.ndarray, a: int, b: int, c: int, d: int) -> tuple[float, float, float]:
    """Squared distance of two edges, and the places on them, each 0 to 1."""
    ux, uy, uz = X[b, 0] - X[a, 0], X[b, 1] - X[a, 1], X[b, 2] - X[a, 2]
    vx, vy, vz = X[d, 0] - X[c, 0], X[d, 1] - X[c, 1], X[d, 2] - X[c, 2]
    rx, ry, rz = X[a, 0] - X[c, 0], X[a, 1] - X[c, 1], X[a, 2] - X[c, 2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    ur, vr = ux * rx + uy * ry + uz * rz, vx * rx + vy * ry + vz * rz
    across = uu * vv - uv * uv
    best, s, t = np.inf, 0.0, 0.0
    if across > _PARALLEL * uu * vv:
        s, t = (uv * vr - ur * vv) / across, (uu * vr - ur * uv) / across
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            x, y, z = rx + s * ux - t * vx, ry + s * uy - t * vy, rz + s * uz - t * vz
            return x * x + y * y + z * z, s, t
    q, place = _on_segment(X, a, c, d)
    best, s, t = q, 0.0, place
    q, place = _on_segment(X, b, c, d)
    if q < best:
        best, s, t = q, 1.0, place
    q, place = _on_segment(X, c, a, b)
    if q < best:
        best, s, t = q, place, 0.0
    q, place = _on_segment(X, d, a, b)
    if q < best:
        best, s, t = q, place, 1.0
    return best, s, t


@njit(cache=True, nogil=True)
def gap(X: np.ndarray, pair: np.ndarray, edges: bool) -> tuple[float, float, float, float, float]:
    """Distance of a pair (4,), and its four weights."""
    a, b, c, d = pair[0], pair[1], pair[2], pair[3]
    if edges:
        q, s, t = edge_edge(X, a, b, c, d)
        return np.sqrt(q), 1.0 - s, s, t - 1.0, -t
    q, u, v, w = vertex_triangle(X, a, b, c, d)
    return np.sqrt(q), 1.0, -u, -v, -w


@parallel()
def gaps(X: np.ndarray, pairs: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Distances (p,) of pairs (p, 4); ``edges`` (p,) tells the kind of each."""
    found = np.empty(len(pairs))
    for p in prange(len(pairs)):
        found[p] = gap(X, pairs[p], edges[p])[0]
    return found
