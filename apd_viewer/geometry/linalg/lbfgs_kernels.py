"""Passes over the memory of quasi-Newton steps, each as few as can be.

``A`` (l, m) are steps or changes in single precision, ``order`` (k,) those that count. Sums are made in
double precision and in portions of a fixed length, so they are the same on any number of cores.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.threads import parallel, total, totals

# Numbers per task of a core: those of one array stay in its cache while another is passed over.
_PORTION = 6144
# Sums within a portion may be in any order that is the same each time.
_SUMS = {"contract", "reassoc", "nsz"}


@parallel()
def subtract_rows(A: np.ndarray, B: np.ndarray, rows: np.ndarray, out: np.ndarray) -> None:
    """Write ``rows`` of ``A - B`` (n, 3) into ``out`` (3 len(rows),)."""
    for k in prange(len(rows)):
        i = rows[k]
        for d in range(3):
            out[3 * k + d] = A[i, d] - B[i, d]


@parallel(fastmath=_SUMS)
def subtract(A: np.ndarray, B: np.ndarray, step: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Write ``A - B`` into ``out``, all (m,), and return three products.

    Those of ``A - B`` with ``step`` (m,), of ``step`` with itself, and of ``A - B`` with itself.
    """
    count = (len(A) + _PORTION - 1) // _PORTION
    sums = np.zeros((count, 3))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        u, v, s, y = A[first:end], B[first:end], step[first:end], out[first:end]
        a = b = c = 0.0
        for i in range(len(u)):
            difference = u[i] - v[i]
            y[i] = difference
            a += difference * s[i]
            b += np.float64(s[i]) * s[i]
            c += difference * difference
        sums[portion, 0], sums[portion, 1], sums[portion, 2] = a, b, c
    return totals(sums)


@parallel(fastmath=_SUMS)
def products(steps: np.ndarray, changes: np.ndarray, order: np.ndarray, slot: int) -> np.ndarray:
    """Products (2 k,) of steps with a slot's change, then of changes with its step."""
    count = (steps.shape[1] + _PORTION - 1) // _PORTION
    sums = np.zeros((count, 2 * len(order)))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        step, change = steps[slot, first:end], changes[slot, first:end]
        for k in range(len(order)):
            s, y, a, b = steps[order[k], first:end], changes[order[k], first:end], 0.0, 0.0
            for i in range(len(step)):
                a += np.float64(s[i]) * change[i]
                b += np.float64(y[i]) * step[i]
            sums[portion, k], sums[portion, len(order) + k] = a, b
    return totals(sums)


@parallel(fastmath=_SUMS)
def dots(A: np.ndarray, order: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Products (k,) with ``X`` (m,)."""
    count = (len(X) + _PORTION - 1) // _PORTION
    sums = np.zeros((count, len(order)))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        x = X[first:end]
        for k in range(len(order)):
            a, along = A[order[k], first:end], 0.0
            for i in range(len(x)):
                along += a[i] * x[i]
            sums[portion, k] = along
    return totals(sums)


@parallel(fastmath={"contract"})
def negative_combination(X: np.ndarray, c: np.ndarray, A: np.ndarray, order: np.ndarray) -> np.ndarray:
    """``-X - sum_k c_k A_k`` for ``X`` (m,)."""
    out = np.empty_like(X)
    for portion in prange((len(X) + _PORTION - 1) // _PORTION):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        x, y = X[first:end], out[first:end]
        for i in range(len(x)):
            y[i] = -x[i]
        for k in range(len(order)):
            a, f = A[order[k], first:end], c[k]
            for i in range(len(x)):
                y[i] -= f * a[i]
    return out


@parallel(fastmath=_SUMS)
def add_combination(
    X: np.ndarray, c: np.ndarray, A: np.ndarray, order: np.ndarray, slope: np.ndarray
) -> float:
    """Add ``sum_k c_k A_k`` to ``X`` (m,) in place, and return ``slope . X``."""
    count = (len(X) + _PORTION - 1) // _PORTION
    sums = np.zeros(count)
    for portion in prange(count):
        first, end, along = portion * _PORTION, (portion + 1) * _PORTION, 0.0
        x, g = X[first:end], slope[first:end]
        for k in range(len(order)):
            a, f = A[order[k], first:end], c[k]
            for i in range(len(x)):
                x[i] += f * a[i]
        for i in range(len(x)):
            along += x[i] * g[i]
        sums[portion] = along
    return total(sums)
