"""Kernels of the supernodal factorization: see :mod:`supernodal_factor`.

``tree`` are ``first, begin, later`` of :class:`~apd_viewer.geometry.linalg.supernodes.Supernodes`, and
``panel``, where the rows ``[W | S]`` of each supernode begin in ``panels``.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.dense_elimination import condense
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel


def row_length(width: np.ndarray) -> np.ndarray:
    """Length of the rows of a panel for so many columns: whole vectors."""
    return (width + 7) // 8 * 8


@parallel()
def factorize(
    tree: tuple[np.ndarray, ...],
    kin: tuple[np.ndarray, ...],
    matrix: tuple[np.ndarray, ...],
    tasks: tuple[np.ndarray, ...],
    panels: np.ndarray,
) -> bool:
    """Write ``[W | S]`` of all supernodes; False if the matrix is not definite.

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
    return bool(definite.all())


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
    """Eliminate the supernodes from ``begin_at`` to ``end_at``.

    What they contribute to later ones lies on the stack; False if the matrix is not definite.
    """
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
        if not condense(front, inverse):
            return False
        out = panels[panel[s] : panel[s + 1]].reshape(k, (panel[s + 1] - panel[s]) // k)
        where[s] = top
        _write_panel(out, front, inverse)
        for i in range(b):
            for j in range(b):
                stack[top + i * b + j] = front[k + i, k + j]
        top += b * b
    return True


@njit(cache=True, nogil=True)
def _write_panel(out: np.ndarray, front: np.ndarray, inverse: np.ndarray) -> None:
    """Write ``[W | S]``, its rows filled up with zeros."""
    k, b = len(inverse), len(front) - len(inverse)
    for i in range(k):
        for j in range(b):
            out[i, j] = -front[i, k + j]
        for j in range(k):
            out[i, b + j] = inverse[i, j]
        for j in range(b + k, out.shape[1]):
            out[i, j] = 0.0


@njit(cache=True, nogil=True)
def _add_rows(
    front: np.ndarray, begin_at: int, end_at: int, at: np.ndarray, matrix: tuple[np.ndarray, ...]
) -> None:
    """Write the entries from ``begin_at`` to ``end_at`` into the upper triangle."""
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
