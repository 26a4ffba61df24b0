"""Elastic surface in contact with itself, and its projection.

Both replace the wrapped objects, so that contact is transparent to a quasi-Newton descent: energy and forces
include gaps, and every shape is reached by a collision-free step.

A shape is free of net rotation if it preserves ``sum_i m_i a_i x u_i``, a the initial positions about
their centre [Eckart 1935, Some studies concerning rotating axes and polyatomic molecules]. This constrains
each shape: applied from step to step, with changing positions, surfaces could turn like a falling cat. The
constraint does no work, so that loads stay derivatives of the energy.
"""

from abc import ABC, abstractmethod

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.enclosed_gas import EnclosedVolume
from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.goals.goal_projection import GOAL_TOLERANCE, GoalProjection
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.linear_solver import Factor, LinearSolver

# Steps after which the contact springs are renewed.
_RENEWED = 40
# Attempts at a collision-free step: first with a fraction for each vertex, then with one for all.
_LOCAL, _ATTEMPTS = 3, 4
_MOST_AT_ONCE = 0.5


class TouchingSurface(ABC):
    """Elastic surface with gap energy.

    Parameters
    ----------
    elastic_surface : HeldSurface
    contact : Contact
    gas : EnclosedVolume, optional

    Attributes
    ----------
    longest_step : float
        Longest displacement of a vertex by one step, in mesh sizes.
    growth : float
        Largest first length of a line search, relative to the final one of the last search: in dense contact,
        about that length is collision-free.
    reach : float
        Displacement, in mesh sizes, above which the first searches after a part of the path are no longer
        than those after the last part: longer ones would be refused. Infinite for no such limit.
    least_part : float
        Shortest part of the path of held vertices and obstacles, in mesh sizes.
    follows_at_once : bool
        Whether a new path continues at the pace of the last one, since a drag is faster than the steps.
    most_imbalance : float
        Largest imbalance at rest of the loads on a mesh without held vertices.
    """

    longest_step, growth, reach, least_part, follows_at_once = np.inf, 1.6, 5e-4, 1e-4, False
    # Loads on two plates then agree within a thousandth.
    most_imbalance = 4e-4

    def __init__(
        self, elastic_surface: HeldSurface, contact: Contact, gas: EnclosedVolume | None = None
    ) -> None:
        self.elastic_surface, self.contact, self.gas = elastic_surface, contact, gas
        self.rest, self.free = elastic_surface.rest, elastic_surface.free

    @property
    def U(self) -> np.ndarray:
        """Current positions, (n, 3) float array."""
        return self.elastic_surface.U

    @property
    def energy(self) -> float:
        """Energy of the current positions."""
        return self._total_energy(self.elastic_surface.energy)

    def _total_energy(self, elastic_energy: float) -> float:
        """Total energy of the current positions, given the ``elastic_energy``."""
        gas = self.gas.energy(self.elastic_surface.U) if self.gas else 0.0
        return elastic_energy + self.contact.energy_at(self.elastic_surface.U) + gas

    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3)."""
        return self._with_contact(self.elastic_surface.residual(targets), self.elastic_surface.U)

    def _with_contact(self, residual: np.ndarray, U: np.ndarray) -> np.ndarray:
        """Elastic ``residual`` (f, 3) plus those of gaps and gas at ``U`` (n, 3)."""
        residual += parallel_ops.gathered_rows(self.contact.quarter_gradient(U), self.free)
        if self.gas:
            residual += 0.25 * self.gas.gradient(U)[self.free]
        return residual

    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""
        residual = self._with_contact(self.elastic_surface.residual_at(U, targets), U)
        self.contact.quarter_gradient(self.U)  # contact readings come from the last gradient
        return residual

    def all_positions(self, X: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Positions (n, 3), with free vertices at ``X`` and held ones at ``targets``."""
        return self.elastic_surface.all_positions(X, targets)

    def positions_along(
        self, U: np.ndarray, fraction: float, direction: np.ndarray, targets: np.ndarray
    ) -> np.ndarray:
        """``U`` (n, 3) plus a fraction of ``direction`` (f, 3); held ones at ``targets``."""
        return self.elastic_surface.positions_along(U, fraction, direction, targets)

    def local_step(self, U: np.ndarray) -> None:
        """Make ``U`` (n, 3) current and compute each term's projection there."""
        self.elastic_surface.local_step(U)

    def energy_after_local_step(self, U: np.ndarray) -> float:
        """Make ``U`` (n, 3) current; return its energy."""
        return self._total_energy(self.elastic_surface.energy_after_local_step(U))

    @property
    def is_definite(self) -> bool | None:
        """True if the last Hessian was positive definite; None if unknown."""
        return None

    @abstractmethod
    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Response to forces ``b_f``, both (f, 3), with the contact springs."""

    @abstractmethod
    def following_positions(self, held: np.ndarray, held_after: np.ndarray) -> np.ndarray:
        """Free positions (f, 3) after a motion of held vertices and obstacles.

        Parameters
        ----------
        held, held_after : (k + s, 3) float arrays
            Held and soft vertices before and after it; obstacles go ahead as they are told.
        """

    @abstractmethod
    def renew_metric(self, goals: tuple[Goal, ...], multipliers: np.ndarray) -> bool:
        """Update the metric if due; False if nothing changed.

        Parameters
        ----------
        goals : tuple of Goal
        multipliers : (g,) float array
            Their Lagrange multipliers, for metrics that know the curvature of the goals.
        """

    def request_new_metric(self) -> bool:
        """Request a new metric for the next step; False if it would not change."""
        return False

    def make_thick(self) -> bool:
        """Restart with a material that easily follows; False if it is the same."""
        return False

    def make_thinner(self) -> bool:
        """Continue closer to the requested thickness of a wall; False if reached already."""
        return False

    def attach_springs(self, targets: np.ndarray) -> None:  # noqa: B027 (optional)
        """Attach springs to soft vertices, at ``targets`` (k + s, 3) after the held ones."""

    def has_wide_gaps(self, _: np.ndarray) -> bool:
        """True if the gaps at positions (n, 3) are wide enough to continue from there."""
        return True

    def without_drift(self, U: np.ndarray, _: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) without a rigid motion that nothing but contact has caused.

        Vertices pushed or stopped by contact have moved the surface a little as a whole. The others move it
        back, each by as much as its weight, the second argument (n,).
        """
        return U


class TouchingElasticSurface(TouchingSurface):
    """Elastic surface with a constant matrix and gap energy.

    Parameters
    ----------
    elastic_surface : ElasticSurface
    contact : Contact
    gas : EnclosedVolume, optional
    """

    elastic_surface: ElasticSurface

    def __init__(
        self, elastic_surface: ElasticSurface, contact: Contact, gas: EnclosedVolume | None = None
    ) -> None:
        super().__init__(elastic_surface, contact, gas)
        self._metric: Factor = elastic_surface.factor
        self._to_held: sp.csr_array | None = None
        self._age = _RENEWED
        self._first = parallel_ops.gathered_rows(elastic_surface.U, elastic_surface.free)

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Response to forces ``b_f``, both (f, 3), with the contact springs.

        Without held vertices it has no net rotation relative to the initial shape: between plates without
        friction, any shape would topple.
        """
        if len(self.elastic_surface.fixed):
            return self._metric.solve(b_f)
        turns = NetRotationFilter(parallel_ops.gathered_rows(self.U, self.free), self._masses, self._first)
        return turns.without_rotation(self._metric.solve(turns.without_torque(b_f)))

    def without_drift(self, U: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) without rotation from the initial shape, if nothing is held.

        See :meth:`TouchingSurface.without_drift`.
        """
        if len(self.elastic_surface.fixed):
            return U
        X, free = parallel_ops.gathered_rows(U, self.free), self.free
        turns = NetRotationFilter(X, self._masses, self._first, weight[free])
        return self.all_positions(turns.without_rotation(X), U[:0])

    @property
    def _masses(self) -> np.ndarray:
        return self.rest.vertex_areas[self.free]

    def following_positions(self, held: np.ndarray, held_after: np.ndarray) -> np.ndarray:
        """Free positions (f, 3) after a motion of held vertices and obstacles.

        Parameters
        ----------
        held, held_after : (k + s, 3) float arrays
            Held and soft vertices before and after it; obstacles go ahead as they are told.
        """
        pull = self.elastic_surface.held_contribution(held) - self.elastic_surface.held_contribution(
            held_after
        )
        if self._to_held is not None:
            k = len(self.elastic_surface.fixed)
            moves = [pairs.points_ahead[0] - pairs.points[0] for pairs in self.contact.obstacles]
            pull -= self._to_held @ np.vstack([held_after[:k] - held[:k], *moves])
        start = parallel_ops.gathered_rows(self.U, self.free)
        W = self.all_positions(start + self.solve(pull), held_after)
        carried = self.contact.positions_pushed_by_obstacles(self.U, W)
        return parallel_ops.gathered_rows(self.without_drift(carried, (carried == W).all(axis=1)), self.free)

    def renew_metric(self, _: tuple[Goal, ...], _multipliers: np.ndarray) -> bool:
        """Update the contact springs if due; False if nothing changed."""
        self._age += 1
        if self._age <= _RENEWED:
            return False
        if not self.contact.may_touch:
            was, self._metric, self._to_held = self._metric, self.elastic_surface.factor, None
            return was is not self._metric
        springs = self.contact.springs(self.elastic_surface.U)[self.free]
        # Order the unknowns by current positions: touching parts may be far apart in the rest shape.
        matrix = self.elastic_surface.factored_matrix + springs[:, self.free]
        self._metric = LinearSolver(matrix.tocsr(), self.elastic_surface.U[self.free])
        others = np.concatenate([self.elastic_surface.fixed, np.arange(len(self.U), springs.shape[1])])
        self._to_held, self._age = springs[:, others], 0
        return True


class CollisionFreeProjection(GoalProjection):
    """Projection onto goals by collision-free steps only.

    Parameters
    ----------
    surface : TouchingSurface
    goals : tuple of Goal
    """

    def __init__(self, surface: TouchingSurface, goals: tuple[Goal, ...]) -> None:
        super().__init__(surface, goals)
        self._surface = surface
        self._contact, self._held = surface.contact, surface.elastic_surface.fixed
        self._is_free = True

    @property
    def has_met_goals(self) -> bool:
        """True if the goals are met at the last positions by a collision-free step."""
        return self._is_free and super().has_met_goals

    def project(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Collision-free positions near ``U`` (n, 3) meeting the goals, and steps (g,)."""
        start, self._is_free = self._contact.start, False
        W, mu = super().project(U)
        for attempt in range(_ATTEMPTS + 1):
            if self.largest_violation > GOAL_TOLERANCE:
                break
            fractions = self._contact.trial_fractions(W)
            self._is_free = fractions is None
            if fractions is None or attempt == _ATTEMPTS:
                break
            if attempt >= _LOCAL:
                fractions[:] = min(_MOST_AT_ONCE, float(fractions.min()))
            nearer = start + fractions[:, None] * (W - start)
            nearer[self._held] = W[self._held]
            W, mu = super().project(self._surface.without_drift(nearer, fractions))
        return W, mu


_AXES = np.eye(3)


class NetRotationFilter:
    """Projection removing net rotation, or net torque, about the centre of a shape.

    Parameters
    ----------
    X : (n, 3) float array
        The shape.
    masses : (n,) float array
    first : (n, 3) float array
        The shape that it must not turn against.
    weight : (n,) array, optional
        Relative rotation of each vertex in the correction; equal by default.
    """

    def __init__(
        self, X: np.ndarray, masses: np.ndarray, first: np.ndarray, weight: np.ndarray | None = None
    ) -> None:
        m = masses / masses.sum()
        self._away, self._first = X - _mean(m, X), m[:, None] * (first - _mean(m, first))
        if weight is not None:
            self._away *= weight[:, None]
        second = _products(self._away, self._first)
        self._per_moment = np.linalg.pinv(np.trace(second) * _AXES - second)

    def without_rotation(self, step: np.ndarray) -> np.ndarray:
        """``step`` (n, 3), or the shape itself, without its net rotation."""
        turn = self._per_moment @ _moment(self._first, step)
        return step - self._away @ _cross_matrix(turn)

    def without_torque(self, force: np.ndarray) -> np.ndarray:
        """``force`` (n, 3) without its net torque: transpose of :meth:`without_rotation`."""
        turn = self._per_moment.T @ _moment(self._away, force)
        return force - self._first @ _cross_matrix(turn)


def _moment(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Sum (3,) of the cross products of corresponding rows."""
    P = _products(X, Y)
    return np.array([P[1, 2] - P[2, 1], P[2, 0] - P[0, 2], P[0, 1] - P[1, 0]])


def _cross_matrix(turn: np.ndarray) -> np.ndarray:
    """Matrix (3, 3) mapping a row vector to ``turn x row``."""
    return np.cross(turn, _AXES)


# einsum instead of BLAS, whose sums depend on the number of threads.


def _mean(m: np.ndarray, X: np.ndarray) -> np.ndarray:
    return np.einsum("i,ij->j", m, X)


def _products(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ik->jk", X, Y)
