"""Rest mesh of the solve: edge weights, Laplacian, components, areas, bending.

E(U) = 2 A sum_t max(0, 1 - a_t(U) / (0.3 A_t))^2,        a_t the area, A_t that at rest, A the total

Bending turns neighbouring triangles alike, and where sharp folds meet, single ones give way: a triangle
without area has no direction. Above three tenths of its area nothing acts. A triangle costs about as much as
a sharp fold at one of its vertices, so the penalty is a part of bending. It is continuously differentiable,
for a descent with a line search; its curvature, though bounded, grows as triangles get smaller, and no
matrix knows of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.energy import arap_cells
from apd_viewer.geometry.energy.bending import Bending
from apd_viewer.geometry.linalg.parallel_ops import inner_product
from apd_viewer.geometry.mesh.decimation import (
    Decimation,
    coarse_neighbours,
    decimated_mesh,
    mean_edge_length,
)
from apd_viewer.geometry.mesh.edges_and_components import vertex_components
from apd_viewer.geometry.mesh.operators import edge_weights, face_areas, laplacian, vertex_areas
from apd_viewer.geometry.mesh.prolongation import Prolongation
from apd_viewer.geometry.mesh.weighted_areas import SLIVER, Patch

# Vertex ratio of consecutive levels; largest coarse mesh solved without noticeable delay, and smallest one
# useful to predict the fine shape.
_RATIO = 2.5
MOST_COARSE_VERTICES = 40_000
FEWEST_COARSE_VERTICES = 500


class SolveMesh:
    """Rest mesh of the solve, with derived quantities.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
    decimations : sequence of Decimation
        Its own, and those of the thinner meshes, as far as they are known already.

    Attributes
    ----------
    component : (n,) int array
        The connected piece of every vertex.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, decimations: Sequence[Decimation] = ()) -> None:
        self.V = np.ascontiguousarray(V)
        self.F = F
        self._thinnings = decimations
        self._alike: SolveMesh | None = None
        self.component = vertex_components(F, len(V))

    @cached_property
    def W(self) -> sp.csr_array:
        """Matrix of edge weights, (n, n)."""
        return edge_weights(self.V, self.all_triangles)

    @cached_property
    def L(self) -> sp.csr_array:
        """Laplacian of :attr:`W` (positive semi-definite, ``L_ij = -w_ij``), (n, n)."""
        return laplacian(self.W)

    @cached_property
    def vertex_areas(self) -> np.ndarray:
        """One third of the area of the triangles around every vertex, (n,) float array."""
        return vertex_areas(self.V, self.F)

    def is_connected_to(self, fixed: np.ndarray) -> np.ndarray:
        """Mask (n,) of vertices connected to ``fixed`` ones (k,); all True without any."""
        if not len(fixed):
            return np.asarray(self.vertex_areas > 0.0)
        has_fixed = np.zeros(len(self.V), dtype=bool)
        has_fixed[self.component[fixed]] = True
        return has_fixed[self.component]

    @cached_property
    def masses(self) -> np.ndarray:
        """Vertex areas divided by their mean, (n,) float array."""
        areas = self.vertex_areas
        return areas / areas[areas > 0].mean()

    @cached_property
    def bending(self) -> Bending:
        """Bending energy of the rest shape."""
        return Bending(self.V, self.all_triangles)

    @cached_property
    def all_triangles(self) -> Patch:
        """Patch of all triangles."""
        return Patch(self.F, len(self.V))

    @cached_property
    def LV(self) -> np.ndarray:
        """The Laplacian of the rest positions, (n, 3) float array."""
        return self.L @ self.V

    @cached_property
    def decimation(self) -> Decimation:
        """Decimated mesh, with the map from each vertex to it."""
        if self._alike is not None:
            return self._alike.decimation
        if self._thinnings:
            return self._thinnings[0]
        count = int(np.clip(len(self.V) / _RATIO, FEWEST_COARSE_VERTICES, MOST_COARSE_VERTICES))
        vertices, F = decimated_mesh(self.V, self.F, count)
        edge = mean_edge_length(self.V[vertices], F)
        near, weight = coarse_neighbours(self.V, self.F, self.component, vertices, edge)
        return Decimation(vertices, F, near, weight, edge)

    @cached_property
    def area_penalty(self) -> AreaPenalty:
        """Penalty on collapsing triangles of a stiff wall."""
        return AreaPenalty(self.V, self.all_triangles.F)

    @cached_property
    def coarse_mesh(self) -> SolveMesh:
        """Coarse mesh of :attr:`decimation`."""
        V = self.V[self.decimation.vertices]
        if self._alike is not None:
            return self._alike.coarse_mesh.with_positions(V)
        return SolveMesh(V, self.decimation.F, self._thinnings[1:])

    @cached_property
    def prolongation(self) -> Prolongation:
        """Smooth interpolation from the coarse mesh, for previews."""
        coarse = self.decimation
        return Prolongation(self.V, coarse.vertices, coarse.F, coarse.nearest)

    def with_positions(self, V: np.ndarray) -> SolveMesh:
        """The mesh with its vertices at nearby positions (n, 3), decimated as this one is."""
        mesh = SolveMesh(V, self.F)
        mesh._alike = self
        return mesh

    @property
    def interpolation(self) -> sp.csr_array:
        """Interpolation (n, c) from the coarse vertices, by :attr:`decimation`."""
        near, weight = self.decimation.coarse_neighbours, self.decimation.weight
        ends = np.arange(0, near.size + 1, near.shape[1], dtype=near.dtype)
        shape = len(self.V), len(self.decimation.vertices)
        return sp.csr_array((weight.ravel(), near.ravel(), ends), shape=shape)

    @cached_property
    def coarse_laplacian(self) -> sp.csr_array:
        """Laplacian restricted to the coarse mesh, (c, c).

        ``P^T L P`` with P the :attr:`interpolation`.
        """
        P = self.interpolation
        return (P.T @ (self.L @ P)).tocsr()

    @cached_property
    def graph(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``start, neighbour, weight`` of the edges, for the kernels."""
        # Unsigned, so that numba need not check every index for wraparound.
        return self.W.indptr.view(np.uint32), self.W.indices.view(np.uint32), self.W.data

    def energy(self, U: np.ndarray) -> float:
        """ARAP energy (Eq. 1) at ``U`` (n, 3) with the optimal rotations."""
        q = self.identity_rotations()
        arap_cells.local_step(*self.graph, self.V, U, arap_cells.NO_MOMENTS, q, np.empty(0))
        return float(arap_cells.energy(*self.graph, self.V, U, q))

    def identity_rotations(self) -> np.ndarray:
        """Rotations of the rest shape, (n, 4) unit quaternions."""
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(self.V), 1))


# Weight of the penalty, and area fraction below which it acts. Half of the weight left single triangles below
# a fifth of their area. Acting from a half, it hindered squeezed shapes and led to folds of higher energy.
_WEIGHT, _FROM = 2.0, 0.3
# Fraction of the rest area below which the normal is unreliable, so that the force fades.
_FLAT = 1e-3


class AreaPenalty:
    """Penalty on collapsing triangles, and its gradient.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
        Slivers do not count.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        self._F, areas = F, face_areas(V, F)
        self._rest = np.where(areas > SLIVER * areas.mean(), areas, 0.0)
        self._least, self._weight = _FROM * self._rest, _WEIGHT * areas.sum()

    def energy(self, U: np.ndarray) -> float:
        """Penalty at ``U`` (n, 3), in square mesh units."""
        missing = self._collapsing_triangles(U)[1]
        return float(self._weight * inner_product(missing, missing))

    def gradient(self, U: np.ndarray) -> np.ndarray:
        """Gradient of the penalty at ``U`` (n, 3), (n, 3)."""
        (t, missing), out = self._collapsing_triangles(U), np.zeros_like(U)
        if len(t):
            F = self._F[t]
            X = U[F]
            normal = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
            double = np.linalg.norm(normal, axis=1)
            normal *= (
                -self._weight * missing / self._least[t] / np.maximum(double, 2.0 * _FLAT * self._rest[t])
            )[:, None]
            np.add.at(out, F, np.cross(normal[:, None, :], X[:, [2, 0, 1]] - X[:, [1, 2, 0]]))
        return out

    def _collapsing_triangles(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices of the collapsing triangles, and degrees of collapse, 0 to 1."""
        areas = face_areas(U, self._F)
        t = np.flatnonzero(areas < self._least)
        return t, 1.0 - areas[t] / self._least[t]
