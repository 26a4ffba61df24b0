"""Discrete operators of a triangle mesh: areas, gradients, normals, cotangents, adjacency.

Throughout, ``V`` or ``U`` is an (n, 3) float array of positions in mesh units and ``F`` an (m, 3)
integer array of triangles, counter-clockwise seen from outside.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numba import njit


def vertex_neighbours(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """One-ring of every vertex as a compressed sparse row graph.

    Parameters
    ----------
    F : (m, 3) int array
        Triangles.
    n : int
        Number of vertices.

    Returns
    -------
    start : (n + 1,) int32 array
    neighbour : (k,) int32 array
        The neighbours of vertex ``i`` are ``neighbour[start[i]:start[i + 1]]``, ascending, without
        repetition and without ``i`` itself.
    """
    a, b = F.ravel(), np.roll(F, -1, axis=1).ravel()
    edge = a != b
    a, b = a[edge], b[edge]
    ones = np.ones(2 * len(a), dtype=np.int8)
    graph = sp.csr_array((ones, (np.concatenate([a, b]), np.concatenate([b, a]))), shape=(n, n))
    graph.sum_duplicates()
    return graph.indptr.astype(np.int32), graph.indices.astype(np.int32)


@njit(cache=True, nogil=True)
def vertex_normals(U, F, out):
    """Write unit vertex normals, weighted by triangle area, into ``out``.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array
    out : (n, 3) float array
        Overwritten. Rows of vertices without area become zero.
    """
    out[:] = 0.0
    for t in range(F.shape[0]):
        i, j, k = F[t]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for v in (i, j, k):
            out[v, 0] += x
            out[v, 1] += y
            out[v, 2] += z
    for v in range(out.shape[0]):
        length = np.sqrt(out[v, 0] ** 2 + out[v, 1] ** 2 + out[v, 2] ** 2)
        if length > 0.0:
            out[v] /= length
