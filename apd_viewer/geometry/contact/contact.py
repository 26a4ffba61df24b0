"""Contact of a surface with itself and obstacles: energy, steps and springs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from apd_viewer.geometry.analysis.self_intersections import crossing_pairs
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.contact.near_pairs import NearPairs, NoPairs
from apd_viewer.geometry.contact.obstacle_pairs import ObstaclePairs
from apd_viewer.geometry.linalg.kernels import njit

# Stiffness in mean diagonal entries of the Laplacian; settled gaps are 0.75 to 0.8 of the range.
_STIFFNESS = 1.0
# Largest spring constant of the metric, in mean diagonal entries of the Laplacian.
_FIRMEST = 15.0
# Largest spring constant between surface and obstacles; lower, as it also resists sliding.
_FIRMEST_OF_OBSTACLES = 1.0
# Fraction of its collision-free step that a vertex moves; largest difference between neighbours.
_TAKEN = 0.9
_RISE = 0.25
_SWEEPS = 8
# Blocked substeps are shortened only if longer than this fraction of the whole step.
_SHORTEST = 1e-3


class DirectedSprings(NamedTuple):
    """Springs that resist changes of gaps, but not sliding.

    Attributes
    ----------
    ids : (p, 4) int array
        Vertices of each pair; n + k for a point of obstacle k.
    constants : (p,) float array
        A quarter of the energy's second derivative by the gap.
    weights : (p, 4) float array
        Coefficients of the vertices' positions in the vector of the gap.
    directions : (p, 3) float array
        Unit vectors along the gaps.
    """

    ids: np.ndarray
    constants: np.ndarray
    weights: np.ndarray
    directions: np.ndarray


class Contact:
    """Contact of a surface with itself and with obstacles.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
        Triangles that can touch; none for a surface that passes through itself.
    held : (n,) int array
        The handle that holds a vertex, counted from 2, 1 for the base, 0 for none; higher numbers are of what
        else moves as one. Nothing of one number touches what else has it.
    stiffness : float
        Mean of the diagonal of the Laplacian.
    thickness : float
        Distance that walls keep, mesh units.
    followers : Followers, optional
        Vertices carried along by the surface, and in contact too.
    obstacles : sequence of Obstacle

    Attributes
    ----------
    exempt_vertices : (k,) int array
        Vertices near triangles that cross at rest, and of what touches there: nothing keeps those of one
        place apart.
    followers : Followers
    obstacles : list of ObstaclePairs
    start : (n, 3) float array
        Shape at the start of the next step.
    touching_pairs : int
        Number of touching pairs at the last :meth:`quarter_gradient`.
    least_gap : float
        Least gap of these pairs; infinite without any.
    examined_parts : int
        Substeps examined by the last :meth:`move_to`, and on the way back.
    is_blocked_by_obstacle : bool
        Whether an obstacle has blocked the last :meth:`move_to`.
    """

    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        held: np.ndarray,
        stiffness: float,
        thickness: float,
        followers: Followers | None = None,
        obstacles: Sequence[Obstacle] = (),
    ) -> None:
        self._F = F
        self._zone = contact_exemption_zones(F, crossing_pairs(V, F) if len(F) else None, len(V))
        self.followers = followers or NoFollowers(len(V))
        self._stiffness = _STIFFNESS * stiffness
        self._most = _FIRMEST / _STIFFNESS
        together = np.vstack([held, self._zone, self.followers.exempt_groups])
        self._pairs = NearPairs(V, F, together, thickness) if len(F) else NoPairs(len(V))
        self._V, self.thickness = V, thickness
        self.replace_obstacles(obstacles)
        self.exempt_vertices = np.union1d(np.flatnonzero(self._zone), self._pairs.touching_at_rest)
        self.touching_pairs, self.least_gap, self.examined_parts = 0, np.inf, 0
        self.is_blocked_by_obstacle = self._is_obstacle_ahead = False
        for pairs in self.obstacles:
            pairs.rebuild_at(V)
        self._set_out(V)

    def replace_obstacles(self, obstacles: Sequence[Obstacle]) -> None:
        """Replace the obstacles; call :meth:`start_at` afterwards."""
        V, E = self._V, self._pairs.edges
        self.obstacles = [ObstaclePairs(V, self._F, E, obstacle, self.thickness) for obstacle in obstacles]

    def can_start_at(self, U: np.ndarray, shifts: np.ndarray | None = None) -> bool:
        """True if ``U`` (n, 3) meets no obstacle, and itself only as the rest shape does.

        Parameters
        ----------
        U : (n, 3) float array
        shifts : (o, 3) float array, optional
            Displacements of the obstacles; the current ones by default.
        """
        return self.is_clear(U, self.shifts if shifts is None else shifts) and self._crosses_as_at_rest(U)

    def is_clear(self, U: np.ndarray, shifts: np.ndarray) -> bool:
        """True if ``U`` (n, 3) intersects no obstacle displaced by ``shifts`` (o, 3)."""
        placed = self.followers.with_followers(U)
        at_each = zip(self.obstacles, shifts, strict=True)
        return all(pairs.clearance(placed, shift) > 0.0 for pairs, shift in at_each)

    def _crosses_as_at_rest(self, U: np.ndarray) -> bool:
        """True if ``U`` (n, 3) intersects itself only where the rest shape does."""
        pairs = crossing_pairs(self.followers.with_followers(U), self._F) if len(self._F) else None
        if pairs is None:
            return True
        corners = self._F[pairs]
        may_cross = is_within_zone(self._zone[corners])
        for group in self.followers.exempt_groups:
            may_cross |= is_within_zone(np.abs(group)[corners]) & (group[corners] > 0).any(axis=(1, 2))
        may_cross |= np.all(np.isin(corners, self._pairs.touching_at_rest).any(axis=2), axis=1)
        return bool(may_cross.all())

    def start_at(self, U: np.ndarray, shifts: np.ndarray | None = None) -> None:
        """Start from ``U`` (n, 3) and shifts accepted by :meth:`can_start_at`."""
        placed = self.followers.with_followers(U)
        self._pairs.rebuild_at(placed)
        for pairs, shift in zip(self.obstacles, self.shifts if shifts is None else shifts, strict=True):
            pairs.rebuild_at(placed, shift)
        self._set_out(U)

    @property
    def shifts(self) -> np.ndarray:
        """Displacement of each obstacle from its initial position, (o, 3)."""
        return np.array([pairs.shift for pairs in self.obstacles]).reshape(-1, 3)

    @property
    def _all(self) -> list[NearPairs | NoPairs | ObstaclePairs]:
        return [self._pairs, *self.obstacles]

    @property
    def _energy_found(self) -> float:
        return sum(pairs.energy_ahead for pairs in self._all)

    def _set_out(self, U: np.ndarray) -> None:
        self.start, self._ahead, self._is_ahead = U, U, False
        self._placed = self._placed_ahead = self.followers.with_followers(U)
        self._energy = self._energy_ahead = self._energy_found

    def accept_shape(self, U: np.ndarray) -> None:
        """Accept ``U``, either end of the last collision-free step, as the current shape."""
        if self._is_ahead and U is self._ahead:
            for pairs in self._all:
                pairs.accept_step()
            self.start, self._placed, self._energy = U, self._placed_ahead, self._energy_ahead
            self._is_ahead = False

    def trial_fractions(self, W: np.ndarray) -> np.ndarray | None:
        """Fractions (n,) of the step to ``W`` (n, 3) to try; None if collision-free."""
        fractions = self._look_ahead(W)
        if fractions is None:
            return None
        fractions = np.where(fractions < 1.0, _TAKEN * fractions, 1.0)
        self.followers.limit_step_fractions(fractions)
        _limit_jumps(self._pairs.edges, fractions, _RISE, _SWEEPS)
        return fractions

    def _look_ahead(self, W: np.ndarray) -> np.ndarray | None:
        """Collision-free fractions (n,) of the step to ``W`` (n, 3); None if all of it."""
        self._ahead, self._placed_ahead, self._energy_ahead = self.start, self._placed, self._energy
        self._is_ahead = False
        placed = self.followers.with_followers(W)
        found = [pairs.find_collision_free_fractions(self._placed, placed) for pairs in self._all]
        blocked = [fractions for fractions in found if fractions is not None]
        self._is_obstacle_ahead = any(fractions is not None for fractions in found[1:])
        if blocked:
            return np.min(blocked, axis=0)
        self._ahead, self._placed_ahead, self._energy_ahead = W, placed, self._energy_found
        self._is_ahead = True  # obstacles may have moved even if W equals the start
        return None

    def move_to(self, W: np.ndarray, shifts: np.ndarray | None = None) -> bool:
        """Move straight to ``W`` (n, 3); return False, without moving, if blocked.

        Parameters
        ----------
        W : (n, 3) float array
        shifts : (o, 3) float array, optional
            Displacements of the obstacles at the end; without, they stay.
        """
        start, before, self.examined_parts = self.start, self.shifts, 0
        if self._move_in_substeps(W, before if shifts is None else shifts):
            self.is_blocked_by_obstacle = False
            return True
        self.is_blocked_by_obstacle = self._is_obstacle_ahead
        if not self._move_in_substeps(start, before):
            self.start_at(start, before)
        return False

    def _move_in_substeps(self, W: np.ndarray, shifts: np.ndarray) -> bool:
        """Move straight to ``W`` in substeps; return False once one is blocked."""
        start, before, done, part = self.start, self.shifts, 0.0, 1.0
        while done < 1.0:
            self.examined_parts += 1
            fraction = min(1.0, done + part)
            end = W if fraction == 1.0 else start + fraction * (W - start)
            self.set_obstacle_targets(shifts if fraction == 1.0 else before + fraction * (shifts - before))
            fractions = self._look_ahead(end)
            if fractions is None:
                self.accept_shape(end)
                done, part = done + part, 2.0 * part
            elif fractions.min() == fractions.max() and part > _SHORTEST:
                part *= float(fractions[0])
            else:
                return False
        return True

    def energy_at(self, U: np.ndarray) -> float:
        """Energy at either end of the last collision-free step, in elastic energy units."""
        return 4.0 * self._stiffness * (self._energy_ahead if U is self._ahead else self._energy)

    def quarter_gradient(self, U: np.ndarray) -> np.ndarray:
        """A quarter of the gradient (n, 3) of the contact energy."""
        placed = self._placed_at(U)
        g, self.touching_pairs, self.least_gap = self._pairs.gradient(placed)
        for pairs in self.obstacles:
            more, touching, least = pairs.gradient(placed)
            g += more
            self.touching_pairs, self.least_gap = self.touching_pairs + touching, min(self.least_gap, least)
        g *= self._stiffness
        self.followers.transfer_gradient(g)
        return g

    def _placed_at(self, U: np.ndarray) -> np.ndarray:
        return self._placed_ahead if U is self._ahead else self.followers.with_followers(U)

    @property
    def loads(self) -> np.ndarray:
        """Forces (o, 3) on the obstacles at the last gradient, energy per length."""
        forces = np.array([pairs.force for pairs in self.obstacles]).reshape(-1, 3)
        return -4.0 * self._stiffness * forces

    @property
    def may_touch(self) -> bool:
        """True if any pairs may be in contact."""
        return any(pairs.may_touch for pairs in self._all)

    def springs(self, U: np.ndarray) -> sp.csr_array:
        """Matrix (n, n + o) of springs between touching parts, the obstacles last."""
        placed, n = self._placed_at(U), len(U)
        found = []
        for k, pairs in enumerate(self._all):
            ids, firm, w = pairs.springs(placed, self._most if k == 0 else _FIRMEST_OF_OBSTACLES)
            entries = (self._stiffness * firm[:, None, None] * w[:, :, None] * w[:, None, :]).ravel()
            ids = np.where(ids < n, ids, n + k - 1)
            found.append((entries, np.repeat(ids, 4, axis=1).ravel(), np.tile(ids, 4).ravel()))
        entries, rows, columns = (np.concatenate(parts) for parts in zip(*found, strict=True))
        size = n + len(self.obstacles)
        return sp.coo_array((entries, (rows, columns)), shape=(size, size)).tocsr()[:n]

    def directed_springs(self, U: np.ndarray) -> DirectedSprings:
        """Springs along the gaps of touching pairs at ``U`` (n, 3), with their stiffness."""
        placed, n = self._placed_at(U), len(U)
        found = []
        for k, pairs in enumerate(self._all):
            ids, firm, w = pairs.springs(placed, np.inf)
            X = placed if k == 0 else np.concatenate([placed, self.obstacles[k - 1].points])
            apart = np.einsum("pi,pia->pa", w, X[ids])
            apart /= np.maximum(np.linalg.norm(apart, axis=1, keepdims=True), np.finfo(float).tiny)
            found.append((np.where(ids < n, ids, n + k - 1), self._stiffness * firm, w, apart))
        return DirectedSprings(*(np.concatenate(parts) for parts in zip(*found, strict=True)))

    def set_obstacle_targets(self, shifts: np.ndarray) -> None:
        """Set the obstacles' displacements (o, 3) at the end of the next step."""
        for pairs, shift in zip(self.obstacles, shifts, strict=True):
            pairs.set_target(shift)

    def positions_pushed_by_obstacles(self, U: np.ndarray, W: np.ndarray) -> np.ndarray:
        """Positions ``W`` (n, 3), with vertices near obstacles at ``U`` pushed along."""
        for pairs in self.obstacles:
            W = pairs.positions_pushed_by_obstacle(U, W)
        return W


@njit(cache=True, nogil=True)
def _limit_jumps(E: np.ndarray, fractions: np.ndarray, largest: float, sweeps: int) -> None:
    """Lower step fractions until those of neighbours differ by at most ``largest``."""
    for _ in range(sweeps):
        changed = False
        for e in range(len(E)):
            a, b = E[e, 0], E[e, 1]
            if fractions[a] > fractions[b] + largest:
                fractions[a] = fractions[b] + largest
                changed = True
            elif fractions[b] > fractions[a] + largest:
                fractions[b] = fractions[a] + largest
                changed = True
        if not changed:
            break


# Rings of triangles exempt from contact around intersecting ones.
_RINGS = 3


def is_near_crossing(F: np.ndarray, crossing: np.ndarray, n: int) -> np.ndarray:
    """Mask (n,) of the vertices within a few rings of intersecting triangles (k,)."""
    near = np.zeros(n, bool)
    near[F[crossing]] = True
    for _ in range(_RINGS):
        near[F[near[F].any(axis=1)]] = True
    return near


def contact_exemption_zones(F: np.ndarray, pairs: np.ndarray | None, n: int) -> np.ndarray:
    """Zone of each vertex within which contact is ignored, from 1; 0 for none.

    Crossing triangles and those connected with them within a few rings are in one zone. Zones of different
    places are kept apart.

    Parameters
    ----------
    F : (m, 3) int array
    pairs : (p, 2) int array or None
        Triangles that cross at rest.
    n : int
        Number of the vertices.

    Returns
    -------
    (n,) int array
    """
    if pairs is None or not len(pairs):
        return np.zeros(n, np.int64)
    near = is_near_crossing(F, pairs.ravel(), n)
    whole = F[near[F].all(axis=1)]
    a = np.concatenate([whole[:, 0], whole[:, 1], F[pairs[:, 0], 0]])
    b = np.concatenate([whole[:, 1], whole[:, 2], F[pairs[:, 1], 0]])
    _, place = connected_components(sp.coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)
    zone = np.zeros(n, np.int64)
    zone[near] = np.unique(place[near], return_inverse=True)[1] + 1
    return zone


def is_within_zone(zone: np.ndarray) -> np.ndarray:
    """Mask (p,) of triangle pairs sharing a zone, from their corners' (p, 2, 3).

    At the rim a triangle of a zone is crossed by those with one corner in it.
    """
    same = zone[:, 0, :, None] == zone[:, 1, None, :]
    return (same & (zone[:, 0, :, None] > 0)).any(axis=(1, 2))


class Followers(Protocol):
    """Vertices carried along by others, without degrees of freedom of their own."""

    @property
    def exempt_groups(self) -> np.ndarray:
        """Vertex groups (z, n) exempt from contact; see :class:`PairSearch`."""

    def with_followers(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with the followers moved along with their carriers."""

    def transfer_gradient(self, g: np.ndarray) -> None:
        """Add the followers' gradient (n, 3) to the gradient of their carriers."""

    def limit_step_fractions(self, fractions: np.ndarray) -> None:
        """Limit the step fractions (n,) of carriers to those of their followers."""


class NoFollowers:
    """Empty set of followers.

    Parameters
    ----------
    n : int
        Number of the vertices.
    """

    def __init__(self, n: int) -> None:
        self.exempt_groups = np.zeros((0, n), np.int64)

    def with_followers(self, U: np.ndarray) -> np.ndarray:
        """Positions ``U`` (n, 3) themselves."""
        return U

    def transfer_gradient(self, g: np.ndarray) -> None:
        """Leave the gradient (n, 3) unchanged."""

    def limit_step_fractions(self, fractions: np.ndarray) -> None:
        """Leave the step fractions (n,) unchanged."""
