"""Fill-reducing order of elimination by nested dissection.

A part of the mesh is cut in two halves, and the vertices along the cut, the separator, are eliminated after
both; so on with each half [George 1973, Nested Dissection of a Regular Finite Element Mesh]. Planes across
the axes cut a surface about as short as the best cuts of its graph do, and are found sooner.
"""

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit

# Largest number of unknowns of a part left uncut.
_LEAF = 10
# Smallest fraction of vertices in either half; many vertices may lie in the plane of a cut.
_LEAST_HALF = 0.25


def elimination_order(
    V: np.ndarray, start: np.ndarray, column: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order of elimination, and the tree of the groups eliminated together.

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
    order, first, parent = _dissection(np.ascontiguousarray(V), start, column, _LEAF)
    found = np.argsort(first)
    rank = np.empty_like(found)
    rank[found] = np.arange(len(found))
    parent = parent[found]
    return order, np.append(first[found], len(order)), np.where(parent >= 0, rank[parent], -1)


@njit(cache=True, nogil=True)
def _dissection(
    V: np.ndarray, start: np.ndarray, column: np.ndarray, leaf: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order of elimination, and the start and parent of each group, parents first."""
    n = len(V)
    order, side, first, parent = np.arange(n), np.full(n, -1), np.empty(n, np.int64), np.empty(n, np.int64)
    heights, arranged, graph = np.empty(n), np.empty(n, np.int64), (start, column)
    label = groups = 0
    todo = [(0, n, -1)]
    while len(todo):
        a, b, above = todo.pop()
        part, fewest, lower, upper = order[a:b], b - a, 0, 0
        if b - a > leaf:
            for axis in range(3):
                label += 2
                count = _label_halves(V, part, axis, heights, side, label)
                if min(count, b - a - count) < _LEAST_HALF * (b - a):
                    continue
                of_lower, of_upper = _count_borders(graph, part, side, label)
                cut, separator = int(of_upper < of_lower), min(of_lower, of_upper)
                halves = b - a - count - separator * (1 - cut), count - separator * cut
                if separator < fewest and min(halves) > 0:
                    fewest, (lower, upper) = separator, halves
                    _arrange(graph, part, side, label, cut, halves, arranged)
        if lower > 0:
            for k in range(b - a):
                part[k] = arranged[k]
        if lower + upper < b - a:
            first[groups], parent[groups] = a + lower + upper, above
            above = groups
            groups += 1
        if lower > 0:
            todo.append((a, a + lower, above))
            todo.append((a + lower, a + lower + upper, above))
    return order, first[:groups], parent[:groups]


@njit(cache=True, nogil=True)
def _label_halves(
    V: np.ndarray, vertices: np.ndarray, axis: int, heights: np.ndarray, side: np.ndarray, label: int
) -> int:
    """Label the halves of ``vertices``; return the size of the upper one."""
    n = len(vertices)
    for k in range(n):
        heights[k] = V[vertices[k], axis]
    middle = _kth_smallest(heights[:n], n // 2)
    above = at = 0
    for k in range(n):
        height = V[vertices[k], axis]
        above += height > middle
        at += height == middle
    # All vertices at the height of the cut go to the same side, so that grids are cut along their lines.
    includes = abs(2 * (above + at) - n) <= abs(2 * above - n)
    for k in range(n):
        height = V[vertices[k], axis]
        side[vertices[k]] = label + int(height > middle or (includes and height == middle))
    return above + at if includes else above


@njit(cache=True, nogil=True)
def _kth_smallest(x: np.ndarray, k: int) -> float:
    """The k-th smallest of ``x``, reordered [Hoare 1961, Algorithm 65: Find]."""
    low, high = 0, len(x) - 1
    while low < high:
        pivot, i, j = x[(low + high) // 2], low, high
        while i <= j:
            while x[i] < pivot:
                i += 1
            while x[j] > pivot:
                j -= 1
            if i <= j:
                x[i], x[j] = x[j], x[i]
                i, j = i + 1, j - 1
        if k <= j:
            high = j
        elif k >= i:
            low = i
        else:
            break
    return x[k]


@njit(cache=True, nogil=True)
def _has_neighbour(graph: tuple[np.ndarray, np.ndarray], v: int, side: np.ndarray, label: int) -> bool:
    """True if ``v`` has a neighbour labelled ``label``."""
    start, column = graph
    for e in range(start[v], start[v + 1]):  # noqa: SIM110 -- numba knows no any()
        if side[column[e]] == label:
            return True
    return False


@njit(cache=True, nogil=True)
def _count_borders(
    graph: tuple[np.ndarray, np.ndarray], vertices: np.ndarray, side: np.ndarray, label: int
) -> tuple[int, int]:
    """Numbers of vertices of each half with neighbours in the other one."""
    lower = upper = 0
    for v in vertices:
        if _has_neighbour(graph, v, side, 2 * label + 1 - side[v]):
            upper += side[v] - label
            lower += label + 1 - side[v]
    return lower, upper


@njit(cache=True, nogil=True)
def _arrange(
    graph: tuple[np.ndarray, np.ndarray],
    vertices: np.ndarray,
    side: np.ndarray,
    label: int,
    cut: int,
    halves: tuple[int, int],
    out: np.ndarray,
) -> None:
    """Write both halves, then the separator: the border of the half ``cut``, 0 or 1."""
    i, j, k = 0, halves[0], halves[0] + halves[1]
    for v in vertices:
        if side[v] == label + cut and _has_neighbour(graph, v, side, label + 1 - cut):
            out[k] = v
            k += 1
        elif side[v] == label:
            out[i] = v
            i += 1
        else:
            out[j] = v
            j += 1
