"""Kernels of the supernodal factorization: see :mod:`supernodal_factor`.

``tree`` are ``first, begin, later`` of :class:`~apd_viewer.geometry.linalg.supernodes.Supernodes`, and
``panel``, where the rows ``[W | S]`` of each supernode begin in ``panels``. Indices of the solve are
unsigned: numba then counts none from the end, and the compiler makes vectors of its loops.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.threads import parallel

_ONE, _TWO, _THREE, _FOUR = (np.uintp(k) for k in (1, 2, 3, 4))
# Sums may be in any order that is the same each time.
_SUMS = {"contract", "reassoc", "nsz"}


def row_length(width: np.ndarray) -> np.ndarray:
    """Length of the rows of a panel for so many columns: whole vectors, of any processor but the widest."""
    return (width + 7) // 8 * 8


@parallel()
def factorize(
    tree: tuple[np.ndarray, ...],
    kin: tuple[np.ndarray, ...],
    matrix: tuple[np.ndarray, ...],
    tasks: tuple[np.ndarray, ...],
    panels: np.ndarray,
) -> bool:
    """Write ``[W | S]`` of all supernodes; False if the matrix is not positive definite.

    Parameters
    ----------
    kin
        ``child, sibling`` of the supernodes.
    matrix
        ``order, place`` of the elimination, and ``start, column, entry`` of the rows.
    tasks : task, turn, share, stack
        Core i has the tasks ``turn[share[i]:share[i + 1]]``.
    panels : (p,) float32 array
        To be written.
    """
    task, turn, share, base = tasks
    where, stack = np.empty(len(kin[0]), np.int64), np.empty(base[-1])
    definite = np.ones(len(task), np.bool_)
    for core in prange(len(share) - 1):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            definite[t] = _eliminate(task[t], task[t + 1], base[t], tree, kin, matrix, where, stack, panels)
    top = len(task) - 1
    if definite.all():
        definite[top] = _eliminate(task[top], len(where), base[top], tree, kin, matrix, where, stack, panels)
    return definite.all()


@njit(cache=True, nogil=True)
def _eliminate(
    begin_at: int,
    end_at: int,
    base: int,
    tree: tuple[np.ndarray, ...],
    kin: tuple[np.ndarray, ...],
    matrix: tuple[np.ndarray, ...],
    where: np.ndarray,
    stack: np.ndarray,
    panels: np.ndarray,
) -> bool:
    """Eliminate the supernodes from ``begin_at`` to ``end_at``; their contributions lie on the stack."""
    first, begin, later, panel = tree
    widest = 0
    for s in range(begin_at, end_at):
        widest = max(widest, first[s + 1] - first[s] + begin[s + 1] - begin[s])
    fronts, inverses = np.empty(widest * widest), np.empty(widest * widest)
    at, top = np.empty(len(matrix[0]), np.int32), base
    for s in range(begin_at, end_at):
        k, b = first[s + 1] - first[s], begin[s + 1] - begin[s]
        front = fronts[: (k + b) * (k + b)].reshape(k + b, k + b)
        for i in range(first[s], first[s + 1]):
            at[i] = i - first[s]
        for e in range(begin[s], begin[s + 1]):
            at[later[e]] = k + e - begin[s]
        _add_rows(front, first[s], first[s + 1], at, matrix)
        c = kin[0][s]
        while c >= 0:
            b_c = begin[c + 1] - begin[c]
            given = stack[where[c] : where[c] + b_c * b_c].reshape(b_c, b_c)
            _add_contribution(front, given, at, later[begin[c] : begin[c + 1]])
            if c >= begin_at:
                top = min(top, where[c])
            c = kin[1][c]
        inverse = inverses[: k * k].reshape(k, k)
        if not _condense(front, inverse):
            return False
        out = panels[panel[s] : panel[s + 1]].reshape(k, (panel[s + 1] - panel[s]) // k)
        out[:, :b], out[:, b : b + k], out[:, b + k :] = -front[:k, k:], inverse, 0.0
        where[s] = top
        stack[top : top + b * b].reshape(b, b)[:] = front[k:, k:]
        top += b * b
    return True


@njit(cache=True, nogil=True)
def _add_rows(
    front: np.ndarray, begin_at: int, end_at: int, at: np.ndarray, matrix: tuple[np.ndarray, ...]
) -> None:
    """Write the entries of the places from ``begin_at`` to ``end_at`` into the upper triangle."""
    order, place, start, column, entry = matrix
    front[:] = 0.0
    for i in range(begin_at, end_at):
        for e in range(start[order[i]], start[order[i] + 1]):
            j = place[column[e]]
            if j >= i:
                front[at[i], at[j]] += entry[e]


@njit(cache=True, nogil=True)
def _add_contribution(front: np.ndarray, given: np.ndarray, at: np.ndarray, later: np.ndarray) -> None:
    """Add a child's upper triangle ``given`` to that of its parent's ``front``."""
    for d in range(len(later)):
        row, values = front[at[later[d]]], given[d]
        for e in range(d, len(later)):
            row[at[later[e]]] += values[e]


@njit(cache=True, nogil=True, error_model="numpy")
def _condense(front: np.ndarray, inverse: np.ndarray) -> bool:
    """Eliminate as many unknowns of a ``front`` as ``inverse`` has rows; False if it is not definite.

    The upper triangle ``[[A, B], [., C]]`` becomes ``[[., A^-1 B], [., C - B^T A^-1 B]]``; ``inverse``, A^-1.
    """
    k, w = len(inverse), len(front)
    factor, inverse[:] = np.empty((4, k)), 0.0
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
        factor[0, : k - 1 - i] = front[i, i + 1 : k]
        known = factor[0, : k - 1 - i]
        _subtract(front[i, k:], known, front[i + 1 : k, k:])
        _subtract(inverse[i], known, inverse[i + 1 :])
        front[i, k:] /= front[i, i]
        inverse[i] /= front[i, i]
    return True


# Four rows at a time: what is subtracted from is read and written a quarter as often.


@njit(cache=True, nogil=True, fastmath={"contract"})
def _subtract(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
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
def _subtract_four(out: np.ndarray, factor: np.ndarray, rows: np.ndarray) -> None:
    """``out -= factor rows`` of the shapes (4, m), (4, p) and (p, m)."""
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


@parallel(fastmath=_SUMS)
def solve(
    tree: tuple[np.ndarray, ...],
    task: np.ndarray,
    turn: np.ndarray,
    share: np.ndarray,
    order: np.ndarray,
    panels: np.ndarray,
    scratch: tuple[np.ndarray, ...],
    B: np.ndarray,
    X: np.ndarray,
) -> None:
    """Write the solution ``X`` (n, 3) for ``B`` (n, 3).

    Parameters
    ----------
    tree, task
        Unsigned.
    turn, share
        See :func:`factorize`.
    scratch : x, sums, columns
        (n, 3), (t, top, 3) and (c, 3, w) float32 arrays: the solution in the order of elimination, what
        each task adds to the top of the tree, and the columns of a supernode.
    """
    x, sums, columns = scratch
    cores = len(share) - 1
    for core in prange(cores):
        for i in range(len(x) * core // cores, len(x) * (core + 1) // cores):
            for d in range(3):
                x[i, d] = B[order[i], d]
    for core in prange(cores):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            sums[t] = 0.0
            _forward(task[t], task[t + 1], tree, panels, x, sums[t], columns[core])
    top = len(x) - sums.shape[1]
    for t in range(len(task) - 1):
        x[top:] += sums[t]
    groups = np.uintp(len(tree[0]) - 1)
    _forward(task[-1], groups, tree, panels, x, x[len(x) :], columns[0])
    _backward(task[-1], groups, tree, panels, x, columns[0])
    for core in prange(cores):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            _backward(task[t], task[t + 1], tree, panels, x, columns[core])
    for core in prange(cores):
        for i in range(len(x) * core // cores, len(x) * (core + 1) // cores):
            for d in range(3):
                X[order[i], d] = x[i, d]


@njit(cache=True, nogil=True)
def _rounded(n: int) -> int:
    """``n``, unsigned, rounded up to whole vectors."""
    return (n + np.uintp(7)) // np.uintp(8) * np.uintp(8)


@njit(cache=True, nogil=True, fastmath=_SUMS)
def _forward(
    begin_at: int,
    end_at: int,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    beyond: np.ndarray,
    columns: np.ndarray,
) -> None:
    """``x_later += W^T x`` of the supernodes from ``begin_at`` to ``end_at``.

    What comes after all places of ``x`` but those of ``beyond`` is added to ``beyond`` instead.
    """
    first, begin, later, panel = tree
    t, u, v = columns[0], columns[1], columns[2]
    own = np.uintp(len(x) - len(beyond))
    for s in range(begin_at, end_at):
        i, end, b = first[s], first[s + _ONE], begin[s + _ONE] - begin[s]
        w, whole, p = _rounded(end - i + b), _rounded(b), panel[s]
        for j in range(whole):
            t[j] = u[j] = v[j] = 0.0
        while i + _THREE < end:
            j1, j2, j3 = i + _ONE, i + _TWO, i + _THREE
            a0, a1, a2, a3 = x[i, 0], x[j1, 0], x[j2, 0], x[j3, 0]
            b0, b1, b2, b3 = x[i, 1], x[j1, 1], x[j2, 1], x[j3, 1]
            c0, c1, c2, c3 = x[i, 2], x[j1, 2], x[j2, 2], x[j3, 2]
            p1 = p + w
            p2 = p1 + w
            p3 = p2 + w
            for j in range(whole):
                q0, q1, q2, q3 = panels[p + j], panels[p1 + j], panels[p2 + j], panels[p3 + j]
                t[j] += a0 * q0 + a1 * q1 + a2 * q2 + a3 * q3
                u[j] += b0 * q0 + b1 * q1 + b2 * q2 + b3 * q3
                v[j] += c0 * q0 + c1 * q1 + c2 * q2 + c3 * q3
            p, i = p3 + w, i + _FOUR
        while i < end:
            a0, b0, c0 = x[i, 0], x[i, 1], x[i, 2]
            for j in range(whole):
                q0 = panels[p + j]
                t[j] += a0 * q0
                u[j] += b0 * q0
                v[j] += c0 * q0
            p, i = p + w, i + _ONE
        for j in range(b):
            i = later[begin[s] + j]
            if i < own:
                x[i, 0] += t[j]
                x[i, 1] += u[j]
                x[i, 2] += v[j]
            else:
                beyond[i - own, 0] += t[j]
                beyond[i - own, 1] += u[j]
                beyond[i - own, 2] += v[j]


@njit(cache=True, nogil=True, fastmath=_SUMS)
def _backward(
    begin_at: int,
    end_at: int,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    columns: np.ndarray,
) -> None:
    """``x = S x + W x_later`` of the supernodes from ``end_at`` back to ``begin_at``."""
    first, begin, later, panel = tree
    t, u, v = columns[0], columns[1], columns[2]
    zero = x.dtype.type(0)
    s = end_at
    while s > begin_at:
        s = s - _ONE
        i, end = first[s], first[s + _ONE]
        k, b = end - i, begin[s + _ONE] - begin[s]
        w = _rounded(k + b)
        for j in range(b):
            e = later[begin[s] + j]
            t[j], u[j], v[j] = x[e, 0], x[e, 1], x[e, 2]
        for j in range(k):
            t[b + j], u[b + j], v[b + j] = x[i + j, 0], x[i + j, 1], x[i + j, 2]
        for j in range(k + b, w):
            t[j] = u[j] = v[j] = zero
        # From the last row to the first, as the supernodes: the memory is read steadily in one direction.
        p = panel[s] + k * w
        while end > i + _ONE:
            p1 = p - w
            p = p1 - w
            end = end - _TWO
            a0 = a1 = b0 = b1 = c0 = c1 = zero
            for j in range(w):
                q0, q1 = panels[p + j], panels[p1 + j]
                a0 += q0 * t[j]
                b0 += q0 * u[j]
                c0 += q0 * v[j]
                a1 += q1 * t[j]
                b1 += q1 * u[j]
                c1 += q1 * v[j]
            x[end, 0], x[end, 1], x[end, 2] = a0, b0, c0
            x[end + _ONE, 0], x[end + _ONE, 1], x[end + _ONE, 2] = a1, b1, c1
        if end > i:
            p = p - w
            a0 = b0 = c0 = zero
            for j in range(w):
                q0 = panels[p + j]
                a0 += q0 * t[j]
                b0 += q0 * u[j]
                c0 += q0 * v[j]
            x[i, 0], x[i, 1], x[i, 2] = a0, b0, c0
