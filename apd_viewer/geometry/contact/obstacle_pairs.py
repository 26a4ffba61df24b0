"""Near pairs of a moving surface and a moving obstacle."""

import numpy as np

from apd_viewer.geometry.contact.collision_times import detect_collisions
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.contact.distances import gaps
from apd_viewer.geometry.contact.gap_energy import gap_gradient, gap_springs
from apd_viewer.geometry.linalg.parallel_ops import largest_difference
from apd_viewer.geometry.mesh.arrays import used_vertices

# Distance beyond the range within which pairs are listed, in mean edge lengths.
_LISTED_WITHIN = 6.0
# Smallest gap after a step, as a fraction of the range.
_FLOOR = 5e-3
# Smallest gap after a step, as a fraction of an obstacle's initial gap.
_LEFT = 0.5
# Margin above the range, in ranges, within which exact gaps replace lower bounds.
_MARGIN = 0.5
# Distance ahead of an obstacle within which vertices move along, in lengths of its step.
_CARRIED = 8.0
_CORNER = 3.0**0.5  # largest ratio of a vector's length to its largest coordinate


class ObstaclePairs:
    """Near pairs of a surface and an obstacle, with their gap energy.

    There are none before the surface enters.
    All pairs keep a lower bound of their gaps; those that may be in touch soon are listed.

    Parameters
    ----------
    V : (n, 3) float array
    F, E : (m, 3) and (e, 2) int arrays
    obstacle : Obstacle
    reach : float
        Range of the gap energy, mesh units.

    Attributes
    ----------
    obstacle : Obstacle
    shift, shift_ahead : (3,) float arrays
        Displacement of the obstacle from its initial position, and at the end of its next step.
    points, points_ahead : (p, 3) float arrays
        Its points there.
    energy_ahead : float
        Energy per stiffness at the end of the last collision-free step found.
    force : (3,) float array
        Gradient by the place of the obstacle at the last :meth:`gradient`, per stiffness.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, E: np.ndarray, obstacle: Obstacle, reach: float) -> None:
        self.obstacle, self._reach = obstacle, reach
        self._place(np.zeros(3))
        self._all, self._all_edges = obstacle.pairs(F, E, len(V))
        lengths = np.linalg.norm(V[E[:, 0]] - V[E[:, 1]], axis=1)
        self._beyond = _LISTED_WITHIN * float(lengths.mean())
        self.force, self.energy_ahead = np.zeros(3), 0.0
        self._low = self._low_after = np.zeros(0)
        self._floor = _FLOOR * reach
        self._F, self._listed_at, self._bound = F, self._with(V, self.points), np.zeros(0)
        self._pairs, self._edges = self._all[:0], self._all_edges[:0]

    def clearance(self, U: np.ndarray, shift: np.ndarray) -> float:
        """Distance of ``U`` (n, 3) from the shifted obstacle; negative if they intersect."""
        return clearance(self.obstacle, shift, U, self._F)

    def _place(self, shift: np.ndarray) -> None:
        self.shift = self.shift_ahead = shift
        self.points = self.points_ahead = self.obstacle.points + shift

    def set_target(self, shift: np.ndarray) -> None:
        """Set the obstacle's displacement (3,) at the end of the next step."""
        self.shift_ahead, self.points_ahead = shift, self.obstacle.points + shift

    def rebuild_at(self, U: np.ndarray, shift: np.ndarray | None = None) -> None:
        """Rebuild the list of pairs at ``U`` (n, 3), and at ``shift`` (3,) if given.

        It must be clear of ``U``. What is nearer than steps go may stay as near.
        """
        self._place(self.shift if shift is None else shift)
        self._listed_at = self._with(U, self.points)
        self._bound = np.full(len(self._all), -np.inf)
        self._list_pairs(self._listed_at)
        self._floor = min(_FLOOR * self._reach, _LEFT * float(self._low.min(initial=np.inf)))
        self.find_collision_free_fractions(U, U)
        self.accept_step()

    def find_collision_free_fractions(self, U: np.ndarray, W: np.ndarray) -> np.ndarray | None:
        """Collision-free fractions (n,) of steps from ``U`` to ``W``; None if all are 1."""
        X, Y = self._with(U, self.points), self._with(W, self.points_ahead)
        step = 2.0 * _CORNER * largest_difference(Y, X)
        if step > self._beyond:
            return np.full(len(U), 0.9 * self._beyond / step)
        if 2.0 * _CORNER * largest_difference(X, self._listed_at) + step > self._beyond:
            self._list_pairs(X)
        self._low_after, fraction = np.empty(len(self._low)), np.empty(len(self._low))
        bounds = (
            self._low,
            np.full(len(self._low), self._reach),
            np.full(len(self._low), self._floor),
        )
        owner = np.zeros(len(self._low), np.int32)
        self.energy_ahead, blocked = detect_collisions(
            X, Y, _MARGIN * self._reach, self._pairs, self._edges, *bounds, np.array([step]), owner,
            self._low_after, fraction, self.obstacle.radius,
        )  # fmt: skip
        if not blocked:
            return None
        fractions, short = np.ones(len(X)), fraction < 1.0
        np.minimum.at(fractions, self._pairs[short].ravel(), np.repeat(fraction[short], 4))
        return fractions[: len(U)]

    def accept_step(self) -> None:
        """Accept the last collision-free step found."""
        self._low, self.points, self.shift = self._low_after, self.points_ahead, self.shift_ahead

    @property
    def may_touch(self) -> bool:
        """True if some gap may be within the range of the gap energy."""
        return bool((self._low < self._reach).any())

    def gradient(self, U: np.ndarray) -> tuple[np.ndarray, int, float]:
        """Gradient (n, 3) per stiffness, number of touching pairs, and smallest gap."""
        listed = self._pairs, self._edges, self._low, np.full(len(self._low), self._reach)
        g, touching, least = gap_gradient(self._with(U, self.points_ahead), *listed, self.obstacle.radius)
        self.force = g[len(U) :].sum(axis=0)
        return g[: len(U)], touching, least

    def springs(self, U: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Springs of touching pairs: vertices (p, 4), constants (p,), weights (p, 4)."""
        touching = np.flatnonzero(self._low < self._reach)
        listed = self._pairs[touching], self._edges[touching], np.full(len(touching), self._reach)
        k, w = gap_springs(self._with(U, self.points), *listed, most, self.obstacle.radius)
        return listed[0], k, w

    def positions_pushed_by_obstacle(self, U: np.ndarray, W: np.ndarray) -> np.ndarray:
        """Positions ``W`` (n, 3), pushed ahead of the obstacle in its next motion.

        Vertices near the obstacle at ``U`` move along with it, farther ones less and less.
        """
        move = self.points_ahead[0] - self.points[0]
        if not move.any():
            return W
        apart, outwards = self.obstacle.distances_and_directions(self.points, U)
        fraction = np.clip(1.0 - (apart - self._reach) / (_CARRIED * float(np.linalg.norm(move))), 0.0, 1.0)
        wanted = fraction * np.maximum(outwards @ move, 0.0)
        # At most wanted, so that the motion by another obstacle towards this one is not undone.
        missing = np.clip(wanted - np.einsum("ij,ij->i", W - U, outwards), 0.0, wanted)
        return self._with_near_pairs_pushed(U, W + missing[:, None] * outwards, move)

    def _with_near_pairs_pushed(self, U: np.ndarray, W: np.ndarray, move: np.ndarray) -> np.ndarray:
        """Push edges and triangles near the obstacle ahead of it; ``W`` (n, 3) is moved.

        An obstacle can touch a triangle whose vertices are all far.
        """
        room = _CARRIED * float(np.linalg.norm(move))
        has_several = (self._pairs < len(U)).sum(axis=1) > 1  # a vertex alone has been pushed
        near = np.flatnonzero(has_several & (self._low < self._reach + room))
        ids, X = self._pairs[near], self._with(U, self.points)
        w = gap_springs(X, ids, self._edges[near], np.full(len(near), np.inf), 0.0, self.obstacle.radius)[1]
        on_surface = np.where(ids < len(U), w, 0.0)
        # From the obstacle to the surface, whichever of them the gap is measured from.
        sign = np.where(on_surface.sum(axis=1) < 0.0, -1.0, 1.0)
        outwards = np.einsum("p,pk,pka->pa", sign, w, X[ids])
        apart = np.maximum(np.linalg.norm(outwards, axis=1), np.finfo(float).tiny)
        outwards /= apart[:, None]
        fraction = np.clip(1.0 - (apart - self.obstacle.radius - self._reach) / room, 0.0, 1.0)
        wanted = fraction * np.maximum(outwards @ move, 0.0)
        moved = np.einsum("p,pk,pka->pa", sign, on_surface, self._with(W, self.points)[ids] - X[ids])
        missing = np.clip(wanted - np.einsum("pa,pa->p", moved, outwards), 0.0, wanted)
        # A vertex of several pairs takes the farthest move.
        rows = np.argsort(missing, kind="stable")
        rows = rows[missing[rows] > 0.0]
        pushed = np.zeros_like(X)
        pushed[ids[rows]] = (missing[:, None] * outwards)[rows, None]
        return W + pushed[: len(U)]

    def _with(self, U: np.ndarray, points: np.ndarray) -> np.ndarray:
        return np.concatenate([U, points])

    def _list_pairs(self, X: np.ndarray) -> None:
        """List the pairs within reach of motions from ``X`` up to the list margin."""
        self._bound -= 2.0 * _CORNER * largest_difference(X, self._listed_at)
        near = np.flatnonzero(self._bound < self._reach + self._beyond)
        self._bound[near] = gaps(X, self._all[near], self._all_edges[near]) - self.obstacle.radius
        near = near[self._bound[near] < self._reach + self._beyond]
        self._pairs, self._edges = self._all[near], self._all_edges[near]
        self._low, self._listed_at = self._bound[near], X


_PLATE, _CAPSULE = 3, 2  # number of points that define each


def clearance(obstacle: Obstacle, shift: np.ndarray, U: np.ndarray, F: np.ndarray) -> float:
    """Least distance of an obstacle from a surface; negative if they intersect.

    Of what the surface encloses nothing counts: a sphere may be inside a closed surface. Behind a plate
    everything intersects it.

    Parameters
    ----------
    obstacle : Obstacle
    shift : (3,) float array
        Displacement from the initial position, mesh units.
    U : (n, 3) float array
    F : (m, 3) int array
    """
    if not len(F):
        return np.inf
    points = obstacle.points + shift
    corners = used_vertices(F)
    away = np.full(len(U), np.inf)
    away[corners] = obstacle.distances_and_directions(points, U[corners])[0]
    least = float(away[corners].min())
    if len(points) == _PLATE:
        return least
    near = F[_may_be_nearer(U, F, away, least)]
    if len(points) == _CAPSULE and _crosses(U[near], *points):
        return -obstacle.radius
    return min(least, _least_distance(points, U, near) - obstacle.radius)


def _may_be_nearer(U: np.ndarray, F: np.ndarray, away: np.ndarray, least: float) -> np.ndarray:
    """Mask (m,) of triangles possibly nearer than the nearest vertex, at ``least``."""
    edges = U[F] - U[np.roll(F, 1, axis=1)]
    longest = np.sqrt(np.einsum("ijk,ijk->ij", edges, edges).max(axis=1))
    return away[F].min(axis=1) - longest <= least


def _least_distance(points: np.ndarray, U: np.ndarray, F: np.ndarray) -> float:
    """Distance of a point or segment, given by its ``points``, from triangles ``F``."""
    corners, inverse = np.unique(F, return_inverse=True)
    n, F = len(corners), inverse.reshape(-1, 3)
    X = np.concatenate([U[corners], points])
    pairs = [np.insert(F, 0, n + k, axis=1) for k in range(len(points))]
    if len(points) == _CAPSULE:
        E = np.unique(np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
        pairs.append(np.insert(np.insert(E, 0, n + 1, axis=1), 0, n, axis=1))
    found = np.ascontiguousarray(np.concatenate(pairs), np.int32)
    edges = np.arange(len(found)) >= len(points) * len(F)
    return float(gaps(X, found, edges).min(initial=np.inf))


def _crosses(T: np.ndarray, a: np.ndarray, b: np.ndarray) -> bool:
    """True if the segment from ``a`` to ``b`` crosses a triangle of ``T`` (m, 3, 3).

    By the signs of volumes [Segura & Feito 2001]; where it only touches an edge, distances tell.
    """
    u, v, w, way = T[:, 0] - a, T[:, 1] - a, T[:, 2] - a, b - a
    normal = np.cross(v - u, w - u)
    before = np.einsum("ij,ij->i", u, normal)
    after = before - normal @ way
    sides = np.array([np.cross(x, y) @ way for x, y in ((u, v), (v, w), (w, u))])
    within = (sides > 0.0).all(axis=0) | (sides < 0.0).all(axis=0)
    return bool((within & (before * after < 0.0)).any())
