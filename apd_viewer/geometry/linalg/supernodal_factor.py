"""Supernodal factorization of sparse symmetric positive definite matrices.

All unknowns of a supernode are eliminated at once, from a dense matrix, the front, of its own and those that
it is coupled with [Duff & Reid 1983, The Multifrontal Solution of Indefinite Sparse Symmetric Linear
Systems]. With the front ``[[A, B], [B^T, C]]``, what is kept is ``S = A^-1`` and ``W = -S B``, and
``C + B^T W`` is added to the fronts of later supernodes. Then a solution is

    forward   x_later += W^T x,       backward   x = S x + W x_later,

products of dense matrices with three vectors each, in the order of the memory. Matrices are eliminated in
double precision and kept in single: half the memory to read. That is enough for steps, and one refinement
[Wilkinson 1963] makes results of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
from scipy.sparse import csr_array

from apd_viewer.geometry.linalg import parallel_ops, supernodal, supernodal_solve
from apd_viewer.geometry.linalg.supernodes import Supernodes


class SupernodalFactor:
    """The factor of a symmetric positive definite matrix.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite, columns ascending.
    nodes : Supernodes
        Of its rows.

    Raises
    ------
    ValueError
        If ``A`` is not positive definite.
    """

    def __init__(self, A: csr_array, nodes: Supernodes) -> None:
        self._A = A
        start, column = A.indptr, A.indices
        panel = np.append(0, np.cumsum(nodes.own * supernodal.row_length(nodes.width)))
        self._work = np.add.reduceat(np.diff(panel), nodes.task[:-1])[: len(nodes.task) - 1]
        self._shares: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self._panels = np.empty(panel[-1], dtype=np.float32)
        tree = nodes.first, nodes.begin, nodes.later, panel
        kin, matrix = (nodes.child, nodes.sibling), (nodes.order, nodes.place, start, column, A.data)
        tasks = nodes.task, *self._shared_out(), nodes.stack
        if not supernodal.factorize(tree, kin, matrix, tasks, self._panels):
            raise ValueError("the matrix is not positive definite")
        self._order = nodes.order.astype(np.uint32)
        self._tree = (
            *(each.astype(np.uintp) for each in tree[:2]),
            nodes.later.astype(np.uint32),
            panel.astype(np.uintp),
        )
        self._task = nodes.task.astype(np.uintp)
        n, top = len(A.indptr) - 1, len(self._order) - int(nodes.first[nodes.task[-1]])
        widest = int(supernodal.row_length(nodes.width).max(initial=0))
        columns = np.empty((numba.config.NUMBA_NUM_THREADS, 3, widest), np.float32)
        self._scratch = np.empty((n, 3), np.float32), np.empty((len(self._work), top, 3), np.float32), columns

    def _shared_out(self) -> tuple[np.ndarray, np.ndarray]:
        """Tasks in the order of the cores, and where those of each core begin."""
        cores = numba.get_num_threads()
        if cores not in self._shares:
            core_of, load = np.empty(len(self._work), dtype=np.int64), np.zeros(cores)
            for task in np.argsort(-self._work, kind="stable"):
                core_of[task] = np.argmin(load)
                load[core_of[task]] += self._work[task]
            turn = np.argsort(core_of, kind="stable")
            self._shares[cores] = turn, np.searchsorted(core_of[turn], np.arange(cores + 1))
        return self._shares[cores]

    def solve(self, B: np.ndarray) -> np.ndarray:
        """``A^-1 B`` to six digits or so, for ``B`` (n, k), float64."""
        return _in_threes(B, self._solve_three)

    def refined(self, B: np.ndarray) -> np.ndarray:
        """``A^-1 B`` to ten digits or so, for ``B`` (n, k), float64."""
        return _in_threes(B, self._refine_three)

    def _solve_three(self, B: np.ndarray) -> np.ndarray:
        X, (turn, share) = np.empty(B.shape), self._shared_out()
        supernodal_solve.solve(
            self._tree, self._task, turn, share, self._order, self._panels, self._scratch, B, X
        )
        return X

    def _refine_three(self, B: np.ndarray) -> np.ndarray:
        X = self._solve_three(B)
        X += self._solve_three(parallel_ops.residual(self._A, X, B))
        return X


def _in_threes(B: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Solutions (n, k) for ``B`` (n, k), of three columns at a time."""
    if B.shape[1] == 3:
        return solve(np.ascontiguousarray(B))
    X = np.zeros((len(B), -(-B.shape[1] // 3) * 3))
    X[:, : B.shape[1]] = B
    for k in range(0, X.shape[1], 3):
        X[:, k : k + 3] = solve(np.ascontiguousarray(X[:, k : k + 3]))
    return X[:, : B.shape[1]]
