"""Weights of the triangles around a vertex, for sums that tend to an integral."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.weighted_areas import Patch

# Below this part of the squared gradients their variance is rounding: all triangles there are alike.
_ALIKE = 1e-9


def ring_weights(
    V: np.ndarray,
    patch: Patch,
    areas: np.ndarray,
    area_share: np.ndarray,
    normals: np.ndarray,
    hat_gradients: np.ndarray,
) -> np.ndarray:
    """Weights ``w_it`` of the corners of all triangles, (m, 3).

    Let u be a quadratic function of the place around vertex i, seen along the normal, and H its second
    derivatives. The weights are in proportion to ``part_t A_t``, and such that
    ``sum_t w_it |grad_t u - mean|^2 = A m_i |H|^2`` in the mean of all H, with m_i the vertex areas and A
    the total area: the sum over all vertices is A times the integral of ``|H|^2``. On equilateral triangles
    that holds for each H; on right-angled ones the directions differ by up to a half.

    Parameters
    ----------
    V : (n, 3) float array
    patch : Patch
    areas, area_share : (m,) float arrays
        Areas of the triangles, and the part of them that counts.
    normals : (m, 3) float array
    hat_gradients : (m, 3, 3) float array
        Gradients of the hat functions of each triangle's corners.
    """
    total = float(areas.sum())
    return _weights(V, patch.F, patch.start, patch.corner, areas, area_share, normals, hat_gradients, total)


@njit(cache=True, nogil=True)
def _tangents(normal: np.ndarray) -> np.ndarray:
    """Unit vectors (2, 3) perpendicular to a normal and to each other."""
    x, y, z = normal
    size = np.sqrt(x * x + y * y + z * z)
    x, y, z = (x / size, y / size, z / size) if size > 0.0 else (0.0, 0.0, 1.0)
    # Across the axis with which it makes the largest angle.
    a, b, c = abs(x), abs(y), abs(z)
    if a <= b and a <= c:
        u, v, w = 0.0, z, -y
    elif b <= c:
        u, v, w = -z, 0.0, x
    else:
        u, v, w = y, -x, 0.0
    size = np.sqrt(u * u + v * v + w * w)
    u, v, w = u / size, v / size, w / size
    out = np.empty((2, 3))
    out[0, 0], out[0, 1], out[0, 2] = u, v, w
    out[1, 0], out[1, 1], out[1, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return out


@parallel()
def _weights(
    V: np.ndarray,
    F: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    areas: np.ndarray,
    area_share: np.ndarray,
    normals: np.ndarray,
    hats: np.ndarray,
    area: float,
) -> np.ndarray:
    out = np.zeros((len(F), 3))
    for i in prange(len(V)):
        normal, m, counts = np.zeros(3), 0.0, 0.0
        for e in range(start[i], start[i + 1]):
            t = corner[e] // 3
            for a in range(3):
                normal[a] += areas[t] * normals[t, a]
            m += areas[t] / 3.0
            counts += area_share[t] * areas[t]
        if counts == 0.0:
            continue
        variance, square = _variance(
            V, F, i, corner[start[i] : start[i + 1]], areas, area_share, counts, _tangents(normal), hats
        )
        if variance > _ALIKE * square:
            scale = 3.0 * area * m / (variance * counts)
            for e in range(start[i], start[i + 1]):
                t = corner[e] // 3
                out[t, corner[e] % 3] = scale * area_share[t] * areas[t]
    return out


@njit(cache=True, nogil=True)
def _variance(
    V: np.ndarray,
    F: np.ndarray,
    i: int,
    corner: np.ndarray,
    areas: np.ndarray,
    area_share: np.ndarray,
    counts: float,
    tangents: np.ndarray,
    hats: np.ndarray,
) -> tuple[float, float]:
    """Variance and mean square of the gradients of three functions over a ring.

    The functions are orthonormal in H; ``counts`` is the area of the ring that counts.
    """
    mean, square = np.zeros((3, 3)), 0.0
    for e in range(len(corner)):
        t = corner[e] // 3
        share = area_share[t] * areas[t] / counts
        slopes = np.zeros((3, 3))
        for c in range(3):
            u = v = 0.0
            for a in range(3):
                d = V[F[t, c], a] - V[i, a]
                u += tangents[0, a] * d
                v += tangents[1, a] * d
            for a in range(3):
                slopes[0, a] += 0.5 * u * u * hats[t, c, a]
                slopes[1, a] += 0.5 * v * v * hats[t, c, a]
                slopes[2, a] += np.sqrt(0.5) * u * v * hats[t, c, a]
        for k in range(3):
            for a in range(3):
                mean[k, a] += share * slopes[k, a]
                square += share * slopes[k, a] * slopes[k, a]
    variance = square
    for k in range(3):
        for a in range(3):
            variance -= mean[k, a] * mean[k, a]
    return variance, square
