"""Multifrontal factorization of symmetric matrices of 3 x 3 blocks.

The unknowns of a group of nested dissection are eliminated together, from a dense matrix, the front, of
the group and the later unknowns that it is coupled with [Duff & Reid 1983, The Multifrontal Solution of
Indefinite Sparse Symmetric Linear Systems]. With the front ``[[A, B], [B^T, C]]``, what is kept is
``S = A^-1`` and ``W = -S B``, and ``C + B^T W`` is added to the fronts of later groups. Then a solution is

    forward   x_later += W^T x_group,       backward   x_group = S x_group + W x_later,

products of dense matrices with vectors, in the order of the memory. In single precision they are half the
memory to read: enough for steps, too little for results.

Groups of unknowns, ``first``, and what they are coupled with, ``begin, later``, are those of a
:class:`BlockPattern`, and so are the rows of blocks, ``start, column``.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.dense_elimination import condense, condense_by_blocks
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.parallel_ops import gathered_rows
from apd_viewer.geometry.linalg.supernodes import Supernodes
from apd_viewer.geometry.linalg.threads import one_blas_thread, parallel


class BlockPattern:
    """Symbolic Cholesky factorization of matrices with the same nonzero blocks.

    Parameters
    ----------
    V : (n, 3) float array
        Positions of the unknowns, 3-vectors.
    start, column : (n + 1,), (e,) int arrays
        Block columns of the block rows.

    Attributes
    ----------
    diagonal : (n,) int array
        The blocks of the diagonal.
    nodes : Supernodes
    panel : (g + 1,) int array
        Where ``[S | W]`` of each supernode begins.
    """

    def __init__(self, V: np.ndarray, start: np.ndarray, column: np.ndarray) -> None:
        self.start, self.column = start, column
        self.diagonal = np.flatnonzero(column == np.repeat(np.arange(len(start) - 1), np.diff(start)))
        self.nodes = Supernodes(V, start, column)
        self.panel = np.append(0, np.cumsum(9 * self.nodes.own_width * self.nodes.width))
        self.widest = 3 * int(self.nodes.width.max())

    def factor(self, blocks: np.ndarray, dtype: type = np.float32) -> BlockFactor:
        """Factor of the positive definite matrix with ``blocks`` (e, 3, 3)."""
        return BlockFactor(self, blocks, dtype)


class BlockFactor:
    """The factor of a symmetric positive definite matrix of 3 x 3 blocks.

    Parameters
    ----------
    pattern : BlockPattern
    blocks : (e, 3, 3) float array
    dtype : type
        Of what is kept: float32 or float64.

    Raises
    ------
    ValueError
        If the matrix is not positive definite.
    """

    def __init__(self, pattern: BlockPattern, blocks: np.ndarray, dtype: type = np.float32) -> None:
        self._pattern = pattern
        self._panels = np.empty(pattern.panel[-1], dtype)
        nodes = pattern.nodes
        tree = nodes.first, nodes.begin, nodes.later, pattern.panel, nodes.child, nodes.sibling
        matrix = nodes.order, nodes.place, pattern.start, pattern.column, blocks
        with one_blas_thread():
            tasks = nodes.task, *nodes.tasks_by_core(), 9 * nodes.stack
            is_definite = factorize(tree, matrix, tasks, self._panels)
        if not is_definite:
            raise ValueError("the matrix is not positive definite")

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, 3); about six digits in single precision."""
        nodes, panel = self._pattern.nodes, self._pattern.panel
        x = gathered_rows(B, nodes.order).astype(self._panels.dtype).ravel()
        tree, tasks = (nodes.first, nodes.begin, nodes.later, panel), (nodes.task, *nodes.tasks_by_core())
        solve(tree, tasks, self._pattern.widest, self._panels, x)
        X = np.empty_like(B)
        X[nodes.order] = x.reshape(-1, 3)
        return X


# Smallest number of unknowns in a group for which BLAS calls pay off.
_WIDE = 36


@parallel()
def factorize(
    tree: tuple[np.ndarray, ...],
    matrix: tuple[np.ndarray, ...],
    tasks: tuple[np.ndarray, ...],
    panels: np.ndarray,
) -> bool:
    """Write ``[S | W]`` of all supernodes; False if the matrix is not definite.

    Parameters
    ----------
    tree
        ``first, begin, later, panel, child, sibling`` of the supernodes.
    matrix
        ``order, place`` of the elimination, and ``start, column, blocks`` of the rows.
    tasks : task, turn, share, stack
        Core i has the tasks ``turn[share[i]:share[i + 1]]``.
    panels : (p,) float array
        To be written.
    """
    task, turn, share, base = tasks
    where, stack = np.empty(len(tree[4]), np.int64), np.empty(base[-1])
    definite = np.ones(len(task), np.bool_)
    for core in prange(len(share) - 1):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            definite[t] = _eliminate(task[t], task[t + 1], base[t], tree, matrix, where, stack, panels)
    top = len(task) - 1
    if definite.all():
        definite[top] = _eliminate(task[top], len(where), base[top], tree, matrix, where, stack, panels)
    return bool(definite.all())


@njit(cache=True, nogil=True)
def _eliminate(
    begin_at: int,
    end_at: int,
    base: int,
    tree: tuple[np.ndarray, ...],
    matrix: tuple[np.ndarray, ...],
    where: np.ndarray,
    stack: np.ndarray,
    panels: np.ndarray,
) -> bool:
    """Eliminate the supernodes from ``begin_at`` to ``end_at``.

    Their contributions to later ones go to the stack; False if the matrix is not definite.
    """
    first, begin, later, panel, child, sibling = tree
    order, place, start, column, blocks = matrix
    widest = 0
    for s in range(begin_at, end_at):
        widest = max(widest, 3 * (first[s + 1] - first[s] + begin[s + 1] - begin[s]))
    fronts, inverses = np.empty(widest * widest), np.empty(widest * widest)
    at, top = np.empty(len(order), np.int64), base
    for s in range(begin_at, end_at):
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
                    for a in range(3):
                        for d in range(3):
                            front[at[i] + a, at[j] + d] = blocks[e, a, d]
        c = child[s]
        while c >= 0:
            width = 3 * (begin[c + 1] - begin[c])
            given = stack[where[c] : where[c] + width * width].reshape(width, width)
            _add_contribution(front, given, at, later[begin[c] : begin[c + 1]])
            if c >= begin_at:
                top = min(top, where[c])
            c = sibling[c]
        inverse = inverses[: k * k].reshape(k, k)
        is_definite = condense(front, inverse) if k < _WIDE else condense_by_blocks(front, inverse)
        if not is_definite:
            return False
        out = panels[panel[s] : panel[s + 1]].reshape(k, k + b)
        where[s] = top
        _write_panel(out, front, inverse)
        for i in range(b):
            for j in range(b):
                stack[top + i * b + j] = front[k + i, k + j]
        top += b * b
    return True


@njit(cache=True, nogil=True)
def _write_panel(out: np.ndarray, front: np.ndarray, inverse: np.ndarray) -> None:
    """Write the rows ``[S | W]`` of a group."""
    k = len(inverse)
    for i in range(k):
        for j in range(k):
            out[i, j] = inverse[i, j]
        for j in range(k, len(front)):
            out[i, j] = -front[i, j]


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


# Sums may be reordered, but in the same order each time.
_SUMS = {"contract", "reassoc", "nsz"}


@parallel(fastmath=_SUMS)
def solve(
    tree: tuple[np.ndarray, ...],
    tasks: tuple[np.ndarray, ...],
    widest: int,
    panels: np.ndarray,
    x: np.ndarray,
) -> None:
    """Solve in place for ``x`` (3 n,), in the order of elimination.

    Parameters
    ----------
    tree
        ``first, begin, later, panel`` of the supernodes.
    tasks : task, turn, share
        See :func:`~apd_viewer.geometry.linalg.block_cholesky.factorize`.
    widest : int
        Columns of the widest panel.
    """
    task, turn, share = tasks
    top, groups, cores = 3 * tree[0][task[-1]], len(tree[0]) - 1, len(share) - 1
    # What each task adds to the top of the tree.
    sums, columns = np.zeros((len(task) - 1, len(x) - top), x.dtype), np.empty((cores, widest), x.dtype)
    for core in prange(cores):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            _forward(task[t], task[t + 1], tree, panels, x, sums[t], columns[core])
    for t in range(len(sums)):
        for i in range(sums.shape[1]):
            x[top + i] += sums[t, i]
    _forward(task[-1], groups, tree, panels, x, x[len(x) :], columns[0])
    _backward(task[-1], groups, tree, panels, x, columns[0])
    for core in prange(cores):
        for e in range(share[core], share[core + 1]):
            t = turn[e]
            _backward(task[t], task[t + 1], tree, panels, x, columns[core])


@njit(cache=True, nogil=True, fastmath=_SUMS)
def _forward(
    begin_at: int,
    end_at: int,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    beyond: np.ndarray,
    column: np.ndarray,
) -> None:
    """Forward substitution through the supernodes ``begin_at`` to ``end_at``.

    Contributions to the last unknowns, as many as ``beyond`` has, are added to ``beyond`` instead.
    """
    first, begin, later, panel = tree
    own_end = len(x) - len(beyond)
    for s in range(begin_at, end_at):
        k, b = 3 * (first[s + 1] - first[s]), 3 * (begin[s + 1] - begin[s])
        P, own, sums = panels[panel[s] : panel[s + 1]].reshape(k, k + b), x[3 * first[s] :], column[:b]
        for j in range(b):
            sums[j] = 0
        for i in range(0, k, 3):
            u, v, w = own[i], own[i + 1], own[i + 2]
            r0, r1, r2 = P[i, k:], P[i + 1, k:], P[i + 2, k:]
            for j in range(len(sums)):
                sums[j] += u * r0[j] + v * r1[j] + w * r2[j]
        for e in range(begin[s], begin[s + 1]):
            i, j = 3 * later[e], 3 * (e - begin[s])
            for a in range(3):
                if i < own_end:
                    x[i + a] += sums[j + a]
                else:
                    beyond[i - own_end + a] += sums[j + a]


@njit(cache=True, nogil=True, fastmath=_SUMS)
def _backward(
    begin_at: int,
    end_at: int,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    column: np.ndarray,
) -> None:
    """Backward substitution from supernode ``end_at`` to ``begin_at``."""
    first, begin, later, panel = tree
    for s in range(end_at - 1, begin_at - 1, -1):
        k, b = 3 * (first[s + 1] - first[s]), 3 * (begin[s + 1] - begin[s])
        P, own, given = panels[panel[s] : panel[s + 1]].reshape(k, k + b), x[3 * first[s] :], column[: k + b]
        for j in range(k):
            given[j] = own[j]
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
