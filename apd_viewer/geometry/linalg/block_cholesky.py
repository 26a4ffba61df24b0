"""Multifrontal factorization of symmetric matrices of 3 x 3 blocks.

The unknowns of a group of nested dissection are eliminated together, from a dense matrix, the front, of
the group and the later unknowns that it is coupled with [Duff & Reid 1983, The Multifrontal Solution of
Indefinite Sparse Symmetric Linear Systems]. With the front ``[[A, B], [B^T, C]]``, what is kept is
``S = A^-1`` and ``W = -S B``, and ``C + B^T W`` is added to the fronts of later groups. Then a solution is

    forward   x_later += W^T x_group,       backward   x_group = S x_group + W x_later,

products of dense matrices with vectors, in the order of the memory. They are kept in single precision,
half the memory to read: enough for steps, too little for results.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg import multifrontal, row_ops
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.nested_dissection import dissect
from apd_viewer.geometry.linalg.supernodes import children_of, couplings
from apd_viewer.geometry.linalg.threads import one_blas_thread


class BlockPattern:
    """Elimination of symmetric matrices with the same nonzero blocks.

    Parameters
    ----------
    V : (n, 3) float array
        Positions of the unknowns, 3-vectors.
    start, column : (n + 1,), (e,) int arrays
        Block columns of the block rows.

    Attributes
    ----------
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
        self.order, self.first, parent = dissect(V, start, column)
        self.place = np.empty_like(self.order)
        self.place[self.order] = np.arange(len(self.order))
        self.child, self.sibling = children_of(parent)
        tree = self.first, self.child, self.sibling
        self.begin, self.later = couplings(*tree, self.order, self.place, start, column)
        k, b = 3 * np.diff(self.first), 3 * np.diff(self.begin)
        self.panel = np.append(0, np.cumsum(k * (k + b)))
        self.widest = int((k + b).max())
        self.stack = int(_stack_length(b, parent))

    def factor(self, blocks: np.ndarray) -> BlockFactor:
        """Factor of the positive definite matrix with ``blocks`` (e, 3, 3)."""
        return BlockFactor(self, blocks)


class BlockFactor:
    """The factor of a symmetric positive definite matrix of 3 x 3 blocks.

    Parameters
    ----------
    pattern : BlockPattern
    blocks : (e, 3, 3) float array
    """

    def __init__(self, pattern: BlockPattern, blocks: np.ndarray) -> None:
        self._pattern = p = pattern
        self._panels = np.empty(p.panel[-1], dtype=np.float32)
        groups = p.first, p.begin, p.later, p.child, p.sibling
        matrix = p.order, p.place, p.start, p.column, blocks
        with one_blas_thread():
            multifrontal.eliminate(*groups, *matrix, p.panel, np.empty(p.stack), p.widest, self._panels)

    def solve(self, B: np.ndarray) -> np.ndarray:
        """``A^-1 B`` to six digits or so, for ``B`` (n, 3)."""
        p = self._pattern
        x = row_ops.gathered_rows(B, p.order).astype(self._panels.dtype).ravel()
        multifrontal.solve(p.first, p.begin, p.later, p.panel, p.widest, self._panels, x)
        X = np.empty_like(B)
        X[p.order] = x.reshape(-1, 3)
        return X


@njit(cache=True, nogil=True)
def _stack_length(b: np.ndarray, parent: np.ndarray) -> int:
    """Largest total size of waiting contributions, ``b`` x ``b`` each."""
    waiting = np.zeros(len(b), np.int64)
    top = most = 0
    for s in range(len(b)):
        top += b[s] * b[s] - waiting[s]
        most = max(most, top)
        if parent[s] >= 0:
            waiting[parent[s]] += b[s] * b[s]
    return most
