"""Hinges of a triangle mesh and their bending energy.

    E = 1/2 (theta - theta_0)^T Q (theta - theta_0),        theta the dihedral angles, theta_0 those at rest

Q is constant. A triangle bends by ``H = 1/A sum_e |e| phi_e n_e n_e^T`` over its edges, as the element of
[Morley 1968, The triangular equilibrium element in the solution of plate bending problems] has it, and has
the energy ``D/2 A ((1 - nu) |H|^2 + nu (tr H)^2)``. Here ``phi_e`` is the slope across the middle of edge e
less that of the triangle's plane. Morley's element makes it an unknown; here it follows from the angles of
five hinges, that of the edge and the other four of its two triangles, by the weights nearest to half of the
edge's own that are exact for every quadratic function of the unfolded rest shape. The other triangle has the
rest of the angle, so that slopes agree across edges, and every quadratic passes the patch test on every
triangulation. Along a free edge the slope is the one of least energy. A triangle whose corners are all held
clamps: it does not bend, so that the whole angle of its edges is that of their other triangles.

A hinge cannot pass its other side: over the last 27 degrees it has the barrier ``-(1 - s)^2 ln s`` in units
of its own stiffness, s the fraction of those degrees that is left.

The angle of a hinge has the gradient ``-m/h`` at a corner with the height h above the edge, m the unit normal
[Tamstorf & Grinspun 2013, Discrete bending forces and their Jacobians].
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.operators import cotangents, face_areas, is_well_shaped

# Weight of an edge's own hinge relative to each of the other four, and the largest weight accepted.
_OWN, _LARGEST = 9.0, 3.0
# Least number of hinges to determine a quadratic, and relative regularization of the three equations.
_FEWEST, _REGULAR = 4, 1e-6
# Angle from which a hinge is nearly shut, and the least fraction of the rest that the barrier knows.
_NEARLY_SHUT, _LEAST_OPEN = 0.85 * np.pi, 1e-6
# Entries of Q below this fraction of the bending rigidity are rounding errors.
_ROUNDING = 1e-12


class Hinges:
    """Hinges of a mesh and their bending energy.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
        Triangles. Needles do not bend.
    rigidity : float or (m,) float array
        Bending rigidity D, energy, of each triangle or of all.
    poisson : float
    clamps : (m,) bool array, optional
        Triangles that do not bend, since their corners are held.

    Attributes
    ----------
    corners : (h, 4) int array
        The edge of each hinge, then the opposite corners of its two triangles, the one on the left first.
    Q : (h, h) csr_array
    slopes : (3 m, h) csr_array
        From the angles of the hinges to the slopes across the triangles' edges.
    stiffness : (3 m, 3 m) csr_array
        Second derivatives of the triangles' energies in the slopes.
    others : (o, 2) int array
        Edges with more than two triangles, which have no hinge.
    edges : (e, 2) int array
        Those of the hinges, then those of the rims, one for every triangle that has one.
    edge_of : (m, 3) int array
        The edge from each corner of a triangle to the next.
    arc_angles : (e, h) csr_array
        From the angles of the hinges to curvature times length of the edges, by weights exact for every
        quadratic.
    """

    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        rigidity: float | np.ndarray,
        poisson: float,
        clamps: np.ndarray | None = None,
    ) -> None:
        self._n = len(V)
        clamps = np.zeros(len(F), dtype=bool) if clamps is None else clamps
        topology = _HingeTopology(F, len(V))
        self.corners, self.others = topology.corners, topology.others
        near = _stencils(V, topology, clamps)
        self.slopes = slopes = _slope_matrix(F, topology, clamps, near)
        self.edges, self.edge_of = topology.edges, topology.edge_of
        self.arc_angles = _arc_angles(V, F, topology, clamps, near, slopes)
        self.stiffness = _triangle_stiffness(
            V, F, topology.hinge < 0, np.where(clamps, 0.0, rigidity), poisson
        )
        Q = (slopes.T @ self.stiffness @ slopes).tocsr()
        Q.sum_duplicates()
        Q.data[np.abs(Q.data) < _ROUNDING * np.min(rigidity)] = 0.0
        Q.eliminate_zeros()
        Q.sort_indices()
        self.Q = Q
        # Maps gradients with respect to the corners of the hinges to the vertices.
        at = np.arange(4 * len(self.corners))
        self._to_vertices = sp.csr_array(
            (np.ones(len(at)), (self.corners.ravel(), at)), shape=(self._n, len(at))
        )
        self.rest = angles_and_gradients(V, self.corners)[0]
        self._rests_shut, self._diagonal = np.abs(self.rest) > _NEARLY_SHUT, Q.diagonal()

    @cached_property
    def at_vertices(self) -> tuple[np.ndarray, np.ndarray]:
        """Starts (n + 1,) and entries of the hinges and the edges at each vertex.

        An entry is 4 times the hinge plus its corner; edges are counted on after the hinges.
        """
        ends = 4 * (len(self.corners) + np.arange(len(self.edges))[:, None]) + [0, 1]
        vertices = np.concatenate([self.corners.ravel(), self.edges.ravel()])
        order = np.argsort(vertices, kind="stable")
        entries = np.concatenate([np.arange(self.corners.size), ends.ravel()])[order]
        return np.searchsorted(vertices[order], np.arange(self._n + 1)), entries

    def moments(self, angles: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy, and its derivatives (h,) with respect to the ``angles`` (h,)."""
        energy, moments = self._bending(angles)
        hinges, value, slope, _ = self._closing(angles)
        if len(hinges):
            energy += float(value.sum())
            moments[hinges] += slope
        return energy, moments

    def stiffness_at(self, angles: np.ndarray) -> sp.csr_array:
        """Matrix (h, h) for steps from the ``angles`` (h,), with the nonzeros of Q."""
        hinges, _, _, curvature = self._closing(angles)
        if not len(hinges):
            return self._secant(angles)
        more = np.zeros(len(angles))
        more[hinges] = curvature
        return (self._secant(angles) + sp.diags_array(more)).tocsr()

    def _bending(self, angles: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy and moments (h,) of bending alone."""
        turned = self.turned(angles)
        moments = self.Q @ turned
        return 0.5 * parallel_ops.inner_product(turned, moments), moments

    def _secant(self, _: np.ndarray) -> sp.csr_array:
        """Matrix (h, h) of bending alone, for steps from the angles (h,)."""
        return self.Q

    def _closing(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Hinges (k,) that are nearly shut, and their barrier: value and two derivatives."""
        size = np.abs(angles)
        hinges = np.flatnonzero((size > _NEARLY_SHUT) & ~self._rests_shut)
        width, firm = np.pi - _NEARLY_SHUT, self._diagonal[hinges]
        t, sign = np.maximum((np.pi - size[hinges]) / width, _LEAST_OPEN), np.sign(angles[hinges])
        log, left = np.log(t), 1.0 - t
        slope = firm * (left * left / t - 2.0 * left * log) * sign / width
        curvature = firm * (-2.0 * log + 4.0 * left / t + (left / t) ** 2) / width**2
        return hinges, -firm * left * left * log, slope, curvature

    def turned(self, angles: np.ndarray) -> np.ndarray:
        """Rotations (h,) from rest to the ``angles`` (h,).

        A hinge that rests shut may open on either side: its rotation is at most half a turn.
        """
        turned = angles - self.rest
        turns = np.round(turned[self._rests_shut] / (2.0 * np.pi))
        turned[self._rests_shut] -= 2.0 * np.pi * turns
        return turned

    def nearest_to_rest(self, angles: np.ndarray) -> np.ndarray:
        """The ``angles`` (h,) plus full turns, nearest to those at rest."""
        return self.rest + self.turned(angles)

    def triangle_energies(self, angles: np.ndarray) -> np.ndarray:
        """Energies (m,) of the triangles, with the total energy as their sum."""
        slopes = self.slopes @ self.turned(angles)
        return 0.5 * (slopes * (self.stiffness @ slopes)).reshape(-1, 3).sum(axis=1)

    def gradient(self, moments: np.ndarray, J: np.ndarray) -> np.ndarray:
        """Gradient (n, 3) of the energy, for gradients ``J`` (h, 4, 3) of the angles."""
        return parallel_ops.matrix_product(self._to_vertices, (moments[:, None, None] * J).reshape(-1, 3))


class _HingeTopology:
    """Hinges of triangles.

    Attributes
    ----------
    corners, others
        See :class:`Hinges`.
    hinge : (m, 3) int array
        The hinge on the edge from each corner to the next; -1 for none.
    sign : (m, 3) float array
        -1 where the triangle sees the angle from the other side, since it is wound against the first one.
    first, second : (h,) int arrays
        Half edges, ``3 t + k``, of the two triangles.
    edges, edge_of
        See :class:`Hinges`.
    """

    def __init__(self, F: np.ndarray, n: int) -> None:
        start, end = F.ravel().astype(np.int64), np.roll(F, -1, axis=1).ravel().astype(np.int64)
        key = np.minimum(start, end) * n + np.maximum(start, end)
        # A triangle with a corner twice lies beside its edges, and turns about none of them.
        flat = np.flatnonzero(np.repeat((np.roll(F, -1, axis=1) == F).any(axis=1), 3))
        key[flat] = n * n + flat
        order = np.argsort(key, kind="stable")
        edges, at, count = np.unique(key[order], return_index=True, return_counts=True)
        pairs = at[count == 2]
        self.first, self.second = order[pairs], order[pairs + 1]
        many = edges[count > 2]
        self.others = np.column_stack([many // n, many % n])
        opposite = np.roll(F, -2, axis=1).ravel()
        left, right = opposite[self.first], opposite[self.second]
        self.corners = np.column_stack([start[self.first], end[self.first], left, right])
        hinge, sign = np.full(F.size, -1), np.ones(F.size)
        hinge[self.first] = hinge[self.second] = np.arange(len(pairs))
        sign[self.second] = np.where(start[self.second] == end[self.first], 1.0, -1.0)
        self.hinge, self.sign = hinge.reshape(-1, 3), sign.reshape(-1, 3)
        alone = np.flatnonzero(hinge < 0)
        self.edges = np.concatenate([self.corners[:, :2], np.column_stack([start[alone], end[alone]])])
        edge_of = hinge.copy()
        edge_of[alone] = len(pairs) + np.arange(len(alone))
        self.edge_of = edge_of.reshape(-1, 3)


# Values of the three quadratic functions x^2 / 2, y^2 / 2 and x y.


def _quadratics(P: np.ndarray) -> np.ndarray:
    x, y = P[..., 0], P[..., 1]
    return np.stack([0.5 * x * x, 0.5 * y * y, x * y], axis=-1)


def _gradients(P: np.ndarray, Q: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Gradients (k, 3, 2) of interpolated quadratics on triangles of corners (k, 2)."""
    e, f = Q - P, R - P
    det = (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])[:, None]
    p, q = _quadratics(Q) - _quadratics(P), _quadratics(R) - _quadratics(P)
    return np.stack(
        [
            (p * f[:, 1, None] - q * e[:, 1, None]) / det,
            (q * e[:, 0, None] - p * f[:, 0, None]) / det,
        ],
        axis=-1,
    )


def _hinge_angles(
    P: np.ndarray, Q: np.ndarray, left: np.ndarray, right: np.ndarray, clamped: np.ndarray | None = None
) -> np.ndarray:
    """Angles (k, 3) of the quadratics over the edges from ``P`` to ``Q`` (k, 2).

    Where the edge is ``clamped`` (k,), the right triangle has the slope in its middle.
    """
    t = Q - P
    outwards = np.stack([t[:, 1], -t[:, 0]], axis=-1) / np.linalg.norm(t, axis=1, keepdims=True)
    beyond = _gradients(Q, P, right)
    if clamped is not None:
        x, y = (0.5 * (P + Q)).T
        slope = np.stack([x, 0.0 * x, 0.0 * x, y, y, x], axis=-1).reshape(-1, 3, 2)
        beyond = np.where(clamped[:, None, None], slope, beyond)
    return np.einsum("kfi,ki->kf", beyond - _gradients(P, Q, left), outwards)


def _third_corner(P: np.ndarray, Q: np.ndarray, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Corner (k, 2) left of ``P`` to ``Q``, at distances ``p``, ``q`` (k,) from them."""
    t = Q - P
    length = np.linalg.norm(t, axis=1)
    x = (p * p - q * q + length * length) / (2.0 * length)
    y = np.sqrt(np.maximum(p * p - x * x, np.finfo(float).tiny))
    t = t / length[:, None]
    return P + x[:, None] * t + y[:, None] * np.stack([-t[:, 1], t[:, 0]], axis=-1)


class _Stencils(NamedTuple):
    """Each hinge with the other four of its two triangles.

    Attributes
    ----------
    hinges : (h, 5) int array
        The hinge itself first; -1 for none.
    angles : (h, 5, 3) float array
        Their angles for three quadratics, on the rest shape unfolded and scaled to an edge of 1 along x.
    signs : (h, 5) float array
        -1 where the first triangle sees the angle from the other side.
    slopes : (h, 3) float array
        Slopes of the first triangle across the edge.
    sides : (h,) float array
        1 if both triangles have the same orientation, otherwise -1.
    """

    hinges: np.ndarray
    angles: np.ndarray
    signs: np.ndarray
    slopes: np.ndarray
    sides: np.ndarray


def _stencils(V: np.ndarray, topology: _HingeTopology, clamps: np.ndarray) -> _Stencils:
    first, second, corners = topology.first, topology.second, topology.corners
    a, b, c, d = corners.T
    count, edge = len(corners), np.linalg.norm(V[corners[:, 1]] - V[corners[:, 0]], axis=1)
    edge = np.maximum(edge, np.finfo(float).tiny)

    def apart(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        return np.linalg.norm(V[i] - V[j], axis=1) / edge

    A, B = np.tile([-0.5, 0.0], (count, 1)), np.tile([0.5, 0.0], (count, 1))
    C = _third_corner(A, B, apart(a, c), apart(b, c))
    D = _third_corner(B, A, apart(b, d), apart(a, d))
    hinges = np.full((count, 5), -1)
    angles, signs = np.zeros((count, 5, 3)), np.ones((count, 5))
    hinges[:, 0], angles[:, 0] = np.arange(count), _hinge_angles(A, B, C, D)
    side = topology.sign.ravel()[second]
    # Half-edges of each triangle following the hinge's own, seen from the first triangle's side.
    around = [(first, 1, b, c, B, C, A), (first, 2, c, a, C, A, B)]
    around += [(second, 1, a, d, A, D, B), (second, 2, d, b, D, B, A)]
    for slot, (half, step, p, q, P, Q, R) in enumerate(around, start=1):
        t, k = half // 3, half % 3
        seen = side if half is second else 1.0
        # A triangle of opposite orientation meets its edges in reverse order.
        k = np.where(seen > 0.0, k + step, k + 3 - step) % 3
        other = topology.hinge[t, k]
        hinges[:, slot] = other
        signs[:, slot] = topology.sign[t, k] * seen
        is_first = first[other] == 3 * t + k
        x = np.where(is_first, corners[other, 3], corners[other, 2])
        X = _third_corner(Q, P, apart(q, x), apart(p, x))
        clamped = clamps[np.where(is_first, second[other], first[other]) // 3]
        with np.errstate(divide="ignore", invalid="ignore"):  # needles, and edges without a hinge
            angles[:, slot] = np.where(other[:, None] >= 0, _hinge_angles(P, Q, R, X, clamped), 0.0)
    return _Stencils(hinges, angles, signs, _gradients(A, B, C)[..., 1], side)


def _slope_matrix(
    F: np.ndarray, topology: _HingeTopology, clamps: np.ndarray, near: _Stencils
) -> sp.csr_array:
    """Matrix (3 m, h) from the hinge angles to the slopes across the triangles' edges."""
    first, second = topology.first, topology.second
    weights = _exact_weights(near, near.slopes, 0.5)
    at_clamps = clamps[first // 3] | clamps[second // 3]
    weights[at_clamps] = 0.0
    weights[at_clamps, 0] = ~clamps[first // 3][at_clamps]
    rest = -weights
    rest[:, 0] += 1.0
    known = near.hinges >= 0
    rows = np.concatenate([np.repeat(first[:, None], 5, 1)[known], np.repeat(second[:, None], 5, 1)[known]])
    entries = np.concatenate([weights[known], (near.sides[:, None] * rest)[known]])
    columns = np.tile(near.hinges[known], 2)
    return sp.coo_array((entries, (rows, columns)), shape=(F.size, len(first))).tocsr()


def _arc_angles(
    V: np.ndarray,
    F: np.ndarray,
    topology: _HingeTopology,
    clamps: np.ndarray,
    near: _Stencils,
    slopes: sp.csr_array,
) -> sp.csr_array:
    """Matrix (e, h) from the hinge angles to the angles of arcs over the edges.

    Along an edge without a hinge the curvature is that of its triangle, ``t^T H t``.
    """
    count, first, second = len(topology.corners), topology.first, topology.second
    weights = _exact_weights(near, np.array([1.0, 0.0, 0.0]), 0.0)
    weights[clamps[first // 3] | clamps[second // 3]] = 0.0
    rows, slots = np.nonzero(near.hinges >= 0)
    at = rows, near.hinges[rows, slots]
    of_hinges = sp.coo_array((weights[rows, slots], at), shape=(count, count)).tocsr()
    t, k = np.nonzero(topology.hinge < 0)
    others = (k[:, None] + [1, 2]) % 3
    lengths = np.linalg.norm(V[np.roll(F, -1, axis=1)] - V[F], axis=2)
    sizes = np.maximum(lengths[t, k, None] * lengths[t[:, None], others], np.finfo(float).tiny)
    told = (topology.hinge[t] >= 0).sum(axis=1) == 2
    sines = np.where(told, 4.0 * face_areas(V, F)[t], 0.0)[:, None] / sizes
    at = np.repeat(np.arange(len(t)), 2), (3 * t[:, None] + others).ravel()
    of_rims = sp.coo_array((sines.ravel(), at), shape=(len(t), F.size)).tocsr() @ slopes
    arcs = sp.vstack([of_hinges, of_rims], format="csr")
    arcs.data[np.abs(arcs.data) < _ROUNDING] = 0.0
    arcs.eliminate_zeros()
    return arcs


def _exact_weights(near: _Stencils, wanted: np.ndarray, own: float) -> np.ndarray:
    """Weights (h, 5) of the angles of five hinges, exact for all quadratics.

    Those nearest to ``own`` of the edge's own; that itself where the others tell too little.

    Parameters
    ----------
    near : _Stencils
    wanted : (h, 3) or (3,) float array
        What to find of three quadratics.
    own : float
    """
    angles, known = near.angles, near.hinges >= 0
    plain = np.zeros(known.shape)
    plain[:, 0] = own
    trust = known * np.array([_OWN, 1.0, 1.0, 1.0, 1.0])
    with np.errstate(invalid="ignore", over="ignore"):
        B = np.einsum("ks,ksi,ksj->kij", trust, angles, angles)
        scale = np.trace(B, axis1=1, axis2=2)
        sound = np.isfinite(scale) & (scale > 0.0) & (known.sum(axis=1) >= _FEWEST)
        B[~sound], scale = np.eye(3), np.where(sound, scale, 1.0)
        B += _REGULAR * scale[:, None, None] * np.eye(3)
        missing = np.where(sound[:, None], wanted - own * angles[:, 0], 0.0)
        forces = np.linalg.solve(B, missing[:, :, None])[:, :, 0]
        weights = plain + trust * np.einsum("ksi,ki->ks", np.where(sound[:, None, None], angles, 0.0), forces)
    return np.where((np.abs(weights).max(axis=1) <= _LARGEST)[:, None], weights, plain) * near.signs


def _triangle_stiffness(
    V: np.ndarray, F: np.ndarray, free: np.ndarray, rigidity: np.ndarray, poisson: float
) -> sp.csr_array:
    """Second derivatives (3 m, 3 m) of the triangle energies in the slopes.

    Parameters
    ----------
    V, F, poisson
        See :class:`Hinges`.
    rigidity : (m,) float array
    free : (m, 3) bool array
        Edges without a hinge, whose slope is that of least energy.
    """
    X, areas = V[F], face_areas(V, F)
    sound = is_well_shaped(cotangents(V, F))
    edges = X[:, [1, 2, 0]] - X
    dots = np.einsum("tai,tbi->tab", edges, edges)
    lengths = np.sqrt(np.einsum("taa->ta", dots))
    sizes = lengths[:, :, None] * lengths[:, None, :]
    tiny = np.finfo(float).tiny
    cosines = dots / np.maximum(sizes, tiny)
    part = rigidity * np.where(sound, 1.0 / np.maximum(areas, tiny), 0.0)
    K = part[:, None, None] * ((1.0 - poisson) * cosines * cosines + poisson) * sizes
    for k in range(3):
        own = K[:, k, k]
        gives = free[:, k] & (own > 0.0)
        share = np.where(gives, 1.0 / np.where(own > 0.0, own, 1.0), 0.0)
        K = K - share[:, None, None] * K[:, :, k, None] * K[:, None, k, :]
        K[free[:, k], k, :] = 0.0
        K[free[:, k], :, k] = 0.0
    at = np.arange(F.size).reshape(-1, 3)
    rows, columns = np.repeat(at, 3, axis=1), np.tile(at, 3)
    return sp.coo_array((K.ravel(), (rows.ravel(), columns.ravel())), shape=(F.size, F.size)).tocsr()


@parallel(error_model="numpy")
def angles_and_gradients(U: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles (h,) of hinges at ``U`` (n, 3), and their gradients (h, 4, 3).

    Positive where the surface is a valley on the side of its normals.
    """
    angles, J = np.empty(len(corners)), np.empty((len(corners), 4, 3))
    for e in prange(len(corners)):
        a, b, c, d = corners[e, 0], corners[e, 1], corners[e, 2], corners[e, 3]
        p0, p1, p2 = U[b, 0] - U[a, 0], U[b, 1] - U[a, 1], U[b, 2] - U[a, 2]
        q0, q1, q2 = U[c, 0] - U[a, 0], U[c, 1] - U[a, 1], U[c, 2] - U[a, 2]
        r0, r1, r2 = U[d, 0] - U[a, 0], U[d, 1] - U[a, 1], U[d, 2] - U[a, 2]
        x0, x1, x2 = p1 * q2 - p2 * q1, p2 * q0 - p0 * q2, p0 * q1 - p1 * q0
        y0, y1, y2 = r1 * p2 - r2 * p1, r2 * p0 - r0 * p2, r0 * p1 - r1 * p0
        square = max(p0 * p0 + p1 * p1 + p2 * p2, 1e-300)
        length = np.sqrt(square)
        x, y = max(x0 * x0 + x1 * x1 + x2 * x2, 1e-300), max(y0 * y0 + y1 * y1 + y2 * y2, 1e-300)
        across = (x1 * y2 - x2 * y1) * p0 + (x2 * y0 - x0 * y2) * p1 + (x0 * y1 - x1 * y0) * p2
        angles[e] = np.arctan2(across / length, x0 * y0 + x1 * y1 + x2 * y2)
        s = (p0 * q0 + p1 * q1 + p2 * q2) / square
        t = (p0 * r0 + p1 * r1 + p2 * r2) / square
        g, h = length / x, length / y
        for i, left, right in ((0, g * x0, h * y0), (1, g * x1, h * y1), (2, g * x2, h * y2)):
            J[e, 0, i] = (1.0 - s) * left + (1.0 - t) * right
            J[e, 1, i] = s * left + t * right
            J[e, 2, i], J[e, 3, i] = -left, -right
    return angles, J
