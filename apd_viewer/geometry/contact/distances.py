"""Distances between vertices and triangles, and between edges.

A pair names four vertices: a vertex and the corners of a triangle, or the ends of two edges. Its gap is the
distance of its two parts, ``|sum_k w_k x_k|`` with the weights of their nearest points
[Ericson 2005, Real-time collision detection, 5.1].
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Squared sine of an angle below which rounding may spoil the closest interior points: then edge ends and
# triangle sides are checked as well, and the smallest distance counts.
_THIN = 1e-6


@njit(inline="always")
def _clamped(x: float) -> float:
    return 0.0 if x < 0.0 else (1.0 if x > 1.0 else x)


@njit(inline="always")
def _cross(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> tuple[float, float, float]:
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@njit(cache=True, nogil=True)
def _on_segment(X: np.ndarray, p: int, a: int, b: int) -> tuple[float, float]:
    """Squared distance of a point from a segment, and parameter of the closest point."""
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
    # Barycentric coordinates by the normal: products of squared lengths would cancel in slivers.
    nx, ny, nz = _cross(abx, aby, abz, acx, acy, acz)
    area = nx * nx + ny * ny + nz * nz
    best, u, v, w = np.inf, 1.0, 0.0, 0.0
    if area > 0.0:
        x, y, z = _cross(apx, apy, apz, acx, acy, acz)
        s = (x * nx + y * ny + z * nz) / area
        x, y, z = _cross(abx, aby, abz, apx, apy, apz)
        t = (x * nx + y * ny + z * nz) / area
        if s > 0.0 and t > 0.0 and s + t < 1.0:
            x, y, z = apx - s * abx - t * acx, apy - s * aby - t * acy, apz - s * abz - t * acz
            best, u, v, w = x * x + y * y + z * z, 1.0 - s - t, s, t
            aa, bb = abx * abx + aby * aby + abz * abz, acx * acx + acy * acy + acz * acz
            if area > _THIN * aa * bb:
                return best, u, v, w
    q, t = _on_segment(X, p, a, b)
    if q < best:
        best, u, v, w = q, 1.0 - t, t, 0.0
    q, t = _on_segment(X, p, b, c)
    if q < best:
        best, u, v, w = q, 0.0, 1.0 - t, t
    q, t = _on_segment(X, p, c, a)
    if q < best:
        best, u, v, w = q, t, 0.0, 1.0 - t
    return best, u, v, w


@njit(cache=True, nogil=True)
def edge_edge(X: np.ndarray, a: int, b: int, c: int, d: int) -> tuple[float, float, float]:
    """Squared distance of two edges, and parameters 0 to 1 of the closest points."""
    ux, uy, uz = X[b, 0] - X[a, 0], X[b, 1] - X[a, 1], X[b, 2] - X[a, 2]
    vx, vy, vz = X[d, 0] - X[c, 0], X[d, 1] - X[c, 1], X[d, 2] - X[c, 2]
    rx, ry, rz = X[c, 0] - X[a, 0], X[c, 1] - X[a, 1], X[c, 2] - X[a, 2]
    nx, ny, nz = _cross(ux, uy, uz, vx, vy, vz)
    across = nx * nx + ny * ny + nz * nz
    best, s, t = np.inf, 0.0, 0.0
    if across > 0.0:
        x, y, z = _cross(rx, ry, rz, vx, vy, vz)
        s = (x * nx + y * ny + z * nz) / across
        x, y, z = _cross(rx, ry, rz, ux, uy, uz)
        t = (x * nx + y * ny + z * nz) / across
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            x, y, z = rx - s * ux + t * vx, ry - s * uy + t * vy, rz - s * uz + t * vz
            best = x * x + y * y + z * z
            uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
            if across > _THIN * uu * vv:
                return best, s, t
    q, place = _on_segment(X, a, c, d)
    if q < best:
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
def gap(X: np.ndarray, pair: np.ndarray, is_edge_pair: bool) -> tuple[float, float, float, float, float]:
    """Distance of a pair (4,), and its four weights."""
    a, b, c, d = pair[0], pair[1], pair[2], pair[3]
    if is_edge_pair:
        q, s, t = edge_edge(X, a, b, c, d)
        return np.sqrt(q), 1.0 - s, s, t - 1.0, -t
    q, u, v, w = vertex_triangle(X, a, b, c, d)
    return np.sqrt(q), 1.0, -u, -v, -w


@parallel()
def gaps(X: np.ndarray, pairs: np.ndarray, is_edge_pair: np.ndarray) -> np.ndarray:
    """Distances (p,) of pairs (p, 4), of two edges where ``is_edge_pair`` (p,)."""
    found = np.empty(len(pairs))
    for p in prange(len(pairs)):
        found[p] = gap(X, pairs[p], is_edge_pair[p])[0]
    return found
