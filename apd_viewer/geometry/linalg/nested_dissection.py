"""Fill-reducing order of elimination by nested dissection.

A part of the mesh is cut in two halves, and the vertices along the cut, the separator, are eliminated after
both; so on with each half [George 1973, Nested Dissection of a Regular Finite Element Mesh]. Planes across
the axes cut a surface about as short as the best cuts of its graph do, and are found sooner.
"""

from __future__ import annotations

import numpy as np
from numba import njit

# Parts of so few unknowns are not cut any more.
_LEAF = 10


def dissect(
    V: np.ndarray, start: np.ndarray, column: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order of elimination, and the tree of groups eliminated together.

    Parameters
    ----------
    V : (n, 3) float array
        Positions of the unknowns.
    start, column : (n + 1,), (e,) int arrays
        Neighbours of each, in compressed sparse rows: a symmetric graph.

    Returns
    -------
    order : (n,) int array
        Unknowns in the order of elimination.
    first : (g + 1,) int array
        Group k, a separator or an uncut part, is ``order[first[k]:first[k + 1]]``.
    parent : (g,) int array
        The separator that cut each group off; -1 where there is none. Children come before their parents.
    """
    order, first, parent = _dissected(np.ascontiguousarray(V), start, column, _LEAF)
    found = np.argsort(first)
    rank = np.empty_like(found)
    rank[found] = np.arange(len(found))
    parent = parent[found]
    return order, np.append(first[found], len(order)), np.where(parent >= 0, rank[parent], -1)


@njit(cache=True, nogil=True)
def _dissected(
    V: np.ndarray, start: np.ndarray, column: np.ndarray, leaf: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The order; the first place and the parent of each group, parents first."""
    n = len(V)
    order, side, first, parent = np.arange(n), np.full(n, -1), np.empty(n, np.int64), np.empty(n, np.int64)
    label = groups = 0
    todo = [(0, n, -1)]
    while len(todo):
        a, b, above = todo.pop()
        part = order[a:b].copy()
        lower = upper = 0
        if b - a > leaf:
            fewest = b - a
            for axis in range(3):
                along = part[np.argsort(V[part, axis])]
                label += 2
                arranged, before, after = _cut(along, start, column, side, label)
                if b - a - before - after < fewest:
                    fewest, lower, upper = b - a - before - after, before, after
                    order[a:b] = arranged
        if lower == 0 or upper == 0:
            lower = upper = 0
        if lower + upper < b - a:
            first[groups], parent[groups] = a + lower + upper, above
            above = groups
            groups += 1
        if lower > 0:
            todo.append((a, a + lower, above))
            todo.append((a + lower, a + lower + upper, above))
    return order, first[:groups], parent[:groups]


@njit(cache=True, nogil=True)
def _cut(
    part: np.ndarray, start: np.ndarray, column: np.ndarray, side: np.ndarray, label: int
) -> tuple[np.ndarray, int, int]:
    """Both halves of ``part``, then their separator; the lengths of the halves."""
    half = len(part) // 2
    for k in range(len(part)):
        side[part[k]] = label + (k >= half)
    border = np.zeros(len(part), np.bool_)
    count = np.zeros(2, np.int64)
    for k in range(len(part)):
        v, own = part[k], int(k >= half)
        for e in range(start[v], start[v + 1]):
            if side[column[e]] == label + 1 - own:
                border[k] = True
                count[own] += 1
                break
    cut_upper = count[1] < count[0]
    out = np.empty_like(part)
    lower = upper = 0
    for k in range(len(part)):
        if k < half and (cut_upper or not border[k]):
            out[lower] = part[k]
            lower += 1
    for k in range(half, len(part)):
        if not (cut_upper and border[k]):
            out[lower + upper] = part[k]
            upper += 1
    place = lower + upper
    for k in range(len(part)):
        if border[k] and (k >= half) == cut_upper:
            out[place] = part[k]
            place += 1
    return out, lower, upper
