"""Unit quaternions as rotations of vectors and vertices."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.rotations import LANES
from apd_viewer.geometry.linalg.threads import parallel


@njit(cache=True, nogil=True)
def quaternion_to_matrix(q: np.ndarray, R: np.ndarray) -> None:
    """Write the rotation matrix of the unit quaternion ``q`` (4,) into ``R`` (3, 3)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    R[0, 0] = 1 - 2 * (y * y + z * z)
    R[0, 1] = 2 * (x * y - w * z)
    R[0, 2] = 2 * (x * z + w * y)
    R[1, 0] = 2 * (x * y + w * z)
    R[1, 1] = 1 - 2 * (x * x + z * z)
    R[1, 2] = 2 * (y * z - w * x)
    R[2, 0] = 2 * (x * z - w * y)
    R[2, 1] = 2 * (y * z + w * x)
    R[2, 2] = 1 - 2 * (x * x + y * y)


@njit(cache=True, nogil=True)
def load_rotation(X: np.ndarray, i: int, q: np.ndarray) -> None:
    """Make ``q`` (4,) the start of lane ``i``."""
    for a in range(4):
        X[(9 + a) * LANES + i] = q[a]


@njit(cache=True, nogil=True)
def store_rotation(X: np.ndarray, i: int, q: np.ndarray) -> None:
    """Write the answer of lane ``i`` into ``q`` (4,)."""
    for a in range(4):
        q[a] = X[(9 + a) * LANES + i]


@njit(inline="always")
def turned(q: np.ndarray, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The vector (x, y, z) turned by the unit quaternion ``q[i]``."""
    w, a, b, c = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
    tx, ty, tz = 2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)
    return x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx


@parallel()
def turn_rotations(turns: np.ndarray, q: np.ndarray) -> None:
    """Compose every rotation of ``q`` (n, 4) with ``turns`` (n, 4), in place."""
    for i in prange(len(q)):
        w, x, y, z = turns[i, 0], turns[i, 1], turns[i, 2], turns[i, 3]
        a, b, c, d = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        q[i, 0] = w * a - x * b - y * c - z * d
        q[i, 1] = w * b + x * a + y * d - z * c
        q[i, 2] = w * c - x * d + y * a + z * b
        q[i, 3] = w * d + x * c - y * b + z * a
