"""The areas of the parts of a surface."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit


@njit(cache=True, nogil=True)
def region_areas(U: np.ndarray, F: np.ndarray, member: np.ndarray, count: int) -> np.ndarray:
    """Areas of ``count`` regions: triangles with all three corners inside.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array
    member : (n,) int array
        k + 1 for the vertices of region k, 0 for those in none.
    count : int

    Returns
    -------
    (count,) float array
        Square mesh units.
    """
    areas = np.zeros(count)
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        number = member[i]
        if number == 0 or number > count or member[j] != number or member[k] != number:
            continue
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        areas[number - 1] += 0.5 * np.sqrt(x * x + y * y + z * z)
    return areas
