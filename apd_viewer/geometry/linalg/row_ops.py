"""Rows of long arrays of 3-vectors, taken out and put in by all cores."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.threads import parallel


@parallel()
def gathered_rows(X: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows of ``X`` (n, 3), (len(rows), 3) float array."""
    out = np.empty((len(rows), 3))
    for k in prange(len(rows)):
        i = rows[k]
        out[k, 0], out[k, 1], out[k, 2] = X[i, 0], X[i, 1], X[i, 2]
    return out


@parallel()
def scattered_rows(U: np.ndarray, place: np.ndarray, A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """``U`` (n, 3) with rows of ``A`` at ``place`` 0, 1, ..., of ``B`` at -1, ...

    Where ``place`` is beyond the rows of ``A``, the row of ``U`` stays.
    """
    out = np.empty_like(U)
    for i in prange(len(U)):
        k = place[i]
        if k < 0:
            out[i, 0], out[i, 1], out[i, 2] = B[-1 - k, 0], B[-1 - k, 1], B[-1 - k, 2]
        elif k < len(A):
            out[i, 0], out[i, 1], out[i, 2] = A[k, 0], A[k, 1], A[k, 2]
        else:
            out[i, 0], out[i, 1], out[i, 2] = U[i, 0], U[i, 1], U[i, 2]
    return out


@parallel()
def scattered_rows_along(
    U: np.ndarray, place: np.ndarray, share: float, A: np.ndarray, B: np.ndarray
) -> np.ndarray:
    """``U`` (n, 3) plus a share of ``A``, or ``B``; rows as in :func:`scattered_rows`."""
    out = np.empty_like(U)
    for i in prange(len(U)):
        k = place[i]
        if k < 0:
            out[i, 0], out[i, 1], out[i, 2] = B[-1 - k, 0], B[-1 - k, 1], B[-1 - k, 2]
        elif k < len(A):
            out[i, 0] = U[i, 0] + share * A[k, 0]
            out[i, 1] = U[i, 1] + share * A[k, 1]
            out[i, 2] = U[i, 2] + share * A[k, 2]
        else:
            out[i, 0], out[i, 1], out[i, 2] = U[i, 0], U[i, 1], U[i, 2]
    return out


@parallel()
def subtracted_rows(
    X: np.ndarray, c: np.ndarray, A: np.ndarray, start: np.ndarray, which: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """``X`` (f, 3) less ``rows`` of ``sum_k c_k A_k``.

    ``A`` is as in :func:`~apd_viewer.geometry.linalg.parallel_ops.products`.
    """
    out = np.empty_like(X)
    for r in prange(len(rows)):
        i = rows[r]
        x, y, z = X[r, 0], X[r, 1], X[r, 2]
        for e in range(start[i], start[i + 1]):
            k = which[e]
            x -= c[k] * A[k, i, 0]
            y -= c[k] * A[k, i, 1]
            z -= c[k] * A[k, i, 2]
        out[r, 0], out[r, 1], out[r, 2] = x, y, z
    return out
