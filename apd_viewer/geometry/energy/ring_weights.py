"""Weights of the triangles around a vertex, for sums that tend to an integral."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.measures import Patch

# Below this part of the squared gradients their variance is rounding: all triangles there are alike.
_ALIKE = 1e-9


def ring_weights(
    V: np.ndarray, patch: Patch, areas: np.ndarray, part: np.ndarray, normals: np.ndarray, hats: np.ndarray
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
    areas, part : (m,) float arrays
        Areas of the triangles, and the part of them that counts.
    normals : (m, 3) float array
    hats : (m, 3, 3) float array
        Gradients of the hat functions of each triangle's corners.
    """
    total = float(areas.sum())
    return _weights(V, patch.F, patch.start, patch.corner, areas, part, normals, hats, total)


@njit(cache=True, nogil=True)
def _tangents(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors perpendicular to a normal and to each other."""
    size = np.sqrt((normal**2).sum())
    n = normal / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    axis = np.zeros(3)
    axis[np.argmin(np.abs(n))] = 1.0
    x = np.cross(n, axis)
    x /= np.sqrt((x**2).sum())
    return x, np.cross(n, x)


@parallel()
def _weights(
    V: np.ndarray,
    F: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    areas: np.ndarray,
    part: np.ndarray,
    normals: np.ndarray,
    hats: np.ndarray,
    area: float,
) -> np.ndarray:
    out = np.zeros((len(F), 3))
    for i in prange(len(V)):
        normal, m, counts = np.zeros(3), 0.0, 0.0
        for e in range(start[i], start[i + 1]):
            t = corner[e] // 3
            normal += areas[t] * normals[t]
            m += areas[t] / 3.0
            counts += part[t] * areas[t]
        if counts == 0.0:
            continue
        x, y = _tangents(normal)
        mean, square = np.zeros((3, 3)), 0.0
        for e in range(start[i], start[i + 1]):
            t = corner[e] // 3
            # Of the three functions that are orthonormal in H.
            slopes = np.zeros((3, 3))
            for c in range(3):
                d = V[F[t, c]] - V[i]
                u, v = (x * d).sum(), (y * d).sum()
                slopes[0] += 0.5 * u * u * hats[t, c]
                slopes[1] += 0.5 * v * v * hats[t, c]
                slopes[2] += np.sqrt(0.5) * u * v * hats[t, c]
            share = part[t] * areas[t] / counts
            mean += share * slopes
            square += share * (slopes**2).sum()
        variance = square - (mean**2).sum()
        if variance > _ALIKE * square:
            scale = 3.0 * area * m / (variance * counts)
            for e in range(start[i], start[i + 1]):
                t = corner[e] // 3
                out[t, corner[e] % 3] = scale * part[t] * areas[t]
    return out
