"""Partial factorization of dense symmetric frontal matrices.

Only the upper triangle of a front is read and written.
"""

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit

# Columns per block of a matrix product.
_BLOCK = 96


@njit(cache=True, nogil=True, error_model="numpy")
def condense(front: np.ndarray, inverse: np.ndarray) -> bool:
    """Eliminate as many unknowns of a ``front`` as ``inverse`` has rows.

    The upper triangle ``[[A, B], [., C]]`` becomes ``[[., A^-1 B], [., C - B^T A^-1 B]]``; ``inverse``, A^-1.
    False if A is not positive definite.
    """
    k, w = len(inverse), len(front)
    factor = np.empty((4, k))
    for i in range(k):
        for j in range(k):
            inverse[i, j] = 0.0
    for i in range(k):
        for p in range(i):
            factor[0, p] = front[p, i] / front[p, p]
        _subtract(front[i, i:], factor[0, :i], front[:i, i:])
        if not front[i, i] > 0.0:
            return False
        inverse[i, i] = 1.0
        _subtract(inverse[i, :i], factor[0, :i], inverse[:i, :i])
    whole = k + (w - k) // 4 * 4
    for i in range(k, w):
        for p in range(k):
            factor[(i - k) % 4, p] = front[p, i] / front[p, p]
        if i >= whole:
            _subtract(front[i, i:], factor[(i - k) % 4], front[:k, i:])
        elif (i - k) % 4 == 3:
            _subtract_four(front[i - 3 : i + 1, i - 3 :], factor, front[:k, i - 3 :])
    for i in range(k - 1, -1, -1):
        known = factor[0, : k - 1 - i]
        for j in range(k - 1 - i):
            known[j] = front[i, i + 1 + j]
        _subtract(front[i, k:], known, front[i + 1 : k, k:])
        _subtract(inverse[i], known, inverse[i + 1 :])
        for j in range(k, w):
            front[i, j] /= front[i, i]
        for j in range(k):
            inverse[i, j] /= front[i, i]
    return True


# Four rows at a time: the updated entries are read and written a quarter as often.


@njit(cache=True, nogil=True, fastmath={"contract"})
def _subtract(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
    """Subtract ``factor`` (p,) times ``rows`` (p, m) from ``out`` (m,)."""
    whole = len(factor) // 4 * 4
    for p in range(0, whole, 4):
        a, b, c, d = factor[p], factor[p + 1], factor[p + 2], factor[p + 3]
        r, s, t, u = rows[p], rows[p + 1], rows[p + 2], rows[p + 3]
        for j in range(len(out)):
            out[j] -= a * r[j] + b * s[j] + c * t[j] + d * u[j]
    for p in range(whole, len(factor)):
        a, r = factor[p], rows[p]
        for j in range(len(out)):
            out[j] -= a * r[j]


@njit(cache=True, nogil=True, fastmath={"contract"})
def _subtract_four(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
    """Subtract ``factor`` (4, p) times ``rows`` (p, m) from ``out`` (4, m)."""
    x, y, z, w = out[0], out[1], out[2], out[3]
    f, g, h, i = factor[0], factor[1], factor[2], factor[3]
    whole = len(rows) // 2 * 2
    for p in range(0, whole, 2):
        r, s = rows[p], rows[p + 1]
        a0, a1, b0, b1, c0, c1, d0, d1 = f[p], f[p + 1], g[p], g[p + 1], h[p], h[p + 1], i[p], i[p + 1]
        for j in range(out.shape[1]):
            x[j] -= a0 * r[j] + a1 * s[j]
            y[j] -= b0 * r[j] + b1 * s[j]
            z[j] -= c0 * r[j] + c1 * s[j]
            w[j] -= d0 * r[j] + d1 * s[j]
    for p in range(whole, len(rows)):
        r, a0, b0, c0, d0 = rows[p], f[p], g[p], h[p], i[p]
        for j in range(out.shape[1]):
            x[j] -= a0 * r[j]
            y[j] -= b0 * r[j]
            z[j] -= c0 * r[j]
            w[j] -= d0 * r[j]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def condense_by_blocks(front: np.ndarray, inverse: np.ndarray) -> bool:
    """Condense a front as :func:`condense` does, by matrix products."""
    k, b = len(inverse), len(front) - len(inverse)
    for i in range(k):
        for j in range(i, k):
            inverse[i, j] = inverse[j, i] = front[i, j]
    if not _invert(inverse):
        return False
    blocks = (b + _BLOCK - 1) // _BLOCK
    B, products = np.empty(k * b), np.empty(max(k, _BLOCK) * _BLOCK)
    for c in range(blocks):
        first, last = c * _BLOCK, min(b, (c + 1) * _BLOCK)
        width = last - first
        column = B[k * first : k * last].reshape(k, width)
        for i in range(k):
            for j in range(width):
                column[i, j] = front[i, k + first + j]
        W = products[: k * width].reshape(k, width)
        np.dot(inverse, column, W)
        for i in range(k):
            for j in range(width):
                front[i, k + first + j] = W[i, j]
        for a in range(c + 1):
            above, below = a * _BLOCK, min(b, (a + 1) * _BLOCK)
            row = B[k * above : k * below].reshape(k, below - above)
            taken = np.dot(row.T, W)
            for i in range(below - above):
                for j in range(width):
                    front[k + above + i, k + first + j] -= taken[i, j]
    return True


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _invert(A: np.ndarray) -> bool:
    """Invert a matrix in place, a block of rows at a time; False if not definite."""
    k = len(A)
    for first in range(0, k, _BLOCK):
        last = min(k, first + _BLOCK)
        width = last - first
        pivot, inverse = A[first:last, first:last].copy(), np.empty((width, width))
        if not condense(pivot, inverse):
            return False
        column = A[:, first:last].copy()
        for i in range(width):
            for j in range(width):
                column[first + i, j] = 0.0
                inverse[max(i, j), min(i, j)] = inverse[min(i, j), max(i, j)]
        row = np.dot(column, inverse)
        taken = np.dot(row, column.T)
        for i in range(k):
            for j in range(k):
                A[i, j] -= taken[i, j]
        for i in range(k):
            for j in range(width):
                A[i, first + j] = A[first + j, i] = row[i, j]
        for i in range(width):
            for j in range(width):
                A[first + i, first + j] = -inverse[i, j]
    for i in range(k):
        for j in range(k):
            A[i, j] = -A[i, j]
    return True
