"""Kernels of the multifrontal factorization: see :mod:`block_cholesky`.

Groups of unknowns, ``first``, and what they are coupled with, ``begin, later``, are those of a
:class:`BlockPattern`, and so are the rows of blocks, ``start, column``.
"""

from __future__ import annotations

import numpy as np
from numba import njit

# From so many unknowns of a group on, calls of BLAS pay; columns of a product.
_WIDE = 36
_BLOCK = 96


@njit(cache=True, nogil=True)
def eliminate(
    first: np.ndarray,
    begin: np.ndarray,
    later: np.ndarray,
    child: np.ndarray,
    sibling: np.ndarray,
    order: np.ndarray,
    place: np.ndarray,
    start: np.ndarray,
    column: np.ndarray,
    blocks: np.ndarray,
    panel: np.ndarray,
    stack: np.ndarray,
    widest: int,
    panels: np.ndarray,
) -> None:
    """Write ``[S | W]`` of each group into ``panels``, row by row."""
    at, where, top = np.empty(len(order), np.int64), np.empty(len(first) - 1, np.int64), 0
    fronts, inverses = np.empty(widest * widest), np.empty(widest * widest)
    for s in range(len(first) - 1):
        k, b = 3 * (first[s + 1] - first[s]), 3 * (begin[s + 1] - begin[s])
        front = fronts[: (k + b) * (k + b)].reshape(k + b, k + b)
        front[:] = 0.0
        for i in range(first[s], first[s + 1]):
            at[i] = 3 * (i - first[s])
        for e in range(begin[s], begin[s + 1]):
            at[later[e]] = k + 3 * (e - begin[s])
        for i in range(first[s], first[s + 1]):
            for e in range(start[order[i]], start[order[i] + 1]):
                j = place[column[e]]
                if j >= i:
                    front[at[i] : at[i] + 3, at[j] : at[j] + 3] = blocks[e]
        c = child[s]
        while c >= 0:
            width = 3 * (begin[c + 1] - begin[c])
            given = stack[where[c] : where[c] + width * width].reshape(width, width)
            _add_contribution(front, given, at, later[begin[c] : begin[c + 1]])
            top = min(top, where[c])
            c = sibling[c]
        inverse = inverses[: k * k].reshape(k, k)
        if k < _WIDE:
            _condense(front, inverse)
        else:
            _condense_by_blocks(front, inverse)
        out = panels[panel[s] : panel[s + 1]].reshape(k, k + b)
        out[:, :k], out[:, k:] = inverse, -front[:k, k:]
        where[s] = top
        stack[top : top + b * b].reshape(b, b)[:] = front[k:, k:]
        top += b * b


@njit(cache=True, nogil=True)
def _add_contribution(front: np.ndarray, given: np.ndarray, at: np.ndarray, later: np.ndarray) -> None:
    """Add a child's upper triangle ``given`` to that of its parent's ``front``."""
    for d in range(len(later)):
        for x in range(3):
            row, values = front[at[later[d]] + x], given[3 * d + x]
            for e in range(d, len(later)):
                j = at[later[e]]
                row[j] += values[3 * e]
                row[j + 1] += values[3 * e + 1]
                row[j + 2] += values[3 * e + 2]


@njit(cache=True, nogil=True, error_model="numpy")
def _condense(front: np.ndarray, inverse: np.ndarray) -> None:
    """Eliminate as many unknowns of a ``front`` as ``inverse`` has rows.

    The upper triangle ``[[A, B], [., C]]`` becomes ``[[., A^-1 B], [., C - B^T A^-1 B]]``; ``inverse``, A^-1.
    """
    k, w = len(inverse), len(front)
    factor, inverse[:] = np.empty((3, k)), 0.0
    for i in range(k):
        for p in range(i):
            factor[0, p] = front[p, i] / front[p, p]
        _subtract_one(front[i, i:], factor[0, :i], front[:i, i:])
        inverse[i, i] = 1.0
        _subtract_one(inverse[i], factor[0, :i], inverse[:i])
    for i in range(k, w, 3):
        for p in range(k):
            for x in range(3):
                factor[x, p] = front[p, i + x] / front[p, p]
        _subtract_three(front[i : i + 3, i:], factor, front[:k, i:])
    for i in range(k - 1, -1, -1):
        factor[0, : k - 1 - i] = front[i, i + 1 : k]
        known = factor[0, : k - 1 - i]
        _subtract_one(front[i, k:], known, front[i + 1 : k, k:])
        _subtract_one(inverse[i], known, inverse[i + 1 :])
        front[i, k:] /= front[i, i]
        inverse[i] /= front[i, i]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _condense_by_blocks(front: np.ndarray, inverse: np.ndarray) -> None:
    """The same by products of matrices."""
    k, b = len(inverse), len(front) - len(inverse)
    for i in range(k):
        inverse[i, i:] = front[i, i:k]
        inverse[i:, i] = front[i, i:k]
    _invert(inverse)
    blocks = (b + _BLOCK - 1) // _BLOCK
    B, products = np.empty(k * b), np.empty(max(k, _BLOCK) * _BLOCK)
    for c in range(blocks):
        first, last = c * _BLOCK, min(b, (c + 1) * _BLOCK)
        width = last - first
        column = B[k * first : k * last].reshape(k, width)
        column[:] = front[:k, k + first : k + last]
        W = products[: k * width].reshape(k, width)
        np.dot(inverse, column, W)
        front[:k, k + first : k + last] = W
        for a in range(c + 1):
            above, below = a * _BLOCK, min(b, (a + 1) * _BLOCK)
            row = B[k * above : k * below].reshape(k, below - above)
            front[k + above : k + below, k + first : k + last] -= np.dot(row.T, W)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _invert(A: np.ndarray) -> None:
    """Invert a symmetric positive definite matrix in place, sweep by sweep of some rows."""
    k = len(A)
    for first in range(0, k, _BLOCK):
        last = min(k, first + _BLOCK)
        width = last - first
        pivot, inverse = A[first:last, first:last].copy(), np.empty((width, width))
        _condense(pivot, inverse)
        for i in range(width):
            inverse[i, :i] = inverse[:i, i]
        column = A[:, first:last].copy()
        column[first:last] = 0.0
        row = np.dot(column, inverse)
        A -= np.dot(row, column.T)
        A[:, first:last] = row
        A[first:last, :] = row.T
        A[first:last, first:last] = -inverse
    A *= -1.0


# Four rows at a time: what is subtracted from is read and written a quarter as often.


@njit(cache=True, nogil=True, fastmath={"contract"})
def _subtract_one(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
    """``out -= factor rows`` of the shapes (m,), (p,) and (p, m)."""
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
def _subtract_three(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
    """``out -= factor rows`` of the shapes (3, m), (3, 3 p) and (3 p, m)."""
    x, y, z = out[0], out[1], out[2]
    for p in range(0, len(rows), 3):
        r, s, t = rows[p], rows[p + 1], rows[p + 2]
        a0, a1, a2 = factor[0, p], factor[0, p + 1], factor[0, p + 2]
        b0, b1, b2 = factor[1, p], factor[1, p + 1], factor[1, p + 2]
        c0, c1, c2 = factor[2, p], factor[2, p + 1], factor[2, p + 2]
        for j in range(out.shape[1]):
            x[j] -= a0 * r[j] + a1 * s[j] + a2 * t[j]
            y[j] -= b0 * r[j] + b1 * s[j] + b2 * t[j]
            z[j] -= c0 * r[j] + c1 * s[j] + c2 * t[j]


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc", "nsz"})
def solve(
    first: np.ndarray,
    begin: np.ndarray,
    later: np.ndarray,
    panel: np.ndarray,
    widest: int,
    panels: np.ndarray,
    x: np.ndarray,
) -> None:
    """Solve in place for ``x`` (3 n,), in the order of elimination."""
    t = np.empty(widest, x.dtype)
    for s in range(len(first) - 1):
        k, b = 3 * (first[s + 1] - first[s]), 3 * (begin[s + 1] - begin[s])
        P, own, sums = panels[panel[s] : panel[s + 1]].reshape(k, k + b), x[3 * first[s] :], t[:b]
        sums[:] = 0
        for i in range(0, k, 3):
            u, v, w = own[i], own[i + 1], own[i + 2]
            r0, r1, r2 = P[i, k:], P[i + 1, k:], P[i + 2, k:]
            for j in range(len(sums)):
                sums[j] += u * r0[j] + v * r1[j] + w * r2[j]
        for e in range(begin[s], begin[s + 1]):
            for a in range(3):
                x[3 * later[e] + a] += sums[3 * (e - begin[s]) + a]
    for s in range(len(first) - 2, -1, -1):
        k, b = 3 * (first[s + 1] - first[s]), 3 * (begin[s + 1] - begin[s])
        P, own, given = panels[panel[s] : panel[s + 1]].reshape(k, k + b), x[3 * first[s] :], t[: k + b]
        given[:k] = own[:k]
        for e in range(begin[s], begin[s + 1]):
            for a in range(3):
                given[k + 3 * (e - begin[s]) + a] = x[3 * later[e] + a]
        for i in range(0, k, 3):
            u = v = w = x.dtype.type(0)
            r0, r1, r2 = P[i], P[i + 1], P[i + 2]
            for j in range(len(given)):
                u += r0[j] * given[j]
                v += r1[j] * given[j]
                w += r2[j] * given[j]
            own[i], own[i + 1], own[i + 2] = u, v, w
