"""Areas and volume as functions of the positions, with their gradients: what can be asked to have a value."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def area_of(U: np.ndarray, F: np.ndarray) -> float:
    """Area of the triangles ``F`` (m, 3) at ``U`` (n, 3)."""
    total = 0.0
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        total += np.sqrt(x * x + y * y + z * z)
    return 0.5 * total


@njit(cache=True, nogil=True)
def area_and_gradient(U: np.ndarray, F: np.ndarray, g: np.ndarray) -> float:
    """Area of the triangles ``F`` (m, 3) at ``U`` (n, 3); its gradient is written into ``g`` (n, 3).

    The gradient at a corner is half the cross product of the unit normal with the opposite edge; that of
    a triangle without area is taken as zero.
    """
    g[:] = 0.0
    total = 0.0
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        double = np.sqrt(x * x + y * y + z * z)
        if double == 0.0:
            continue
        total += double
        h = 0.5 / double
        x, y, z = h * x, h * y, h * z
        jx, jy, jz = by * z - bz * y, bz * x - bx * z, bx * y - by * x
        kx, ky, kz = y * az - z * ay, z * ax - x * az, x * ay - y * ax
        g[j, 0] += jx
        g[j, 1] += jy
        g[j, 2] += jz
        g[k, 0] += kx
        g[k, 1] += ky
        g[k, 2] += kz
        g[i, 0] -= jx + kx
        g[i, 1] -= jy + ky
        g[i, 2] -= jz + kz
    return 0.5 * total


@njit(cache=True, nogil=True)
def volume_and_gradient(U: np.ndarray, F: np.ndarray, g: np.ndarray) -> float:
    """Signed volume inside the closed surface ``F`` (m, 3) at ``U`` (n, 3); its gradient goes into ``g``."""
    g[:] = 0.0
    total = 0.0
    # Measured from a vertex of the surface: far from the origin the sum would cancel away its digits.
    o = U[F[0, 0]]
    ox, oy, oz = o[0], o[1], o[2]
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[i, 0] - ox, U[i, 1] - oy, U[i, 2] - oz
        bx, by, bz = U[j, 0] - ox, U[j, 1] - oy, U[j, 2] - oz
        cx, cy, cz = U[k, 0] - ox, U[k, 1] - oy, U[k, 2] - oz
        x, y, z = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
        total += ax * x + ay * y + az * z
        g[i, 0] += x / 6.0
        g[i, 1] += y / 6.0
        g[i, 2] += z / 6.0
        g[j, 0] += (cy * az - cz * ay) / 6.0
        g[j, 1] += (cz * ax - cx * az) / 6.0
        g[j, 2] += (cx * ay - cy * ax) / 6.0
        g[k, 0] += (ay * bz - az * by) / 6.0
        g[k, 1] += (az * bx - ax * bz) / 6.0
        g[k, 2] += (ax * by - ay * bx) / 6.0
    return total / 6.0
