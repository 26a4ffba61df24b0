"""Unit quaternions as rotations of vectors and vertices."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
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
def rotated_vector(q: np.ndarray, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The vector (x, y, z) turned by the unit quaternion ``q[i]``."""
    w, a, b, c = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
    tx, ty, tz = 2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)
    return x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx


@parallel()
def compose_rotations(rotations: np.ndarray, q: np.ndarray) -> None:
    """Compose every rotation of ``q`` (n, 4) with ``rotations`` (n, 4), in place."""
    for i in prange(len(q)):
        w, x, y, z = rotations[i, 0], rotations[i, 1], rotations[i, 2], rotations[i, 3]
        a, b, c, d = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        q[i, 0] = w * a - x * b - y * c - z * d
        q[i, 1] = w * b + x * a + y * d - z * c
        q[i, 2] = w * c - x * d + y * a + z * b
        q[i, 3] = w * d + x * c - y * b + z * a


def relative_rotations(q: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """``q`` times the inverse of ``reference``, both (c, 4) unit quaternions."""
    w, x, y, z = q.T
    a, b, c, d = reference[:, 0], -reference[:, 1], -reference[:, 2], -reference[:, 3]
    return np.column_stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    )


@parallel()
def blended_rotations(q: np.ndarray, near: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted mean quaternions (n, 4) of ``q`` (c, 4) by ``near`` and ``weight``."""
    out = np.empty((len(near), 4))
    for i in prange(len(near)):
        w = x = y = z = 0.0
        for k in range(near.shape[1]):
            j, share = near[i, k], weight[i, k]
            # q and -q are one rotation: take the sign of the first.
            f = near[i, 0]
            side = q[f, 0] * q[j, 0] + q[f, 1] * q[j, 1] + q[f, 2] * q[j, 2] + q[f, 3] * q[j, 3]
            share = share if side >= 0.0 else -share
            w += share * q[j, 0]
            x += share * q[j, 1]
            y += share * q[j, 2]
            z += share * q[j, 3]
        length = np.sqrt(w * w + x * x + y * y + z * z)
        if length > 0.0:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = w / length, x / length, y / length, z / length
        else:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = 1.0, 0.0, 0.0, 0.0
    return out
