"""Plastic bending of a thin wall beyond its yield curvature.

A triangle's change of curvature, in the norm ``k^2 = (1 - nu) |H|^2 + nu (tr H)^2`` of its bending energy, is
elastic up to the yield curvature y. What goes beyond it flows, in its own direction [Simo & Hughes 1998,
Computational Inelasticity: return mapping]. The least sum of the energy and of what the flow takes is

    D/2 A k^2   up to y,        D A (y k - y^2 / 2 + h (k - y)^2 / 2)   above,

h the hardening: the stiffness where it flows over the elastic one, 0 for perfect plasticity. Flow by p raises
y by ``h / (1 - h) p``, in all directions. Without hardening a fold at a single hinge, which turns by an angle
whatever its triangles are, takes ``D y`` per length and angle on every mesh.
"""

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.energy.hinges import Hinges
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.mesh.operators import face_areas


class PlasticHinges(Hinges):
    """Hinges of a wall with a yield curvature.

    Parameters
    ----------
    V, F, rigidity, poisson, clamps
        See :class:`Hinges`.
    yield_curvature : float or (m,) float array
        Change of curvature above which bending stays, 1 / mesh unit, of each triangle or of all.
    hardening : float
        0 to less than 1.

    Attributes
    ----------
    committed_flow : (3 m,) float array
        Slopes across the triangles' edges that remain without moments.
    dissipated_energy : float
        Energy that committed flow has taken.
    """

    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        rigidity: float | np.ndarray,
        poisson: float,
        clamps: np.ndarray | None = None,
        yield_curvature: float | np.ndarray = np.inf,
        hardening: float = 0.0,
    ) -> None:
        super().__init__(V, F, rigidity, poisson, clamps)
        self._new, self._rigid = np.broadcast_to(yield_curvature, len(F)), rigidity * face_areas(V, F)
        self._hardening = hardening
        self._to_hinges, self._is_coupled = self.slopes.T.tocsr(), self.Q != 0.0
        self.clear_flow()

    def clear_flow(self) -> None:
        """Remove all creases."""
        self.committed_flow, self.dissipated_energy = np.zeros(self.slopes.shape[0]), 0.0
        self._yield = self._new

    def _bending(self, angles: np.ndarray) -> tuple[float, np.ndarray]:
        """Stored and dissipated energy, and its derivatives (h,) by ``angles`` (h,)."""
        forces, sizes = self._stresses(self._elastic_slopes(angles))
        stored = np.minimum(sizes, self._yield)
        beyond = sizes - stored
        energy = parallel_ops.inner_product(self._rigid * stored, sizes - 0.5 * stored)
        energy += 0.5 * self._hardening * parallel_ops.inner_product(self._rigid * beyond, beyond)
        forces *= np.repeat(self._elastic_fractions(sizes), 3)
        return energy + self.dissipated_energy, self._to_hinges @ forces

    def _secant(self, angles: np.ndarray) -> sp.csr_array:
        """Secant matrix (h, h), with nonzeros of Q, for steps from ``angles`` (h,)."""
        sizes = self._stresses(self._elastic_slopes(angles))[1]
        if (sizes <= self._yield).all():
            return self.Q
        fractions = sp.diags_array(np.repeat(self._elastic_fractions(sizes), 3))
        return (
            (self._to_hinges @ (fractions @ self.stiffness) @ self.slopes).multiply(self._is_coupled).tocsr()
        )

    def commit_flow(self, angles: np.ndarray) -> None:
        """Make the flow at the ``angles`` (h,) permanent."""
        slopes = self._elastic_slopes(angles)
        sizes = self._stresses(slopes)[1]
        beyond, h = np.maximum(sizes - self._yield, 0.0), self._hardening
        self.committed_flow = (
            self.committed_flow + np.repeat(1.0 - self._elastic_fractions(sizes), 3) * slopes
        )
        moments = (self._yield + 0.5 * h * beyond) * self._rigid
        self.dissipated_energy += parallel_ops.inner_product(moments, (1.0 - h) * beyond)
        self._yield = self._yield + h * beyond

    def _elastic_slopes(self, angles: np.ndarray) -> np.ndarray:
        return self.slopes @ self.turned(angles) - self.committed_flow

    def _stresses(self, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energy derivatives (3 m,) by ``slopes`` (3 m,), and curvature changes (m,)."""
        forces = self.stiffness @ slopes
        double = (slopes * forces).reshape(-1, 3).sum(axis=1)
        return forces, np.sqrt(np.maximum(double, 0.0) / np.maximum(self._rigid, np.finfo(float).tiny))

    def _elastic_fractions(self, sizes: np.ndarray) -> np.ndarray:
        """Fractions (m,) of changes of curvature (m,) that are elastic."""
        elastic = self._yield + self._hardening * np.maximum(sizes - self._yield, 0.0)
        return np.divide(elastic, sizes, out=np.ones(len(sizes)), where=sizes > self._yield)
