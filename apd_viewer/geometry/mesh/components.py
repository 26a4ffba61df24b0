"""The connected pieces of a surface."""

from __future__ import annotations

import numpy as np
from numba import njit

from apd_viewer.geometry.mesh.union_find import join


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
    # Not scipy's connected_components: it holds the interpreter lock, and so blocks the window.
    parent = np.arange(n)
    for t in range(F.shape[0]):
        for c in range(2):
            join(parent, F[t, c], F[t, c + 1])
    number, count = np.empty(n, dtype=np.int64), 0
    for v in range(n):
        if parent[v] == v:
            number[v] = count
            count += 1
        else:  # towards a lower vertex with a known label
            number[v] = number[parent[v]]
    return number
