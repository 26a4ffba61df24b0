"""Constrained descent: iterations on the manifold of shapes meeting all goals.

The energy is minimised subject to ``c(U) = 0``, the deviations from the goals. With g the gradients of the
goals, and the current multipliers in the right-hand side, one global step gives p; from there the goals are
met along directions y that need not be recomputed in every iteration:

    p = K^-1 (b + mult g),   y = K^-1 g,   U = p + mu y  with  c(U) = 0,   mult += mu.

At convergence mu is zero, and ``K U = b + mult g`` is the condition of Karush, Kuhn and Tucker. Without
goals this is the plain iteration of a local and a global step.
"""

from collections import deque

import numpy as np

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goal_projection import GOAL_TOLERANCE, GoalProjection
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.solver.adaptive_metric import AdaptiveMetric, gains_from_hessian
from apd_viewer.geometry.solver.iterative_solver import SolverProgress
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium, QuasiNewtonDescent

# The directions y become outdated as the shape rotates: recomputed after this many iterations.
_REFRESH = 100
# Gradients are reused for this many iterations, unless the pressure of the multipliers is above _CALM.
_LAG = 8
_CALM = 0.1
# Gradients lag by one iteration anyway: above this pressure a full step would overshoot.
_STEADY = 0.5
# Bounds of the multipliers: early steps predict their final values badly, and those of nearly contradictory
# goals would grow without bound.
_LARGEST_GROWTH = 0.5
_LARGEST_PRESSURE = 2.0
_DAMPINGS = (1.0, 0.25, 0.0625)
# Goals are given up after this many iterations without reducing the largest violation by a hundredth.
_PATIENCE = 60
_REDUCTION = 0.99
# Steps over which convergence is judged, by the fraction of the energy that they remove together.
_WINDOW = 10
ENERGY_TOLERANCE = 1e-7
# Relative reduction of the energy by ten steps with K below which the Hessian takes over.
LATE_TOLERANCE = 1e-3
# Hessian steps have converged, to 1e-5 of the energy, once this many of them reduce it by at most this many
# tolerances. Fewer steps may gain as little near a saddle, and thousands of times as much beyond it.
_HESSIAN_WINDOW, _HESSIAN_GAIN = 40, 40.0
# Descents to this tolerance or a coarser one end before Hessian steps pay off; on coarse levels such steps
# also give the finer ones a worse start.
_FINE = 1e-4
_NO_ENERGY = 1e-300  # avoids a division by zero for rigid motions


class ConstrainedDescent:
    """Quasi-Newton steps, or plain iterations, of an elastic surface subject to goals.

    Parameters
    ----------
    surface : ElasticSurface
    goals : tuple of Goal
    tolerance : float
        Converged once ten steps together reduce the energy by at most this part of it.
    plain : bool
        Do plain iterations only.

    Attributes
    ----------
    held_positions : (k + s, 3) float array
        Positions of the held vertices, then the targets of the soft ones.
    multipliers : (g,) float array
        Lagrange multipliers of the goals.
    stuck : bool
        The goals have been given up; the current shape is the best found, and stays.
    """

    def __init__(
        self,
        surface: ElasticSurface,
        goals: tuple[Goal, ...] = (),
        tolerance: float = ENERGY_TOLERANCE,
        plain: bool = False,
    ) -> None:
        self.surface = surface
        self._tolerance = tolerance
        self._plain = plain
        self._metric = AdaptiveMetric(surface)
        self._edge = float(np.sqrt(surface.rest.vertex_areas.mean()))
        self.goals: tuple[Goal, ...] = ()
        self.multipliers = np.zeros(0)
        self.set_goals(goals)

    @property
    def progress(self) -> SolverProgress:
        """Current shape and readings; ``converged`` is None in plain iterations."""
        projection = self._projection
        return SolverProgress(
            self.surface.U,
            self.held_positions,
            projection.values,
            projection.has_met_goals,
            stuck=self.stuck,
            converged=None if self._plain else self.has_converged,
            convergence_ratio=self._convergence_ratio,
        )

    @property
    def _convergence_ratio(self) -> float | None:
        E = self._energies
        if len(E) <= _WINDOW:
            return None
        return float(E[0] - E[-1]) / max(self._tolerance * float(E[-1]), _NO_ENERGY)

    @property
    def has_ended(self) -> bool:
        """True if converged, or stuck because goals cannot be met."""
        return self.stuck or self.has_converged

    @property
    def has_converged(self) -> bool:
        """True if further steps would hardly reduce the energy."""
        E = self._by_hessian
        slow = len(E) > _HESSIAN_WINDOW and E[0] - E[-1] <= _HESSIAN_GAIN * self._tolerance * E[-1]
        return self._at_minimum or self.has_stalled(self._tolerance) or slow

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""
        return self.surface.factor.ready

    @property
    def energy(self) -> float:
        """Energy of the current shape."""
        return self._quasi_newton.energy if self._quasi_newton else self.surface.energy

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Surface in equilibrium, for the stability search; None in plain iterations."""
        if self._plain:
            return None
        solve = self._metric.search_metric.solve
        return Equilibrium(self.surface, self._projection, self.multipliers, self.held_positions, solve)

    def set_tolerance(self, tolerance: float) -> None:
        """Set the tolerance on the relative energy decrease over ten steps."""
        self._tolerance = tolerance

    def has_stalled(self, tolerance: float) -> bool:
        """True if the last steps reduced the energy by at most this fraction."""
        E = self._energies
        return len(E) > _WINDOW and E[0] - E[-1] <= tolerance * E[-1]

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Replace the goals."""
        if [goal.name for goal in goals] != [goal.name for goal in self.goals]:
            self.multipliers = np.zeros(len(goals))
        self.goals = goals
        self._projection = GoalProjection(self.surface, goals)
        self._age = 0
        self._reset()

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.surface.restart(U)
        self._projection.evaluate(U)
        self.multipliers = np.zeros(len(self.goals))
        self._age = 0
        self._reset()

    def shapes(self) -> list[np.ndarray]:
        """The current shape."""
        return [self.surface.U]

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""
        self.restart(shapes[0])

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the target positions (k + s, 3) of the held and soft vertices."""
        self.held_positions = targets
        self._reset()

    def _reset(self) -> None:
        """Forget the progress made towards other goals or targets."""
        self._nearest = (np.inf, self.surface.U)
        self._waited = 0
        self.stuck = False
        self._quasi_newton: QuasiNewtonDescent | None = None
        self._energies: deque[float] = deque(maxlen=_WINDOW + 1)
        self._by_hessian: deque[float] = deque(maxlen=_HESSIAN_WINDOW + 1)
        self._at_minimum = False
        self._lag = 0
        if self._metric.is_hessian:
            self._metric.reset()
            self._age = 0  # recompute the goal directions, last found with the Hessian

    def step(self) -> None:
        """Do a quasi-Newton step, or a plain iteration until the goals are met.

        The first iteration after the held vertices have moved is always a plain one.
        """
        if self._plain:
            self.iterate()
        elif self._quasi_newton is None:
            self.iterate()
            if self._projection.has_met_goals and not self.stuck:
                self._quasi_newton = QuasiNewtonDescent(self.surface, self._projection)
        else:
            self._update_metric()
            self._at_minimum = not self._quasi_newton.step(self.held_positions)
            self.multipliers = self._quasi_newton.multipliers
            self._energies.append(self._quasi_newton.energy)
            if self._metric.is_hessian:
                self._by_hessian.append(self._quasi_newton.energy)

    def smooth(self, iterations: int) -> None:
        """Iterate on this level alone: plain iterations first, then quasi-Newton steps."""
        for _ in range(iterations):
            if self._quasi_newton is None:
                self.iterate()
            else:
                self.step()

    def _update_metric(self) -> None:
        """Use the Hessian as the metric near the minimum."""
        metric = self._metric
        late = self._tolerance < _FINE and self.has_stalled(LATE_TOLERANCE)
        if metric.is_hessian or (late and gains_from_hessian(self.surface)):
            metric.update(self._projection)

    def iterate(self) -> None:
        """Do a global step, the projection onto the goals, and the local step."""
        if self.stuck:
            return
        surface, projection = self.surface, self._projection
        if not self.goals:
            surface.local_step(surface.global_step(self.held_positions))
            return
        met_before, pressure = self._projection.has_met_goals, self._pressure(self.multipliers)
        self._update_directions(pressure)
        start, end = surface.U, surface.global_step(self.held_positions, self.multipliers, projection.g)
        steady = 1.0 / max(1.0, _STEADY + pressure)
        for damping in _DAMPINGS if met_before else _DAMPINGS[:1]:
            fraction = damping * steady
            U, mu = projection.project(end if fraction == 1.0 else self._blend(start, end, fraction))
            if self._projection.has_met_goals:
                break
        self.multipliers = self._next_multipliers(fraction, mu)
        surface.local_step(U)
        self._give_up_stalled()

    def _update_directions(self, pressure: float) -> None:
        """Update gradients and directions of the goals every few iterations."""
        projection, U = self._projection, self.surface.U
        if self._age % _REFRESH == 0 or projection.has_outdated_directions:
            projection.refresh_directions(U)
            self._age = 0
        elif self._lag % _LAG == 0 or pressure > _CALM:
            projection.evaluate(U)
        self._age += 1
        self._lag += 1

    def _blend(self, start: np.ndarray, end: np.ndarray, fraction: float) -> np.ndarray:
        U = start + fraction * (end - start)
        U[self.surface.fixed] = self.held_positions[: len(self.surface.fixed)]
        return U

    def _next_multipliers(self, fraction: float, mu: np.ndarray) -> np.ndarray:
        """Multipliers plus ``fraction`` times ``mu``, with bounded growth and pressure."""
        updated = self.multipliers + fraction * mu / max(1.0, self._pressure(mu) / _LARGEST_GROWTH)
        return updated / max(1.0, self._pressure(updated) / _LARGEST_PRESSURE)

    def _pressure(self, multipliers: np.ndarray) -> float:
        return self._projection.force_stiffness(multipliers, self._edge)

    def _give_up_stalled(self) -> None:
        """Give up the goals after a long stall, and restore the best shape."""
        worst = self._projection.largest_violation
        if worst <= GOAL_TOLERANCE or worst < _REDUCTION * self._nearest[0]:
            self._nearest, self._waited = (worst, self.surface.U), 0
            return
        self._waited += 1
        if self._waited >= _PATIENCE:
            self.stuck = True
            self.surface.local_step(self._nearest[1])
            self._projection.evaluate(self.surface.U)
