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

from apd_viewer.geometry.linalg.dense_elimination import condense, condense_by_blocks
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.nested_dissection import elimination_order
from apd_viewer.geometry.linalg.parallel_ops import gathered_rows
from apd_viewer.geometry.linalg.supernodes import children_of, couplings
from apd_viewer.geometry.linalg.threads import one_blas_thread


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
    order, place : (n,) int arrays
        Unknowns in the order of elimination, and the place of each in it.
    first : (g + 1,) int array
        The first place of each group.
    child, sibling : (g,) int arrays
        The tree of the groups: one child of each, and the next child of its parent; -1 for none.
    begin, later : (g + 1,), (l,) int arrays
        Group s is coupled with the later unknowns at the places ``later[begin[s]:begin[s + 1]]``.
    panel : (g + 1,) int array
        Where ``[S | W]`` of each group begins.
    """

    def __init__(self, V: np.ndarray, start: np.ndarray, column: np.ndarray) -> None:
        self.start, self.column = start, column
        self.diagonal = np.flatnonzero(column == np.repeat(np.arange(len(start) - 1), np.diff(start)))
        self.order, self.first, parent = elimination_order(V, start, column)
        self.place = np.empty_like(self.order)
        self.place[self.order] = np.arange(len(self.order))
        self.child, self.sibling = children_of(parent)
        tree = self.first, self.child, self.sibling
        self.begin, self.later = couplings(*tree, self.order, self.place, start, column)
        k, b = 3 * np.diff(self.first), 3 * np.diff(self.begin)
        self.panel = np.append(0, np.cumsum(k * (k + b)))
        self.widest = int((k + b).max())
        self.stack = int(_stack_length(b, parent))

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
        self._pattern = p = pattern
        self._panels = np.empty(p.panel[-1], dtype)
        groups = p.first, p.begin, p.later, p.child, p.sibling
        matrix = p.order, p.place, p.start, p.column, blocks
        with one_blas_thread():
            is_definite = eliminate(*groups, *matrix, p.panel, np.empty(p.stack), p.widest, self._panels)
        if not is_definite:
            raise ValueError("the matrix is not positive definite")

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, 3); about six digits in single precision."""
        p = self._pattern
        x = gathered_rows(B, p.order).astype(self._panels.dtype).ravel()
        solve(p.first, p.begin, p.later, p.panel, p.widest, self._panels, x)
        X = np.empty_like(B)
        X[p.order] = x.reshape(-1, 3)
        return X


@njit(cache=True, nogil=True)
def _stack_length(b: np.ndarray, parent: np.ndarray) -> int:
    """Largest total size of the pending contributions, ``b`` x ``b`` each."""
    waiting = np.zeros(len(b), np.int64)
    top = most = 0
    for s in range(len(b)):
        top += b[s] * b[s] - waiting[s]
        most = max(most, top)
        if parent[s] >= 0:
            waiting[parent[s]] += b[s] * b[s]
    return most


# Smallest number of unknowns in a group for which BLAS calls pay off.
_WIDE = 36


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
) -> bool:
    """Factor all groups, writing the rows ``[S | W]`` of each into ``panels``.

    False, and the rest is not written, if the matrix is not positive definite.
    """
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
                    for a in range(3):
                        for d in range(3):
                            front[at[i] + a, at[j] + d] = blocks[e, a, d]
        c = child[s]
        while c >= 0:
            width = 3 * (begin[c + 1] - begin[c])
            given = stack[where[c] : where[c] + width * width].reshape(width, width)
            _add_contribution(front, given, at, later[begin[c] : begin[c + 1]])
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
        for j in range(b):
            sums[j] = 0
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
