"""The connected pieces of a surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit


@njit(cache=True, nogil=True)
def vertex_components(F: np.ndarray, n: int) -> np.ndarray:
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


class LooseComponent(NamedTuple):
    """A connected part with triangles of which no vertex is held.

    Attributes
    ----------
    first : int
        Its lowest vertex, which tells it from others.
    triangles : int
        How many it has.
    """

    first: int
    triangles: int


def face_components(F: np.ndarray) -> np.ndarray:
    """Lowest vertex of the connected part of every triangle of ``F`` (m, 3), (m,)."""
    number = vertex_components(F, int(F.max()) + 1)
    lowest = np.empty(number.max() + 1, dtype=np.int64)
    lowest[number[::-1]] = np.arange(len(number))[::-1]  # of several the last counts
    return lowest[number[F[:, 0]]]


def loose_components(component: np.ndarray, F: np.ndarray, is_held: np.ndarray) -> tuple[LooseComponent, ...]:
    """Parts without held vertices, the largest first.

    Parameters
    ----------
    component : (m,) int array
        See :func:`face_components`.
    F : (m, 3) int array
    is_held : (n,) bool array
    """
    sizes = np.bincount(component)
    sizes[component[is_held[F].any(axis=1)]] = 0
    loose = np.flatnonzero(sizes)
    loose = loose[np.argsort(-sizes[loose], kind="stable")]
    return tuple(LooseComponent(int(first), int(sizes[first])) for first in loose)


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
