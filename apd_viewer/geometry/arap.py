"""As-rigid-as-possible deformation [Sorkine & Alexa 2007, As-Rigid-As-Possible Surface Modeling].

    E(U) = sum_i sum_{j in N(i)} w_ij |(u_i - u_j) - R_i (v_i - v_j)|^2                  (Eq. 1)

Every undirected edge counts twice, once in the cell of either end.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numba import njit

from apd_viewer.geometry.linear_solver import LinearSolver
from apd_viewer.geometry.mesh import pieces
from apd_viewer.geometry.operators import edge_weights, laplacian, vertex_areas
from apd_viewer.geometry.rotations import fit_rotation


@njit(cache=True, nogil=True)
def _local_step(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    q: np.ndarray,
    R: np.ndarray,
) -> None:
    S, K, E = np.empty((3, 3)), np.empty((4, 4)), np.empty((4, 4))
    for i in range(V.shape[0]):
        S[:] = 0.0
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            for b in range(3):
                rest = w[e] * (V[i, b] - V[j, b])
                S[0, b] += (U[i, 0] - U[j, 0]) * rest
                S[1, b] += (U[i, 1] - U[j, 1]) * rest
                S[2, b] += (U[i, 2] - U[j, 2]) * rest
        fit_rotation(S, q[i], R[i], K, E)


@njit(cache=True, nogil=True)
def _right_hand_side(
    start: np.ndarray, neighbour: np.ndarray, w: np.ndarray, V: np.ndarray, R: np.ndarray, b: np.ndarray
) -> None:
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
def _energy(
    start: np.ndarray, neighbour: np.ndarray, w: np.ndarray, V: np.ndarray, U: np.ndarray, R: np.ndarray
) -> float:
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


class RestShape:
    """What depends on the rest mesh alone: weights, Laplacian, pieces, vertex areas.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles

    Attributes
    ----------
    W, L : (n, n) csr_array
        Edge weights, and their Laplacian (positive semi-definite, ``L_ij = -w_ij``).
    piece : (n,) int array
        The connected piece of every vertex.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        self.V = np.ascontiguousarray(V)
        self.F = F
        self.W = edge_weights(self.V, F)
        self.L = laplacian(self.W)
        self.piece = pieces(F, len(V))

    @cached_property
    def masses(self) -> np.ndarray:
        """Vertex areas divided by their mean, (n,) float array."""
        areas = vertex_areas(self.V, self.F)
        return areas / areas[areas > 0].mean()

    @property
    def graph(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``start, neighbour, weight`` of the edges, for the kernels."""
        return self.W.indptr, self.W.indices, self.W.data

    def local_step(self, U: np.ndarray, q: np.ndarray, R: np.ndarray) -> None:
        """Set ``q`` (n, 4) and ``R`` (n, 3, 3) to the optimal rotations of ``U`` (n, 3), warm-started."""
        _local_step(*self.graph, self.V, U, q, R)

    def energy(self, U: np.ndarray) -> float:
        """Eq. 1 at ``U`` (n, 3) with the rotations that are optimal for it."""
        q, R = self.identity()
        self.local_step(U, q, R)
        return _energy(*self.graph, self.V, U, R)

    def identity(self) -> tuple[np.ndarray, np.ndarray]:
        """Rotations of the rest pose: quaternions (n, 4) and matrices (n, 3, 3)."""
        n = len(self.V)
        return np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)), np.tile(np.eye(3), (n, 1, 1))


class Arap:
    """Local/global ARAP iterations with some vertices held, factored once.

    Parameters
    ----------
    rest : RestShape
    fixed : (k,) int array
        Held vertices, each once.

    Attributes
    ----------
    U : (n, 3) float array
        Current positions. Replaced by every global step, never written into.
    free : (f,) int array
        Vertices that are solved for. A piece without any held vertex is not: nothing says where
        it belongs, so it stays where it is.
    L_ff : (f, f) csr_array
        The Laplacian's rows and columns of the free vertices.
    """

    def __init__(self, rest: RestShape, fixed: np.ndarray) -> None:
        self.rest = rest
        self.fixed = fixed
        moves = np.isin(rest.piece, rest.piece[fixed])
        moves[fixed] = False
        self.free = np.flatnonzero(moves)
        rows = rest.L[self.free]
        self.L_ff = rows[:, self.free].tocsr()
        self._L_fc = rows[:, fixed].tocsr()
        self._solver = LinearSolver(self.L_ff)
        self._b = np.empty_like(rest.V)
        self.restart(rest.V)

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.U = U
        self.q, self.R = self.rest.identity()
        if U is not self.rest.V:
            self.rest.local_step(U, self.q, self.R)

    def right_hand_side(self, targets: np.ndarray) -> np.ndarray:
        """Right-hand side of the global step, ``b_f(R) - L_fc targets``, (f, 3) float array.

        ``b_i = sum_j w_ij / 2 (R_i + R_j)(v_i - v_j)``.
        """
        _right_hand_side(*self.rest.graph, self.rest.V, self.R, self._b)
        return self._b[self.free] - self._L_fc @ targets

    def iterate(self, targets: np.ndarray) -> None:
        """Global step with the held vertices at ``targets`` (k, 3), then the local step."""
        U = self.U.copy()
        U[self.fixed] = targets
        U[self.free] = self._solver.solve(self.right_hand_side(targets))
        self.U = U
        self.rest.local_step(U, self.q, self.R)
