"""Plastic bending: a surface bent beyond its yield curvature keeps a crease.

The change of curvature of a ring, B_i, the vector of all ``(D_t - mean_i D) - R_i (P_t - mean_i P)`` in the
norm of :class:`Bending`, is elastic up to a length r_i that belongs to the yield curvature k:
``r_i^2 = A m_i k^2``, A the total area and m_i that of the vertex. What goes beyond it flows [Simo and Hughes
1998, Computational Inelasticity: return mapping of perfect plasticity]. The least sum of the energy and of
what the flow takes is

    |B_i|^2   up to r_i,        2 r_i |B_i| - r_i^2   above,

smooth, and linear where it flows: the moment stays, and neither the width of a fold nor the mesh changes what
it takes. While flow and rotations are held the energy is quadratic, with the matrix of :class:`Bending`.

A cell resists bending, too, the less the finer the mesh. Where a crease is kept its edges follow, with their
lengths; d_ij is what that adds to ``v_i - v_j`` in the cell of vertex i:

    sum_ij w_ij |(u_i - u_j) - R_i (v_i - v_j + d_ij)|^2  -  the same without d
        = sum_ij w_ij d_ij . (d_ij + 2 (v_i - v_j) - 2 R_i^T (u_i - u_j))
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.energy.bending import corner_sums, gradients
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.parallel_ops import inner_product
from apd_viewer.geometry.linalg.rotations import rotated_vector
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions

_NONE = np.empty((0, 3, 3, 3), np.float32)


class PlasticBending:
    """Bending with a yield curvature, in place of :class:`Bending`.

    Parameters
    ----------
    rest : SolveMesh
    yield_curvature : float
        Change of curvature above which bending stays, 1 / mesh unit: the root of the sum of the squares of
        both principal ones.
    rigidity : float
        Weight of the cells of Eq. 1, in that of bending.

    Attributes
    ----------
    committed_flow : (m, 3, 3, 3) or (0, 3, 3, 3) float array
        For every corner, what flow has added to ``P_t - mean_i P``; empty before
        the first :meth:`commit_flow`.
    dissipated_energy : float
        Energy that flow has taken.
    """

    def __init__(self, rest: SolveMesh, yield_curvature: float, rigidity: float) -> None:
        self._rest, self._rigidity = rest, rigidity
        self.bending, self.K = rest.bending, rest.bending.K
        self._bound = yield_curvature * self.bending.per_curvature
        self.clear_flow()
        self._U, self._D = rest.V, gradients(rest.V, self.bending.patch.F, self.bending.hat_gradients)

    def clear_flow(self) -> None:
        """Remove all creases."""
        self.committed_flow, self.dissipated_energy = _NONE, 0.0
        self._cells: CreasedCells | None = None
        self._creased = np.zeros(len(self._bound), bool)
        self._elastic = np.ones(len(self._bound))
        self._forget()

    def _forget(self) -> None:
        self._q, self._means, self._sizes = (np.empty(0) for _ in range(3))

    def energy(self, U: np.ndarray, q: np.ndarray) -> float:
        """Stored and dissipated energy at ``U`` (n, 3) with rotations ``q`` (n, 4)."""
        sizes = self._changes(U, q)
        stored = np.minimum(sizes, self._bound)
        E = inner_product(stored, 2.0 * sizes - stored) + self.dissipated_energy
        return E + self._rigidity * self._cells.energy(U, q) if self._cells else E

    def moments(self, U: np.ndarray, scale: float) -> np.ndarray:
        """Bending part (n, 3, 3) of the local step's covariances at ``U`` (n, 3)."""
        b = self.bending
        ring = b.patch.start, b.patch.corner, b.weight, b.mean
        S = moments(*ring, self._creased, self.committed_flow, self._gradients(U), scale * self._elastic)
        if self._cells:
            self._cells.add_moments(S, U, scale * self._rigidity)
        return S

    def update_flow(self, U: np.ndarray, q: np.ndarray) -> None:
        """Update the plastic flow of all rings at ``U`` (n, 3), rotations ``q`` (n, 4)."""
        sizes = self._changes(U, q)
        self._elastic = np.divide(self._bound, sizes, out=np.ones(len(sizes)), where=sizes > self._bound)

    def right_hand_side(self, q: np.ndarray, scale: float) -> np.ndarray:
        """Right-hand side (n, 3) for rotations ``q`` (n, 4) and the latest flow."""
        b = self.bending
        rest = b.patch.F, b.weight, b.mean, self._creased, self.committed_flow
        stresses = tensions(*rest, self._elastic, self._D, self._means, 0.5 * scale, q)
        pull = corner_sums(b.patch.start, b.patch.corner, b.hat_gradients, stresses)
        if self._cells:
            self._cells.add_right_hand_side(pull, q, scale * self._rigidity)
        return pull

    def commit_flow(self, U: np.ndarray, q: np.ndarray) -> None:
        """Make the flow at ``U`` (n, 3) with the rotations ``q`` (n, 4) permanent."""
        b, E = self.bending, self.energy(U, q)
        self.update_flow(U, q)
        flowing = 1.0 - self._elastic
        if not flowing.any():
            return
        if not len(self.committed_flow):
            self.committed_flow = np.zeros((len(b.patch.F), 3, 3, 3), np.float32)
        ring = b.patch.start, b.patch.corner, b.mean, b.normals
        self._creased |= flowing > 0.0
        add_flow(*ring, self._D, self._means, q, flowing, self._creased, self.committed_flow)
        self._cells = CreasedCells(self._rest, self._creased, self.committed_flow)
        self._forget()
        self.update_flow(U, q)
        self.dissipated_energy += E - self.energy(U, q)

    def _gradients(self, U: np.ndarray) -> np.ndarray:
        """Deformation gradients ``D_t`` (m, 3, 3) at ``U`` (n, 3)."""
        if U is not self._U:
            self._U, self._D = U, gradients(U, self.bending.patch.F, self.bending.hat_gradients)
            self._forget()
        return self._D

    def _changes(self, U: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Curvature changes ``|B_i|`` (n,) of the rings at ``U`` (n, 3), rotations ``q``."""
        b, D = self.bending, self._gradients(U)
        if not np.array_equal(q, self._q):
            self._q, self._means, self._sizes = q.copy(), np.empty((len(q), 3, 3)), np.empty(len(q))
            ring = b.patch.start, b.patch.corner, b.weight, b.inverse, b.mean, b.normals
            write_ring_changes(*ring, self._creased, self.committed_flow, D, q, self._means, self._sizes)
        return self._sizes


@parallel(fastmath={"contract"})
def write_ring_changes(
    start: np.ndarray,
    corner: np.ndarray,
    weight: np.ndarray,
    inverse: np.ndarray,
    mean: np.ndarray,
    normals: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    D: np.ndarray,
    q: np.ndarray,
    means: np.ndarray,
    sizes: np.ndarray,
) -> None:
    """Write each ring's mean of ``D_t`` (n, 3, 3) and curvature change ``|B_i|`` (n,)."""
    for i in prange(len(mean)):
        d = np.zeros((3, 3))
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            share = inverse[i] * weight[t, c]
            for a in range(3):
                for b in range(3):
                    d[a, b] += share * D[t, a, b]
        means[i] = d
        # Reference for D_t + R_i n_t n_t^T: one rotated vector a corner instead of the three columns'.
        for b in range(3):
            x, y, z = rotated_vector(q, i, mean[i, 0, b], mean[i, 1, b], mean[i, 2, b])
            d[0, b] += x
            d[1, b] += y
            d[2, b] += z
        own = 0.0
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            u, v, w = rotated_vector(q, i, normals[t, 0], normals[t, 1], normals[t, 2])
            change = 0.0
            for b in range(3):
                n = normals[t, b]
                x, y, z = n * u - d[0, b], n * v - d[1, b], n * w - d[2, b]
                if creased[i]:
                    k = rotated_vector(q, i, kept[t, c, 0, b], kept[t, c, 1, b], kept[t, c, 2, b])
                    x, y, z = x - k[0], y - k[1], z - k[2]
                change += (D[t, 0, b] + x) ** 2 + (D[t, 1, b] + y) ** 2 + (D[t, 2, b] + z) ** 2
            own += weight[t, c] * change
        sizes[i] = np.sqrt(own)


@njit(inline="always")
def _rest_column(
    mean: np.ndarray,
    normals: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    i: int,
    t: int,
    c: int,
    b: int,
) -> tuple[float, float, float]:
    """Column ``b`` of the rest value ``mean_i(n n^T) - n_t n_t^T``, creases included."""
    n = normals[t, b]
    x, y, z = mean[i, 0, b], mean[i, 1, b], mean[i, 2, b]
    x, y, z = x - n * normals[t, 0], y - n * normals[t, 1], z - n * normals[t, 2]
    if creased[i]:
        x, y, z = x + kept[t, c, 0, b], y + kept[t, c, 1, b], z + kept[t, c, 2, b]
    return x, y, z


@parallel(fastmath={"contract"})
def moments(
    start: np.ndarray,
    corner: np.ndarray,
    weight: np.ndarray,
    mean: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    D: np.ndarray,
    scale: np.ndarray,
) -> np.ndarray:
    """Bending moments ``scale_i sum_t w_it D_t (mean_i + kept_it)^T``, (n, 3, 3)."""
    out = np.empty_like(mean)
    for i in prange(len(out)):
        s, own = np.zeros((3, 3)), np.zeros((3, 3))
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            for a in range(3):
                for b in range(3):
                    s[a, b] += weight[t, c] * D[t, a, b]
                    if creased[i]:
                        x, y, z = kept[t, c, b, 0], kept[t, c, b, 1], kept[t, c, b, 2]
                        own[a, b] += weight[t, c] * (D[t, a, 0] * x + D[t, a, 1] * y + D[t, a, 2] * z)
        for a in range(3):
            x, y, z = s[a, 0], s[a, 1], s[a, 2]
            for b in range(3):
                of_mean = x * mean[i, 0, b] + y * mean[i, 1, b] + z * mean[i, 2, b]
                out[i, a, b] = scale[i] * (of_mean + own[a, b])
    return out


@parallel(fastmath={"contract"})
def tensions(
    F: np.ndarray,
    weight: np.ndarray,
    mean: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    elastic: np.ndarray,
    D: np.ndarray,
    means: np.ndarray,
    scale: float,
    q: np.ndarray,
) -> np.ndarray:
    """Tensions of the triangles: ``scale sum_i w_it`` times the target of ring i.

    The target is elastic_i R_i (mean_i + kept_it), and flow keeps the rest where it is.
    """
    out = np.zeros((len(F), 3, 3))
    for t in prange(len(F)):
        for c in range(3):
            i, w = F[t, c], scale * weight[t, c]
            drawn, flows = w * elastic[i], w * (1.0 - elastic[i])
            for b in range(3):
                x, y, z = mean[i, 0, b], mean[i, 1, b], mean[i, 2, b]
                if creased[i]:
                    x, y, z = x + kept[t, c, 0, b], y + kept[t, c, 1, b], z + kept[t, c, 2, b]
                x, y, z = rotated_vector(q, i, x, y, z)
                out[t, 0, b] += drawn * x
                out[t, 1, b] += drawn * y
                out[t, 2, b] += drawn * z
                if flows > 0.0:
                    for a in range(3):
                        out[t, a, b] += flows * (D[t, a, b] - means[i, a, b])
    return out


@parallel(fastmath={"contract"})
def add_flow(
    start: np.ndarray,
    corner: np.ndarray,
    mean: np.ndarray,
    normals: np.ndarray,
    D: np.ndarray,
    means: np.ndarray,
    q: np.ndarray,
    flowing: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
) -> None:
    """Add the new plastic flow of every corner to the committed one ``kept``, at rest."""
    back = q * np.array([1.0, -1.0, -1.0, -1.0])
    for i in prange(len(mean)):
        if flowing[i] > 0.0:
            for e in range(start[i], start[i + 1]):
                t, c = corner[e] // 3, corner[e] % 3
                for b in range(3):
                    x, y, z = _rest_column(mean, normals, creased, kept, i, t, c, b)
                    d, m = D[t], means[i]
                    dx, dy, dz = rotated_vector(
                        back, i, d[0, b] - m[0, b], d[1, b] - m[1, b], d[2, b] - m[2, b]
                    )
                    kept[t, c, 0, b] += flowing[i] * (dx - x)
                    kept[t, c, 1, b] += flowing[i] * (dy - y)
                    kept[t, c, 2, b] += flowing[i] * (dz - z)


_TINY = np.finfo(float).tiny
# Vertices per parallel task.
_PORTION = 256


class CreasedCells:
    """Correction of the ARAP energy (Eq. 1) for cells with creases.

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
        proper = (np.roll(rest.F, 1, axis=1) != rest.F).all(axis=1)  # others have no edge with themselves
        n, F, flow = len(rest.V), rest.F[proper], committed_flow[proper]
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
                np.add.at(bent, at, np.einsum("tab,tb->ta", flow[:, c], along))
                np.add.at(count, at, 1.0)
        new = edges + bent / np.maximum(count, 1.0)[:, None]
        longer = np.linalg.norm(new, axis=1) / np.maximum(np.linalg.norm(edges, axis=1), _TINY)
        self._d = edges - new / np.maximum(longer, _TINY)[:, None]
        self._v = -edges

    def energy(self, U: np.ndarray, q: np.ndarray) -> float:
        """Correction of the energy at ``U`` (n, 3) with the rotations ``q`` (n, 4)."""
        return float(_energy(self._start, self._neighbour, self._w, self._v, self._d, self._creased, U, q))

    def add_moments(self, S: np.ndarray, U: np.ndarray, scale: float) -> None:
        """Add the creases' part of the local step's covariances to ``S`` (n, 3, 3)."""
        _add_moments(self._start, self._neighbour, self._w, self._d, self._creased, U, scale, S)

    def add_right_hand_side(self, b: np.ndarray, q: np.ndarray, scale: float) -> None:
        """Add the forces ``scale / 2 sum_j w_ij (R_i d_ij - R_j d_ji)`` to ``b`` (n, 3)."""
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
    return sum_of_portions(energies)


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
