"""The cells of Eq. 1: every vertex with the edges around it, as kernels.

    E(U) = sum_i sum_{j in N(i)} w_ij |(u_i - u_j) - R_i (v_i - v_j)|^2                  (Eq. 1)

Every undirected edge counts twice, once in the cell of either end.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from apd_viewer.geometry.rotations import fit_rotation

FLAT = np.empty((0, 3, 3))


@njit(cache=True, nogil=True)
def local_step(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    S0: np.ndarray,
    coupling: float,
    q: np.ndarray,
    R: np.ndarray,
) -> None:
    """Set ``q`` (n, 4) and ``R`` (n, 3, 3) to the rotations that are optimal for ``U``, warm-started.

    Parameters
    ----------
    start, neighbour, w
        The edges and their weights, in compressed sparse rows.
    V, U : (n, 3) float array
        Rest positions and positions.
    S0 : (n, 3, 3) or (0, 3, 3) float array
        What other terms than Eq. 1 say about the rotations, in ``tr(R_i^T S_i)``; FLAT where there are none.
    coupling : float
        Weight of ``1 / (2 deg i) sum_j |R_i - R_j|^2``. With it the rotations are improved one after another,
        once each, as CGAL does it [Levi & Gotsman 2015, Smooth Rotation Enhanced As-Rigid-As-Possible Mesh
        Animation].
    """
    S, K, E = np.empty((3, 3)), np.empty((4, 4)), np.empty((4, 4))
    for i in range(V.shape[0]):
        if len(S0):
            S[:] = S0[i]
        else:
            S[:] = 0.0
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            for b in range(3):
                rest = w[e] * (V[i, b] - V[j, b])
                S[0, b] += (U[i, 0] - U[j, 0]) * rest
                S[1, b] += (U[i, 1] - U[j, 1]) * rest
                S[2, b] += (U[i, 2] - U[j, 2]) * rest
        if coupling > 0.0:
            share = coupling / max(start[i + 1] - start[i], 1)
            for e in range(start[i], start[i + 1]):
                for a in range(3):
                    for b in range(3):
                        S[a, b] += share * R[neighbour[e], a, b]
        fit_rotation(S, q[i], R[i], K, E)


@njit(cache=True, nogil=True)
def pull(
    start: np.ndarray, neighbour: np.ndarray, w: np.ndarray, V: np.ndarray, R: np.ndarray, b: np.ndarray
) -> None:
    """Write ``b_i = sum_j w_ij / 2 (R_i + R_j)(v_i - v_j)`` into ``b`` (n, 3): grad E = 4 (L U - b)."""
    for i in range(V.shape[0]):
        b[i] = 0.0
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            half = 0.5 * w[e]
            x, y, z = half * (V[i, 0] - V[j, 0]), half * (V[i, 1] - V[j, 1]), half * (V[i, 2] - V[j, 2])
            for a in range(3):
                b[i, a] += (
                    (R[i, a, 0] + R[j, a, 0]) * x
                    + (R[i, a, 1] + R[j, a, 1]) * y
                    + (R[i, a, 2] + R[j, a, 2]) * z
                )


@njit(cache=True, nogil=True)
def energy(
    start: np.ndarray, neighbour: np.ndarray, w: np.ndarray, V: np.ndarray, U: np.ndarray, R: np.ndarray
) -> float:
    """Eq. 1 at ``U`` (n, 3) with the rotations ``R`` (n, 3, 3)."""
    total = 0.0
    for i in range(V.shape[0]):
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            x, y, z = V[i, 0] - V[j, 0], V[i, 1] - V[j, 1], V[i, 2] - V[j, 2]
            cell = 0.0
            for a in range(3):
                d = U[i, a] - U[j, a] - (R[i, a, 0] * x + R[i, a, 1] * y + R[i, a, 2] * z)
                cell += d * d
            total += w[e] * cell
    return total
