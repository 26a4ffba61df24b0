"""Descent of a surface in contact with itself, along a path.

The held vertices move in short increments of their path, as far as it is collision-free, and the free ones
follow by the response of the surface. Between two increments the surface descends with its gap energy.
"""

from collections import deque

import numpy as np

from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.linalg.parallel_ops import largest_difference
from apd_viewer.geometry.pose.held_path import HeldPath
from apd_viewer.geometry.solver.constrained_descent import ENERGY_TOLERANCE
from apd_viewer.geometry.solver.iterative_solver import SolverProgress
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium, QuasiNewtonDescent
from apd_viewer.geometry.solver.touching_surface import CollisionFreeProjection, TouchingSurface

# Path increments in mesh sizes: the first, the longest, and the least initial one of a later path.
_FIRST, _LONGEST, _LEAST_FIRST = 2e-3, 8e-3, 2e-5
# Attempts at a path increment; factors of the increment after a blocked and after a successful attempt.
_TRIES, _LESS, _MORE = 6, 0.4, 1.4
# Steps between two path increments: fewest, most, and the relative energy gain below which they end. A shape
# lagging behind the held vertices would wind up.
_FOLLOWING = 4, 40, 1e-3
# The same for a wall while new targets come before the last ones are reached, as in a drag.
_DRAGGED = 2, 6, 0.1
# Change of a goal, relative to its value at rest, per increment towards a target that is not met: the largest
# and the least one, and factors of the increment after a failed and after a successful attempt.
_GOAL_STEP, _LEAST_GOAL_STEP, _SMALLER, _LARGER = 0.01, 1e-5, 0.25, 2.0
# Number of path increments without progress after which the path ends.
_PATIENCE = 12
# Number of steps over which convergence is judged.
_WINDOW = 10
# Longest step of rounding errors alone, in mesh sizes.
_ROUNDING = 1e-12
# Most additional steps to balance the loads of a mesh without held vertices.
_MORE_STEPS = 300


class TouchingDescent:
    """Steps of a surface in contact with itself.

    Parameters
    ----------
    surface : TouchingSurface
    U : (n, 3) float array
        Initial shape, accepted by the contact.
    held_positions : (k + s, 3) float array
        Positions of the held vertices there, and targets of the soft ones.
    goals : tuple of Goal
    tolerance : float
        Converged once ten steps together reduce the energy by at most this part of it.

    Attributes
    ----------
    held_positions : (k + s, 3) float array
        Positions that the held vertices have reached.
    path_fraction : float
        Completed fraction of the path.
    """

    def __init__(
        self,
        surface: TouchingSurface,
        U: np.ndarray,
        held: np.ndarray,
        goals: tuple[Goal, ...],
        tolerance: float = ENERGY_TOLERANCE,
    ) -> None:
        self._surface, self.held_positions, self.tolerance = surface, held, tolerance
        surface.elastic_surface.restart(U)
        surface.local_step(U)
        self._projection = CollisionFreeProjection(surface, goals)
        self._projection.refresh_directions(U)
        self._size = float(np.linalg.norm(np.ptp(surface.rest.V, axis=0)))
        longest = surface.longest_step * self._size
        self._quasi_newton = QuasiNewtonDescent(surface, self._projection, surface.growth, longest)
        self.path_fraction, self._steps, self._last = 1.0, 0, _FIRST
        self._goal_step, self._failures = _GOAL_STEP, 0
        self._was_blocked, self._has_stepped, self._following = False, False, _FOLLOWING
        self._begin_to_converge()

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self._surface.U

    @property
    def progress(self) -> SolverProgress:
        """Shape and readings, marked as not to be displayed after a step along the path.

        It is stuck if no collision-free step leads to shapes meeting the goals.
        """
        return SolverProgress(
            self.U,
            self.held_positions,
            self._projection.values,
            self.has_met_goals,
            is_iterate_hidden=self._steps == 0,
            stuck=self._failures >= _PATIENCE and not self.has_met_goals and not self.is_on_its_way,
            converged=self.converged,
            may_rest=self._may_rest,
            convergence_ratio=self.convergence_ratio,
        )

    @property
    def equilibrium(self) -> Equilibrium:
        """Surface in contact and in equilibrium, for the stability search."""
        multipliers, surface = self._quasi_newton.multipliers, self._surface
        if surface.request_new_metric():
            surface.renew_metric(self._projection.goals, multipliers)
        at = surface, self._projection, multipliers, self.held_positions
        return Equilibrium(*at, surface.solve, surface.is_definite)

    @property
    def has_met_goals(self) -> bool:
        """True if all goals are met at ``U``."""
        return self._projection.is_at_targets

    @property
    def is_stopped(self) -> bool:
        """True if contact keeps the held vertices from moving any further."""
        return self.path_fraction < 1.0 and self._waited >= _PATIENCE

    @property
    def is_on_its_way(self) -> bool:
        """True while the held vertices are moving along their path."""
        return self.path_fraction < 1.0 and not self.is_stopped

    @property
    def converged(self) -> bool:
        """True if the path has ended, and further steps hardly reduce the energy.

        Without held vertices, the loads must also cancel out.
        """
        return not self.is_on_its_way and self._gains_little and self._has_balanced_loads

    @property
    def _has_balanced_loads(self) -> bool:
        """True if the loads cancel out, or many steps have failed to balance them."""
        return self._unbalanced > _MORE_STEPS or self.load_imbalance <= self._surface.most_imbalance

    @property
    def _gains_little(self) -> bool:
        return self._at_minimum or (self.convergence_ratio is not None and self.convergence_ratio <= 1.0)

    @property
    def load_imbalance(self) -> float:
        """Length of the sum of all obstacle loads over the sum of their lengths.

        0 with held vertices, which balance the loads, and for loads that are rounding errors.
        """
        contact = self._surface.contact
        if len(self._surface.elastic_surface.fixed) or not contact.obstacles:
            return 0.0
        contact.quarter_gradient(self.U)
        total = float(np.linalg.norm(contact.loads, axis=1).sum())
        if total <= _ROUNDING * self._size:
            return 0.0
        return float(np.linalg.norm(contact.loads.sum(axis=0))) / total

    @property
    def convergence_ratio(self) -> float | None:
        """Energy gain of the last steps in multiples of the tolerance; None at first."""
        E = self._energies
        if len(E) <= _WINDOW:
            return None
        least = (_ROUNDING * self._size) ** 2
        return float(E[0] - E[-1]) / (self.tolerance * max(abs(float(E[-1])), least))

    def follow_path(self, path: HeldPath, fraction: float) -> None:
        """Follow ``path`` from ``fraction``, the part that held vertices have completed."""
        # Targets may come faster than steps, as in a drag: the shape goes on following the last ones.
        lags, self._following = self.is_on_its_way, _FOLLOWING
        if self._surface.follows_at_once:
            is_dragged = lags and self._has_stepped
            self._following = _DRAGGED if is_dragged else _FOLLOWING
            lags = (is_dragged or self._was_blocked) and not self._has_followed
        self._path, self.path_fraction, self._has_stepped = path, fraction, False
        if fraction < 1.0 and self._surface.make_thick():
            lags = False
        least = self._surface.least_part
        part = self._size / max(path.length, least * self._size)
        self._longest, self._no_part = _LONGEST * part, least * part
        self._goes_at_once = self._surface.follows_at_once and not lags
        keeps_pace = lags or self._surface.follows_at_once
        self._part = part * (max(self._last, _LEAST_FIRST) if keeps_pace else _FIRST)
        self._per_part = 1.0 / part
        self._waited, self._mark = 0, fraction
        if not lags:
            self._steps = 0
            self._begin_to_converge()
            self._quasi_newton.resume()

    def _begin_to_converge(self) -> None:
        self._energies: deque[float] = deque(maxlen=_WINDOW + 1)
        self._at_minimum, self._may_rest, self._unbalanced = False, False, 0

    def step(self) -> None:
        """Advance the held vertices if due, or reduce the energy."""
        is_due, self._has_stepped = self._goes_at_once or self._has_followed, True
        self._goes_at_once = False
        if is_due and not self.has_met_goals and self._approach_goals():
            return
        if self.is_on_its_way and is_due:
            self._advance_on_path()
            return
        self._steps += 1
        if self._surface.renew_metric(self._projection.goals, self._quasi_newton.multipliers):
            # Goal directions depend on the contact springs; outdated ones would push against the contact.
            self._projection.refresh_directions(self.U)
            self._quasi_newton.resume()
        before = self.U
        moved = self._quasi_newton.step(self.held_positions)
        awaits_metric = not moved and self._surface.request_new_metric()
        self._at_minimum = not moved and not awaits_metric
        self._surface.contact.accept_shape(self.U)
        self._energies.append(self._quasi_newton.energy)
        self._unbalanced = self._unbalanced + 1 if self._gains_little else 0
        stands = not awaits_metric and largest_difference(self.U, before) <= _ROUNDING * self._size
        self._may_rest = stands and not self.is_on_its_way and self._has_balanced_loads
        if (self.converged or self._may_rest) and self._surface.make_thinner():
            self._steps = 0
            self._begin_to_converge()
            self._quasi_newton.resume()

    @property
    def _has_followed(self) -> bool:
        """True if the shape has roughly adapted to the held vertices."""
        E, (least, most, follows) = self._energies, self._following
        slow = len(E) > 1 and E[-2] - E[-1] <= follows * abs(E[-1])
        return self._steps >= most or (self._steps >= least and slow)

    def _approach_goals(self) -> bool:
        """Bring the shape nearer to goals it does not meet; False if none could be."""
        while self._goal_step >= _LEAST_GOAL_STEP:
            self._projection.approach_targets(self._surface.U, self._goal_step)
            self._projection.refresh_directions(self._surface.U)
            if self._move_to(self._surface.U):
                self._goal_step = min(_GOAL_STEP, _LARGER * self._goal_step)
                self._steps = self._failures = 0
                self._begin_to_converge()
                self._quasi_newton.resume()
                return True
            self._goal_step *= _SMALLER
        self._projection.approach_targets(self._surface.U, 0.0)
        self._goal_step, self._failures = _GOAL_STEP, self._failures + 1
        return False

    def _advance_on_path(self) -> None:
        """Move the held vertices along the next collision-free part of the path."""
        self._steps = 0
        for attempt in range(_TRIES):
            self._was_blocked = attempt > 0
            fraction = min(1.0, self.path_fraction + self._part)
            if self._move_held_vertices(fraction):
                self.path_fraction = fraction
                self._part = min(self._longest, _MORE * self._part)
                break
            self._part = max(_LESS * self._part, self._no_part)
        self._last = self._part * self._per_part
        if self.path_fraction - self._mark > _PATIENCE * self._no_part:
            self._mark, self._waited = self.path_fraction, 0
        self._waited += 1
        self._surface.attach_springs(self.held_positions)
        self._begin_to_converge()
        self._quasi_newton.resume(self._surface.reach * self._size)

    def _move_held_vertices(self, fraction: float) -> bool:
        """Move held vertices and obstacles, free vertices following; False if blocked."""
        surface, projection, start = self._surface, self._projection, self._surface.U
        held = self._path.positions_at(fraction)
        surface.contact.set_obstacle_targets(self._path.shifts_at(fraction))
        if not self._move_to(
            surface.all_positions(surface.following_positions(self.held_positions, held), held)
        ):
            surface.contact.set_obstacle_targets(self._path.shifts_at(self.path_fraction))
            projection.evaluate(start)
            return False
        self.held_positions = held
        return True

    def _move_to(self, W: np.ndarray) -> bool:
        """Move to a shape near ``W`` (n, 3) meeting the goals; False if blocked."""
        W, _ = self._projection.project(W)
        if not (self._projection.has_met_goals and self._surface.has_wide_gaps(W)):
            return False
        self._surface.local_step(W)
        self._surface.contact.accept_shape(W)
        return True
