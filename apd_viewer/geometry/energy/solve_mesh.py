"""Rest quantities of the solve: weights, Laplacian, pieces, areas, curvature."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.energy import arap_cells
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.quaternions import turned
from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.components import pieces
from apd_viewer.geometry.mesh.decimation import Thinning, edge_length, neighbourhoods, thinned
from apd_viewer.geometry.mesh.laplacian import cotangent_laplacian, edge_weights, laplacian
from apd_viewer.geometry.mesh.measures import Patch
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.mesh.operators import border_vertices, vertex_areas

# A thinner mesh has so many times fewer vertices, no more than can be solved with in a blink, and no fewer
# than it takes to tell where the full one goes.
_RATIO = 2.5
_MOST = 40_000
FEWEST = 500
# A vertex with almost no area around it, among slivers, would outweigh the bending of all others.
_SMALLEST_AREA = 1e-2


class SolveMesh:
    """Rest mesh of the solve.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
    thinnings : sequence of Thinning
        Its own, and those of the thinner meshes, as far as they are known already.

    Attributes
    ----------
    piece : (n,) int array
        The connected piece of every vertex.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, thinnings: Sequence[Thinning] = ()) -> None:
        self.V = np.ascontiguousarray(V)
        self.F = F
        self._thinnings = thinnings
        self.piece = pieces(F, len(V))

    @cached_property
    def W(self) -> sp.csr_array:
        """Weights of the edges, (n, n)."""
        return edge_weights(self.V, self.F)

    @cached_property
    def L(self) -> sp.csr_array:
        """Their Laplacian (positive semi-definite, ``L_ij = -w_ij``), (n, n)."""
        return laplacian(self.W)

    @cached_property
    def vertex_areas(self) -> np.ndarray:
        """One third of the area of the triangles around every vertex, (n,) float array."""
        return vertex_areas(self.V, self.F)

    @cached_property
    def masses(self) -> np.ndarray:
        """Vertex areas divided by their mean, (n,) float array."""
        areas = self.vertex_areas
        return areas / areas[areas > 0].mean()

    @cached_property
    def bending(self) -> Bending:
        """Bending energy of the rest shape."""
        return Bending(self)

    @cached_property
    def whole(self) -> Patch:
        """All triangles."""
        return Patch(self.F, len(self.V))

    @cached_property
    def LV(self) -> np.ndarray:
        """The Laplacian of the rest positions, (n, 3) float array."""
        return self.L @ self.V

    @cached_property
    def thinning(self) -> Thinning:
        """Decimated mesh, with the map from each vertex to it."""
        if self._thinnings:
            return self._thinnings[0]
        count = int(np.clip(len(self.V) / _RATIO, FEWEST, _MOST))
        vertices, F = thinned(self.V, self.F, count)
        edge = edge_length(self.V[vertices], F)
        normals = vertex_normals(self.V, self.F)
        return Thinning(vertices, F, *neighbourhoods(self.V, normals, self.piece, vertices, edge), edge)

    @cached_property
    def thinner(self) -> SolveMesh:
        """The mesh of :attr:`thinning`."""
        return SolveMesh(self.V[self.thinning.vertices], self.thinning.F, self._thinnings[1:])

    @cached_property
    def graph(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``start, neighbour, weight`` of the edges, for the kernels."""
        # Unsigned, so that numba need not check every index for wraparound.
        return self.W.indptr.astype(np.uint32), self.W.indices.astype(np.uint32), self.W.data

    def energy(self, U: np.ndarray) -> float:
        """ARAP energy (Eq. 1) at ``U`` (n, 3) with the optimal rotations."""
        q = self.identity()
        arap_cells.local_step(*self.graph, self.V, U, arap_cells.FLAT, q)
        return float(arap_cells.energy(*self.graph, self.V, U, q))

    def identity(self) -> np.ndarray:
        """Rotations of the rest pose, (n, 4) unit quaternions."""
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(self.V), 1))


class Bending:
    """The curvature of the rest mesh, and the energy of a change of it.

        E = A sum_i |(C u)_i - R_i (C v)_i|^2 / m_i

    with C the cotangent Laplacian, so that ``C v`` are the mean curvature vectors, m the vertex areas and
    A the total area [Wardetzky et al. 2007, Discrete quadratic curvature energies; Bouaziz et al. 2014,
    Projective Dynamics]. The sum tends to an integral of squared curvature, which no refinement and no
    unit of length changes; A makes it a squared length, as Eq. 1 is.

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

    def __init__(self, rest: SolveMesh) -> None:
        self.C = cotangent_laplacian(rest.V, rest.F)
        self.CV = self.C @ rest.V
        m = rest.vertex_areas
        used = m > 0
        self.weight = np.where(used, m.sum() / np.maximum(m, _SMALLEST_AREA * m[used].mean()), 0.0)
        self.weight[border_vertices(rest.F, len(rest.V))] = 0.0
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
