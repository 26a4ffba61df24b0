"""Supernodal factor of a sparse symmetric positive definite matrix.

All unknowns of a supernode are eliminated at once, from a dense matrix, the front, of its own and those that
it is coupled with [Duff & Reid 1983, The Multifrontal Solution of Indefinite Sparse Symmetric Linear
Systems]. With the front ``[[A, B], [B^T, C]]``, what is kept is ``S = A^-1`` and ``W = -S B``, and
``C + B^T W`` is added to the fronts of later supernodes. Then a solution is

    forward   x_later += W^T x,       backward   x = S x + W x_later,

products of dense matrices with three vectors each, in the order of the memory. Matrices are eliminated in
double precision and kept in single: half the memory to read. That is enough for steps, and one refinement
[Wilkinson 1963] makes results of it.

In the kernels ``tree`` are ``first, begin, later`` of
:class:`~apd_viewer.geometry.linalg.supernodes.Supernodes`, and ``panel``, where the rows ``[W | S]`` of each
supernode begin in ``panels``.

For solving, both have unsigned indices: numba counts none of them from the end, and the compiler makes
vectors of the loops.
"""

from collections.abc import Callable

import numba
import numpy as np
from numba import prange
from scipy.sparse import csr_array

from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.dense_elimination import condense
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.supernodes import Supernodes
from apd_viewer.geometry.linalg.threads import parallel


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
        panel = np.append(0, np.cumsum(nodes.own_width * row_length(nodes.width)))
        self._nodes = nodes
        self._panels = np.empty(panel[-1], dtype=np.float32)
        tree = nodes.first, nodes.begin, nodes.later, panel
        kin, matrix = (nodes.child, nodes.sibling), (nodes.order, nodes.place, start, column, A.data)
        tasks = nodes.task, *nodes.tasks_by_core(), nodes.stack
        if not factorize(tree, kin, matrix, tasks, self._panels):
            raise ValueError("the matrix is not positive definite")
        self._order = nodes.order.astype(np.uint32)
        self._tree = (
            *(each.astype(np.uintp) for each in tree[:2]),
            nodes.later.astype(np.uint32),
            panel.astype(np.uintp),
        )
        self._task = nodes.task.astype(np.uintp)
        n, top = len(A.indptr) - 1, len(self._order) - int(nodes.first[nodes.task[-1]])
        widest = int(row_length(nodes.width).max(initial=0))
        columns = np.empty((numba.config.NUMBA_NUM_THREADS, 3, widest), np.float32)
        self._scratch = (
            np.empty((n, 3), np.float32),
            np.empty((len(nodes.task) - 1, top, 3), np.float32),
            columns,
        )

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about six digits."""
        return _solve_by_threes(B, self._solve_three)

    def solve_refined(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about ten digits."""
        return _solve_by_threes(B, self._refine_three)

    def _solve_three(self, B: np.ndarray) -> np.ndarray:
        X, (turn, share) = np.empty(B.shape), self._nodes.tasks_by_core()
        solve(self._tree, self._task, turn, share, self._order, self._panels, self._scratch, B, X)
        return X

    def _refine_three(self, B: np.ndarray) -> np.ndarray:
        X = self._solve_three(B)
        X += self._solve_three(parallel_ops.residual(self._A, X, B))
        return X


def _solve_by_threes(B: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Solutions (n, k) for ``B`` (n, k), three columns at a time."""
    if B.shape[1] == 3:
        return solve(np.ascontiguousarray(B))
    X = np.zeros((len(B), -(-B.shape[1] // 3) * 3))
    X[:, : B.shape[1]] = B
    for k in range(0, X.shape[1], 3):
        X[:, k : k + 3] = solve(np.ascontiguousarray(X[:, k : k + 3]))
    return X[:, : B.shape[1]]


def row_length(width: np.ndarray) -> np.ndarray:
    """Length of a panel's rows, ``width`` rounded up to whole vectors."""
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

    Their contributions to later ones go to the stack; False if the matrix is not definite.
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
    """Write the rows ``[W | S]`` of a supernode, padded with zeros."""
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


_ONE, _TWO, _THREE, _FOUR = (np.uintp(k) for k in (1, 2, 3, 4))
# Sums may be reordered, but in the same order each time.
_SUMS = {"contract", "reassoc", "nsz"}


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
        See :func:`~apd_viewer.geometry.linalg.supernodal.factorize`.
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
            for i in range(sums.shape[1]):
                for d in range(3):
                    sums[t, i, d] = 0.0
            _forward(task[t], task[t + 1], tree, panels, x, sums[t], columns[core])
    top = len(x) - sums.shape[1]
    for t in range(len(task) - 1):
        for i in range(sums.shape[1]):
            for d in range(3):
                x[top + i, d] += sums[t, i, d]
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
def _rounded(n: np.uintp) -> np.uintp:
    """Unsigned ``n``, rounded up to whole vectors."""
    return (n + np.uintp(7)) // np.uintp(8) * np.uintp(8)


@njit(cache=True, nogil=True, fastmath=_SUMS)
def _forward(
    begin_at: np.uintp,
    end_at: np.uintp,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    beyond: np.ndarray,
    columns: np.ndarray,
) -> None:
    """Forward substitution through the supernodes ``begin_at`` to ``end_at``.

    ``x_later += W^T x`` for each. Contributions beyond the positions of ``x`` are added to ``beyond``
    instead.
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
    begin_at: np.uintp,
    end_at: np.uintp,
    tree: tuple[np.ndarray, ...],
    panels: np.ndarray,
    x: np.ndarray,
    columns: np.ndarray,
) -> None:
    """Backward substitution from supernode ``end_at`` to ``begin_at``.

    ``x = S x + W x_later`` for each.
    """
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
        # From the last row to the first, like the supernodes, so that memory is read in one direction.
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
