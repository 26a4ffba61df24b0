"""Sums, products and rows of long arrays of 3-vectors, shared among the cores.

numpy does these on one core, and in a pass of its own for every operation.
"""

import numpy as np
from numba import prange
from scipy.sparse import csr_array

from apd_viewer.geometry.linalg.threads import parallel, sums_of_portions

# Rows per parallel task.
_PORTION = 2048


def inner_product(a: np.ndarray, b: np.ndarray) -> float:
    """Inner product of long vectors (n,), independent of the number of BLAS threads."""
    return float(np.einsum("i,i->", a, b))


def matrix_product(A: csr_array, X: np.ndarray) -> np.ndarray:
    """Product ``A X`` (m, 3) of a sparse ``A`` (m, n) and ``X`` (n, 3)."""
    return _product(A.indptr, A.indices, A.data, X)


@parallel()
def _product(start: np.ndarray, column: np.ndarray, entry: np.ndarray, X: np.ndarray) -> np.ndarray:
    out = np.empty((len(start) - 1, 3))
    for i in prange(len(out)):
        x = y = z = 0.0
        for e in range(start[i], start[i + 1]):
            j, a = column[e], entry[e]
            x += a * X[j, 0]
            y += a * X[j, 1]
            z += a * X[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out


def residual(A: csr_array, X: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Residual ``B - A X`` for ``A`` (m, n), ``X`` (n, 3) and ``B`` (m, 3)."""
    return _residual(A.indptr, A.indices, A.data, X, B)


@parallel()
def _residual(
    start: np.ndarray, column: np.ndarray, entry: np.ndarray, X: np.ndarray, B: np.ndarray
) -> np.ndarray:
    out = np.empty_like(B)
    for i in prange(len(out)):
        x, y, z = B[i, 0], B[i, 1], B[i, 2]
        for e in range(start[i], start[i + 1]):
            j, a = column[e], entry[e]
            x -= a * X[j, 0]
            y -= a * X[j, 1]
            z -= a * X[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out


@parallel()
def inner_products_at(A: np.ndarray, rows: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Inner products (k,) of rows of each of ``A`` (k, n, 3) with ``X`` (f, 3)."""
    count = (len(X) + _PORTION - 1) // _PORTION
    sums = np.zeros((count, len(A)))
    for portion in prange(count):
        for k in range(len(A)):
            along = 0.0
            for e in range(portion * _PORTION, min(len(X), (portion + 1) * _PORTION)):
                i = rows[e]
                along += A[k, i, 0] * X[e, 0] + A[k, i, 1] * X[e, 1] + A[k, i, 2] * X[e, 2]
            sums[portion, k] = along
    return sums_of_portions(sums)


@parallel()
def inner_products(A: np.ndarray, start: np.ndarray, which: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Inner products (k l,), row by row, of ``A`` (k, n, 3) with ``B`` (l, n, 3).

    Row i of ``A`` is zero but for those of its arrays numbered ``which[start[i]:start[i + 1]]``.
    """
    count = (len(start) - 2 + _PORTION) // _PORTION
    sums = np.zeros((count, len(A) * len(B)))
    for portion in prange(count):
        for i in range(portion * _PORTION, min(len(start) - 1, (portion + 1) * _PORTION)):
            for e in range(start[i], start[i + 1]):
                k = which[e]
                x, y, z = A[k, i, 0], A[k, i, 1], A[k, i, 2]
                for m in range(len(B)):
                    sums[portion, k * len(B) + m] += B[m, i, 0] * x + B[m, i, 1] * y + B[m, i, 2] * z
    return sums_of_portions(sums)


@parallel()
def add_combination(X: np.ndarray, c: np.ndarray, A: np.ndarray) -> None:
    """Add ``sum_k c_k A_k`` of ``A`` (k, n, 3) to ``X`` (n, 3), in place."""
    for portion in prange((len(X) + _PORTION - 1) // _PORTION):
        end = min(len(X), (portion + 1) * _PORTION)
        for k in range(len(A)):
            for i in range(portion * _PORTION, end):
                X[i, 0] += c[k] * A[k, i, 0]
                X[i, 1] += c[k] * A[k, i, 1]
                X[i, 2] += c[k] * A[k, i, 2]


@parallel()
def plus_linear_combination(X: np.ndarray, c: np.ndarray, A: np.ndarray) -> np.ndarray:
    """Sum ``X + sum_k c_k A_k`` of ``X`` (n, 3) and ``A`` (k, n, 3)."""
    out = np.empty_like(X)
    for i in prange(len(X)):
        x, y, z = X[i, 0], X[i, 1], X[i, 2]
        for k in range(len(A)):
            x += c[k] * A[k, i, 0]
            y += c[k] * A[k, i, 1]
            z += c[k] * A[k, i, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out


@parallel()
def largest_difference(A: np.ndarray, B: np.ndarray) -> float:
    """Largest absolute difference of corresponding coordinates of ``A``, ``B`` (n, 3)."""
    count = (len(A) + _PORTION - 1) // _PORTION
    largest = np.zeros(count)
    for portion in prange(count):
        most = 0.0
        for i in range(portion * _PORTION, min(len(A), (portion + 1) * _PORTION)):
            most = max(most, abs(A[i, 0] - B[i, 0]), abs(A[i, 1] - B[i, 1]), abs(A[i, 2] - B[i, 2]))
        largest[portion] = most
    return largest.max()


@parallel()
def largest_displacement(A: np.ndarray, B: np.ndarray) -> float:
    """Largest distance of corresponding points of ``A``, ``B`` (n, 3)."""
    count = (len(A) + _PORTION - 1) // _PORTION
    largest = np.zeros(count)
    for portion in prange(count):
        most = 0.0
        for i in range(portion * _PORTION, min(len(A), (portion + 1) * _PORTION)):
            x, y, z = A[i, 0] - B[i, 0], A[i, 1] - B[i, 1], A[i, 2] - B[i, 2]
            most = max(most, x * x + y * y + z * z)
        largest[portion] = most
    return np.sqrt(largest.max())


@parallel()
def gathered_rows(X: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Copy (k, 3) of the ``rows`` (k,) of ``X`` (n, 3)."""
    out = np.empty((len(rows), 3))
    for k in prange(len(rows)):
        i = rows[k]
        out[k, 0], out[k, 1], out[k, 2] = X[i, 0], X[i, 1], X[i, 2]
    return out


@parallel()
def scattered_rows(U: np.ndarray, place: np.ndarray, A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Copy of ``U`` (n, 3) with rows replaced by rows of ``A`` or ``B``, by ``place``.

    Row i becomes ``A[place[i]]``, or ``B[-1 - place[i]]`` where ``place`` is negative; where it is beyond the
    rows of ``A``, the row is unchanged.
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
def displaced_rows(
    U: np.ndarray, place: np.ndarray, fraction: float, A: np.ndarray, B: np.ndarray
) -> np.ndarray:
    """Copy of ``U`` (n, 3), rows displaced along ``A`` or replaced by rows of ``B``.

    As :func:`scattered_rows`, but ``fraction`` times the row of ``A`` is added to that of ``U``.
    """
    out = np.empty_like(U)
    for i in prange(len(U)):
        k = place[i]
        if k < 0:
            out[i, 0], out[i, 1], out[i, 2] = B[-1 - k, 0], B[-1 - k, 1], B[-1 - k, 2]
        elif k < len(A):
            out[i, 0] = U[i, 0] + fraction * A[k, 0]
            out[i, 1] = U[i, 1] + fraction * A[k, 1]
            out[i, 2] = U[i, 2] + fraction * A[k, 2]
        else:
            out[i, 0], out[i, 1], out[i, 2] = U[i, 0], U[i, 1], U[i, 2]
    return out


@parallel()
def subtracted_rows(
    X: np.ndarray, c: np.ndarray, A: np.ndarray, start: np.ndarray, which: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """Difference of ``X`` (f, 3) and the ``rows`` (f,) of ``sum_k c_k A_k``.

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
