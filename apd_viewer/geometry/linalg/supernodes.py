"""Supernodes of a sparse symmetric matrix: unknowns eliminated together.

Each group of a nested dissection is a supernode: its unknowns are eliminated at once, from a dense matrix
[Ng & Peyton 1993, Block Sparse Cholesky Algorithms on Advanced Uniprocessor Computers]. Subtrees of
supernodes are independent, so they are tasks that can run in parallel; the rest, the top of the tree, follows
them. The tasks depend on the matrix alone, so sums are the same on any number of cores.
"""

import numba
import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.nested_dissection import elimination_order

# Largest fraction of the unknowns in one task.
_LARGEST_TASK = 1.0 / 4.0


class Supernodes:
    """Order of elimination, its supernodes, and their fill-in.

    Parameters
    ----------
    V : (n, 3) float array
        Positions of the unknowns; what is coupled should be near.
    start, column : (n + 1,), (e,) int arrays
        Rows of the matrix, in compressed sparse rows.

    Attributes
    ----------
    order, place : (n,) int64 arrays
        Unknowns in the order of elimination, and the place of each in it.
    first : (g + 1,) int64 array
        Supernode s has the places from ``first[s]`` to ``first[s + 1]``.
    begin, later : (g + 1,), (l,) int64 arrays
        It is coupled with the places ``later[begin[s]:begin[s + 1]]``, ascending and after its own.
    child, sibling : (g,) int64 arrays
        The tree of the supernodes: one child of each, and the next child of its parent; -1 for none.
    task : (t + 1,) int64 array
        Supernodes ``task[i]`` to ``task[i + 1]`` need no other task; the top begins at ``task[-1]``.
    stack : (t + 2,) int64 array
        Start of the contributions of each task and of the top, until the next one takes them.
    """

    def __init__(self, V: np.ndarray, start: np.ndarray, column: np.ndarray) -> None:
        order, first, parent = elimination_order(V, start, column)
        rank, self.task = _tasks(np.diff(first), parent, _LARGEST_TASK * len(order))
        self.order, self.first, parent = _ranked_supernodes(rank, order, first, parent)
        self.place = np.empty_like(self.order)
        self.place[self.order] = np.arange(len(self.order))
        self.child, self.sibling = children_of(parent)
        tree = self.first, self.child, self.sibling
        self.begin, self.later = couplings(*tree, self.order, self.place, start, column)
        self.stack = _stack(np.diff(self.begin), parent, self.task)
        kept = self.own_width * self.width
        self._work = np.add.reduceat(kept, self.task[:-1])[: len(self.task) - 1]
        self._shares: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def tasks_by_core(self) -> tuple[np.ndarray, np.ndarray]:
        """Tasks ordered by core, and the first position of each core's tasks."""
        cores = numba.get_num_threads()
        if cores not in self._shares:
            core_of, load = np.empty(len(self._work), dtype=np.int64), np.zeros(cores)
            for task in np.argsort(-self._work, kind="stable"):
                core_of[task] = np.argmin(load)
                load[core_of[task]] += self._work[task]
            turn = np.argsort(core_of, kind="stable")
            self._shares[cores] = turn, np.searchsorted(core_of[turn], np.arange(cores + 1))
        return self._shares[cores]

    @property
    def own_width(self) -> np.ndarray:
        """Numbers of unknowns of the supernodes, (g,) int64 array."""
        return np.diff(self.first)

    @property
    def width(self) -> np.ndarray:
        """Numbers of own and coupled unknowns of the supernodes, (g,) int64 array."""
        return self.own_width + np.diff(self.begin)

    @property
    def fill(self) -> int:
        """Number of stored entries of the factor."""
        return int(self.own_width @ self.width)


@njit(cache=True, nogil=True)
def _tasks(own: np.ndarray, parent: np.ndarray, largest: float) -> tuple[np.ndarray, np.ndarray]:
    """New ranks of the supernodes, the top of the tree last, and bounds of tasks."""
    unknowns, size = own.copy(), np.ones(len(own), np.int64)
    for s in range(len(own)):
        if parent[s] >= 0:
            unknowns[parent[s]] += unknowns[s]
            size[parent[s]] += size[s]
    rank, bounds = np.empty(len(own), np.int64), [0]
    below, filled = 0, 0
    for s in range(len(own)):
        if unknowns[s] > largest:
            continue
        rank[s] = below
        below += 1
        if parent[s] < 0 or unknowns[parent[s]] > largest:
            # Consecutive small subtrees share one task.
            if filled > 0 and filled + unknowns[s] > largest:
                bounds.append(below - size[s])
                filled = 0
            filled += unknowns[s]
    bounds.append(below)
    for s in range(len(own)):
        if unknowns[s] > largest:
            rank[s] = below
            below += 1
    return rank, np.array(bounds)


def _ranked_supernodes(
    rank: np.ndarray, order: np.ndarray, first: np.ndarray, parent: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order, starts and parents of the supernodes, sorted by ``rank``."""
    own = np.diff(first)
    supernodes = np.argsort(rank)
    moved = np.append(0, np.cumsum(own[supernodes]))
    places = np.arange(len(order)) - np.repeat(moved[:-1] - first[supernodes], own[supernodes])
    above = parent[supernodes]
    return order[places], moved, np.where(above >= 0, rank[above], -1)


@njit(cache=True, nogil=True)
def children_of(parent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First child and next sibling of each supernode; -1 for none."""
    child, sibling = np.full_like(parent, -1), np.full_like(parent, -1)
    for s in range(len(parent)):
        if parent[s] >= 0:
            sibling[s], child[parent[s]] = child[parent[s]], s
    return child, sibling


@njit(cache=True, nogil=True)
def couplings(
    first: np.ndarray,
    child: np.ndarray,
    sibling: np.ndarray,
    order: np.ndarray,
    place: np.ndarray,
    start: np.ndarray,
    column: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Later positions coupled with each supernode, in compressed rows."""
    groups, n = len(first) - 1, len(order)
    begin, later, seen = np.zeros(groups + 1, np.int64), np.empty(4 * n, np.int64), np.full(n, -1)
    for s in range(groups):
        end, count = first[s + 1], begin[s]
        if count + n > len(later):
            later = np.concatenate((later, np.empty(len(later) + n, np.int64)))
        for i in range(first[s], end):
            for e in range(start[order[i]], start[order[i] + 1]):
                j = place[column[e]]
                if j >= end and seen[j] != s:
                    seen[j], later[count] = s, j
                    count += 1
        c = child[s]
        while c >= 0:
            for e in range(begin[c], begin[c + 1]):
                j = later[e]
                if j >= end and seen[j] != s:
                    seen[j], later[count] = s, j
                    count += 1
            c = sibling[c]
        begin[s + 1] = count
        later[begin[s] : count].sort()
    return begin, later[: begin[-1]].copy()


@njit(cache=True, nogil=True)
def _stack(coupled: np.ndarray, parent: np.ndarray, task: np.ndarray) -> np.ndarray:
    """Bounds of the contributions of tasks and top, each ``coupled`` squared long."""
    begin = np.zeros(len(task) + 1, np.int64)
    waiting = np.zeros(len(coupled), np.int64)
    for t in range(len(task)):
        top = most = 0
        for s in range(task[t], task[t + 1] if t + 1 < len(task) else len(coupled)):
            top += coupled[s] ** 2 - waiting[s]
            most = max(most, top)
            if parent[s] >= 0 and (parent[s] < task[-1] or t + 1 == len(task)):
                waiting[parent[s]] += coupled[s] ** 2
        begin[t + 1] = begin[t] + most
    return begin
