"""Bending: the change of the curvature of a rest mesh."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.quaternions import turned
from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.laplacian import cotangent_laplacian
from apd_viewer.geometry.mesh.operators import border_vertices

# A vertex with almost no area around it, among slivers, would outweigh the bending of all others.
_SMALLEST_AREA = 1e-2


class Bending:
    """The curvature of the rest mesh, and the energy of a change of it.

        E = A sum_i |(C u)_i - R_i (C v)_i|^2 / m_i

    with C the cotangent Laplacian, so that ``C v`` are the mean curvature vectors, m the vertex areas and
    A the total area [Wardetzky et al. 2007, Discrete quadratic curvature energies; Bouaziz et al. 2014,
    Projective Dynamics]. The sum tends to an integral of squared curvature, which no refinement and no
    unit of length changes; A makes it a squared length, as Eq. 1 is.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
    m : (n,) float array
        One third of the area of the triangles around every vertex.

    Attributes
    ----------
    C : (n, n) csr_array
        Not clamped: a triangle that is stretched in its plane is not bent.
    CV : (n, 3) float array
        The mean curvature vectors at rest, each times its vertex area.
    weight : (n,) float array
        ``A / m_i``; zero along open borders, where C measures no curvature.
    K : (n, n) csr_array
        A quarter of the energy's Hessian while the rotations are held.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, m: np.ndarray) -> None:
        self.C = cotangent_laplacian(V, F)
        self.CV = self.C @ V
        used = m > 0
        self.weight = np.where(used, m.sum() / np.maximum(m, _SMALLEST_AREA * m[used].mean()), 0.0)
        self.weight[border_vertices(F, len(V))] = 0.0
        self.K = (self.C @ sp.diags_array(0.5 * self.weight) @ self.C).tocsr()

    def apply(self, X: np.ndarray) -> np.ndarray:
        """``C X`` for ``X`` (n, 3)."""
        return parallel_ops.product(self.C, X)

    def pull(self, q: np.ndarray, weight: float) -> np.ndarray:
        """Right-hand side ``weight`` times curvature rotated by ``q`` (n, 4)."""
        return self.apply(_turned(q, self.CV, 0.5 * weight * self.weight))

    def energy(self, U: np.ndarray, q: np.ndarray) -> float:
        """The energy at ``U`` (n, 3) with the rotations ``q`` (n, 4)."""
        change = self.apply(U) - _turned(q, self.CV, np.ones(len(U)))
        return float(self.weight @ (change * change).sum(axis=1))

    def moments(self, U: np.ndarray, weight: float) -> np.ndarray:
        """Bending part of ``S_i`` in the local step at ``U`` (n, 3), (n, 3, 3)."""
        return _moments(self.apply(U), self.CV, weight * self.weight)


@parallel()
def _turned(q: np.ndarray, X: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """``weight_i R_i x_i``, (n, 3)."""
    out = np.empty_like(X)
    for i in prange(len(X)):
        x, y, z = turned(q, i, X[i, 0], X[i, 1], X[i, 2])
        out[i, 0], out[i, 1], out[i, 2] = weight[i] * x, weight[i] * y, weight[i] * z
    return out


@parallel()
def _moments(X: np.ndarray, Y: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """``weight_i x_i y_i^T``, (n, 3, 3)."""
    out = np.empty((len(X), 3, 3))
    for i in prange(len(X)):
        for a in range(3):
            for b in range(3):
                out[i, a, b] = weight[i] * X[i, a] * Y[i, b]
    return out
