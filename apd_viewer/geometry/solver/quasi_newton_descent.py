"""Quasi-Newton descent on the shapes with all goals met.

The slope that counts is that of the Lagrangian, ``G - mult g``, where the multipliers leave none of it
along the directions y of the projection: then a step d followed by the projection changes the energy by
just ``(G - mult g) . d`` to first order, whichever directions y are. Where it vanishes, the conditions of
Karush, Kuhn and Tucker hold.
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from apd_viewer.geometry.goals.goal_projection import ElasticResponse, GoalProjection
from apd_viewer.geometry.linalg.lbfgs import LbfgsMemory

_REMEMBERED = 5
# Smallest accepted fraction of the decrease predicted by the slope [Armijo 1966].
_SHARE_OF_PROMISE = 1e-4
# Relative rounding error of an energy.
_ROUNDING = 1e-15
# Halvings of a step by remembered steps, and of one by the metric alone: that ends at rounding errors.
_HALVINGS, _LAST_HALVINGS = 12, 60
# Steps after a part of a path that are compared with those after the last part; at least as many follow.
_FIRST_STEPS = 4


class DescentSurface(ElasticResponse, Protocol):
    """Interface of an elastic surface to a descent."""

    @property
    def energy(self) -> float:
        """Energy of the current positions."""

    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3)."""

    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""

    def positions_along(
        self, U: np.ndarray, fraction: float, direction: np.ndarray, targets: np.ndarray
    ) -> np.ndarray:
        """``U`` (n, 3) plus a fraction of ``direction`` (f, 3); held ones at ``targets``."""

    def local_step(self, U: np.ndarray) -> None:
        """Fit the rotations to ``U`` (n, 3) and make it the current shape."""

    def energy_after_local_step(self, U: np.ndarray) -> float:
        """Do a local step at ``U`` (n, 3), and return the energy there."""


class Equilibrium(NamedTuple):
    """Surface in equilibrium, for the stability search.

    Attributes
    ----------
    surface : DescentSurface
    projection : GoalProjection
    multipliers : (g,) float array
    held_positions : (k + s, 3) float array
    solve : callable
        Response (f, 3) to forces (f, 3) in the metric that curvatures are relative to.
    is_definite : bool or None
        Whether the energy rises in every direction, even off the goals; None if unknown.
    """

    surface: DescentSurface
    projection: GoalProjection
    multipliers: np.ndarray
    held_positions: np.ndarray
    solve: Callable[[np.ndarray], np.ndarray]
    is_definite: bool | None = None

    def quarter_gradient(self, U: np.ndarray) -> np.ndarray:
        """Quarter of the Lagrangian's gradient (f, 3) at ``U`` (n, 3) near the shape."""
        G = self.surface.residual_at(U, self.held_positions)
        self.projection.evaluate(U)
        return self.projection.lagrangian_gradient(G, self.multipliers, self.projection.g)

    def moved_along(self, direction: np.ndarray) -> np.ndarray:
        """Positions (n, 3) displaced by ``direction`` (f, 3)."""
        return self.surface.positions_along(self.surface.U, 1.0, direction, self.held_positions)


class QuasiNewtonDescent:
    """Quasi-Newton steps of an elastic surface on the goals' manifold.

    Parameters
    ----------
    surface : DescentSurface
    projection : GoalProjection
    growth : float
        A line search begins at most so many times as far as the last one ended.
    longest : float
        Longest displacement of a vertex, mesh units.
    """

    def __init__(
        self,
        surface: DescentSurface,
        projection: GoalProjection,
        growth: float = np.inf,
        longest: float = np.inf,
    ) -> None:
        self._growth, self._longest, self._share = growth, longest, 1.0
        # Displacements of the first steps after the last part of a path, and the number of steps since.
        self._first_reaches, self._steps, self._reach = np.full(_FIRST_STEPS, np.inf), _FIRST_STEPS, np.inf
        self._elastic, self._projection = surface, projection
        self._memory = LbfgsMemory(len(surface.free), _REMEMBERED)
        # G and g at the start of the last step.
        self._last: tuple[np.ndarray, np.ndarray] | None = None
        self.multipliers = np.zeros(len(projection.goals))
        self.energy = surface.energy

    def resume(self, reach: float = np.inf) -> None:
        """Continue from changed positions, keeping the memory of earlier steps.

        Parameters
        ----------
        reach : float
            Displacement that the first searches after a part of a path may begin with in any case; longer
            ones begin at most ``growth`` times as far as those after the last part ended. Infinite after
            other changes, which tell nothing.
        """
        if reach < np.inf:
            self._steps, self._reach = 0, reach
        self._last = None
        self.energy = self._elastic.energy

    def step(self, held: np.ndarray) -> bool:
        """Do one step with held vertices at ``held`` (k, 3); return False at a minimum."""
        surface, projection = self._elastic, self._projection
        projection.evaluate(surface.U)
        if projection.has_outdated_directions:
            projection.refresh_directions(surface.U)
        G, spare = surface.residual(held), None
        self.multipliers = projection.multipliers(G)
        slope = projection.lagrangian_gradient(G, self.multipliers, projection.g)
        if self._last is not None:
            G_before, spare = self._last
            self._memory.store_gradients(
                slope, projection.lagrangian_gradient(G_before, self.multipliers, spare)
            )
        g, projection.g = projection.g, np.zeros_like(projection.g) if spare is None else spare
        moved = self._line_search(slope, held)
        self._last = (G, g) if moved else None
        return moved

    def _line_search(self, slope: np.ndarray, held: np.ndarray) -> bool:
        """Line search from the current positions; False if it fails."""
        surface, start = self._elastic, self._elastic.U
        before = self._projection.energy_at_targets(self.energy, self.multipliers)
        while True:
            way, along = self._memory.descent_direction(slope, surface.solve)
            promise, first = 4.0 * along, min(1.0, self._growth * self._share)
            is_first, longest = self._steps < _FIRST_STEPS, self._longest
            if is_first:
                longest = min(longest, max(self._reach, self._growth * self._first_reaches[self._steps]))
            if is_first or longest < np.inf:
                reach = max(float(np.abs(way).max()), 1e-300)
                first = min(first, longest / reach)
            for halvings in range(_HALVINGS if len(self._memory) else _LAST_HALVINGS):
                fraction = first * 0.5**halvings
                if halvings > _HALVINGS and fraction * abs(promise) <= _ROUNDING * abs(before):
                    break
                U, _ = self._projection.project(surface.positions_along(start, fraction, way, held))
                energy = surface.energy_after_local_step(U)
                after = self._projection.energy_at_targets(energy, self.multipliers)
                enough = after <= before + _SHARE_OF_PROMISE * fraction * promise
                if enough and self._projection.has_met_goals:
                    # At rest even steps of 1e-40 are accepted, and the next searches would begin there.
                    self.energy, self._share = energy, max(fraction, 0.5**_HALVINGS)
                    if is_first:
                        self._first_reaches[self._steps] = fraction * reach
                        self._steps += 1
                    self._memory.record_step(start, U, surface.free)
                    return True
            surface.local_step(start)
            self._projection.evaluate(start)
            if not len(self._memory):
                return False
            self._memory.clear()
