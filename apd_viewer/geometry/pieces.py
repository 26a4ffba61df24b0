"""The connected pieces of a surface."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def pieces(F: np.ndarray, n: int) -> np.ndarray:
    """Number of the connected piece of every vertex, from 0.

    Parameters
    ----------
    F : (m, 3) int array
    n : int
        Number of vertices.

    Returns
    -------
    (n,) int array
        Equal for two vertices exactly if a path of edges joins them.
    """
    # Not scipy's connected_components: it holds the interpreter, and with it a window, while it works.
    parent = np.arange(n)
    for t in range(F.shape[0]):
        for c in range(2):
            a, b = _root(parent, F[t, c]), _root(parent, F[t, c + 1])
            parent[max(a, b)] = min(a, b)
    number, count = np.empty(n, dtype=np.int64), 0
    for v in range(n):
        if parent[v] == v:
            number[v] = count
            count += 1
        else:  # towards a lower vertex, whose number is known
            number[v] = number[parent[v]]
    return number


@njit(cache=True, nogil=True)
def _root(parent: np.ndarray, v: int) -> int:
    """The lowest known vertex of the piece of ``v``; the way to it is shortened."""
    while parent[v] != v:
        parent[v] = parent[parent[v]]
        v = parent[v]
    return v
