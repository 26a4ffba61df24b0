"""Disjoint sets with union by lowest member."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit


@njit(cache=True, nogil=True)
def root(parent: np.ndarray, k: int) -> int:
    """The lowest known thing of the set of ``k``; the way to it is shortened."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@njit(cache=True, nogil=True)
def join(parent: np.ndarray, a: int, b: int) -> None:
    """Make one set of those of ``a`` and ``b``."""
    a, b = root(parent, a), root(parent, b)
    parent[max(a, b)] = min(a, b)
