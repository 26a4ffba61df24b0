"""Interpolation between a coarse surface and the fine one."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.quaternions import turned
from apd_viewer.geometry.linalg.threads import parallel


def difference(q: np.ndarray, reference: np.ndarray) -> np.ndarray:
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
def blended(q: np.ndarray, near: np.ndarray, weight: np.ndarray) -> np.ndarray:
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


@parallel()
def carried(
    U: np.ndarray, near: np.ndarray, weight: np.ndarray, q: np.ndarray, X: np.ndarray, D: np.ndarray
) -> np.ndarray:
    """Skinned ``u_i + sum_k w_ik (R_k (u_i - x_k) - (u_i - x_k) + d_k)``, (n, 3)."""
    out = np.empty_like(U)
    for i in prange(len(U)):
        x = y = z = 0.0
        for k in range(near.shape[1]):
            j, share = near[i, k], weight[i, k]
            a, b, c = U[i, 0] - X[j, 0], U[i, 1] - X[j, 1], U[i, 2] - X[j, 2]
            u, v, w = turned(q, j, a, b, c)
            x += share * (u - a + D[j, 0])
            y += share * (v - b + D[j, 1])
            z += share * (w - c + D[j, 2])
        out[i, 0], out[i, 1], out[i, 2] = U[i, 0] + x, U[i, 1] + y, U[i, 2] + z
    return out


@njit(cache=True, nogil=True)
def gathered(b: np.ndarray, rows: np.ndarray, near: np.ndarray, weight: np.ndarray, c: int) -> np.ndarray:
    """``P^T b`` (c, 3) for ``b`` (f, 3) and the ``rows`` (f,) of P."""
    out = np.zeros((c, 3))
    for f in range(len(rows)):
        for k in range(near.shape[1]):
            j, share = near[rows[f], k], weight[rows[f], k]
            for axis in range(3):
                out[j, axis] += share * b[f, axis]
    return out


@parallel()
def interpolated(X: np.ndarray, rows: np.ndarray, near: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """``P X``, (f, 3), for ``X`` (c, 3) and the same."""
    out = np.empty((len(rows), 3))
    for f in prange(len(rows)):
        x = y = z = 0.0
        for k in range(near.shape[1]):
            j, share = near[rows[f], k], weight[rows[f], k]
            x += share * X[j, 0]
            y += share * X[j, 1]
            z += share * X[j, 2]
        out[f, 0], out[f, 1], out[f, 2] = x, y, z
    return out
