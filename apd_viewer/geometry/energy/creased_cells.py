"""Cells of Eq. 1 with creases: rest edges bent as the surface around a vertex.

A cell resists bending, too, the less the finer the mesh. Where a crease is kept its edges follow, with their
lengths; d_ij is what that adds to ``v_i - v_j`` in the cell of vertex i:

    sum_ij w_ij |(u_i - u_j) - R_i (v_i - v_j + d_ij)|^2  -  the same without d
        = sum_ij w_ij d_ij . (d_ij + 2 (v_i - v_j) - 2 R_i^T (u_i - u_j))
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.quaternions import rotated_vector
from apd_viewer.geometry.linalg.threads import parallel, total

_TINY = np.finfo(float).tiny
# Vertices per task of a core.
_PORTION = 256


class CreasedCells:
    """Cells with creases: their difference from those of the flat surface.

    Parameters
    ----------
    rest : SolveMesh
    creased : (n,) bool array
        Vertices around which there are creases.
    committed_flow : (m, 3, 3, 3) float array
        For every corner of a triangle, what a crease adds to the gradient of its positions, seen from that
        vertex.
    """

    def __init__(self, rest: SolveMesh, creased: np.ndarray, committed_flow: np.ndarray) -> None:
        self._creased = creased.copy()
        self._start, self._neighbour, self._w = rest.graph
        n, F = len(rest.V), rest.F
        near = self._neighbour.astype(np.int64)
        start = self._start.astype(np.int64)
        i = np.repeat(np.arange(n), start[1:] - start[:-1])
        order = np.argsort(i * n + near)
        keys = (i * n + near)[order]
        self._back = order[np.searchsorted(keys, near * n + i)]
        edges = rest.V[near] - rest.V[i]
        bent, count = np.zeros_like(edges), np.zeros(len(edges))
        for c in range(3):
            for other in (F[:, (c + 1) % 3], F[:, (c + 2) % 3]):
                at = order[np.searchsorted(keys, F[:, c].astype(np.int64) * n + other)]
                along = rest.V[other] - rest.V[F[:, c]]
                np.add.at(bent, at, np.einsum("tab,tb->ta", committed_flow[:, c], along))
                np.add.at(count, at, 1.0)
        new = edges + bent / np.maximum(count, 1.0)[:, None]
        longer = np.linalg.norm(new, axis=1) / np.maximum(np.linalg.norm(edges, axis=1), _TINY)
        self._d = edges - new / np.maximum(longer, _TINY)[:, None]
        self._v = -edges

    def energy(self, U: np.ndarray, q: np.ndarray) -> float:
        """Difference that they make to Eq. 1 at ``U`` (n, 3), rotations ``q`` (n, 4)."""
        return float(_energy(self._start, self._neighbour, self._w, self._v, self._d, self._creased, U, q))

    def add_moments(self, S: np.ndarray, U: np.ndarray, scale: float) -> None:
        """Add ``scale sum_j w_ij (u_i - u_j) d_ij^T`` to ``S`` (n, 3, 3)."""
        _add_moments(self._start, self._neighbour, self._w, self._d, self._creased, U, scale, S)

    def add_right_hand_side(self, b: np.ndarray, q: np.ndarray, scale: float) -> None:
        """Add ``scale / 2 sum_j w_ij (R_i d_ij - R_j d_ji)`` to ``b`` (n, 3)."""
        _add_pull(
            self._start, self._neighbour, self._back, self._w, self._d, self._creased, 0.5 * scale, q, b
        )


@parallel(fastmath={"contract"})
def _energy(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    v: np.ndarray,
    d: np.ndarray,
    creased: np.ndarray,
    U: np.ndarray,
    q: np.ndarray,
) -> float:
    count = (len(q) + _PORTION - 1) // _PORTION
    energies = np.zeros(count)
    for portion in prange(count):
        for i in range(portion * _PORTION, min(len(q), (portion + 1) * _PORTION)):
            if not creased[i]:
                continue
            own = 0.0
            for e in range(start[i], start[i + 1]):
                j = neighbour[e]
                x, y, z = rotated_vector(q, i, d[e, 0], d[e, 1], d[e, 2])
                a, b, c = U[i, 0] - U[j, 0], U[i, 1] - U[j, 1], U[i, 2] - U[j, 2]
                rest = d[e, 0] * (d[e, 0] + 2.0 * v[e, 0])
                rest += d[e, 1] * (d[e, 1] + 2.0 * v[e, 1]) + d[e, 2] * (d[e, 2] + 2.0 * v[e, 2])
                own += w[e] * (rest - 2.0 * (a * x + b * y + c * z))
            energies[portion] += own
    return total(energies)


@parallel(fastmath={"contract"})
def _add_moments(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    d: np.ndarray,
    creased: np.ndarray,
    U: np.ndarray,
    scale: float,
    S: np.ndarray,
) -> None:
    for i in prange(len(S)):
        if not creased[i]:
            continue
        for e in range(start[i], start[i + 1]):
            j, weight = neighbour[e], scale * w[e]
            for a in range(3):
                u = weight * (U[i, a] - U[j, a])
                for b in range(3):
                    S[i, a, b] += u * d[e, b]


@parallel(fastmath={"contract"})
def _add_pull(
    start: np.ndarray,
    neighbour: np.ndarray,
    back: np.ndarray,
    w: np.ndarray,
    d: np.ndarray,
    creased: np.ndarray,
    half: float,
    q: np.ndarray,
    out: np.ndarray,
) -> None:
    for i in prange(len(q)):
        for e in range(start[i], start[i + 1]):
            j, f, weight = neighbour[e], back[e], half * w[e]
            if creased[i]:
                x, y, z = rotated_vector(q, i, d[e, 0], d[e, 1], d[e, 2])
                out[i, 0] += weight * x
                out[i, 1] += weight * y
                out[i, 2] += weight * z
            if creased[j]:
                x, y, z = rotated_vector(q, j, d[f, 0], d[f, 1], d[f, 2])
                out[i, 0] -= weight * x
                out[i, 1] -= weight * y
                out[i, 2] -= weight * z
