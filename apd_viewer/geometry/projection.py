"""Back onto the shapes that meet all goals, by Newton's method along a few fixed directions.

With g the gradients of the goals c, the directions are ``y = K^-1 g``: the smoothest ways to change what
the goals measure. They need not be those of today's gradients, only to lead there.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry import vectors
from apd_viewer.geometry.elastic import Elastic
from apd_viewer.geometry.goals import Goal

# Relative to the value at rest; one order better than is promised.
MET = 1e-10
_NEWTON_STEPS = 8
# Directions are made anew once a goal moves only half as much along its own as it did.
_FADED = 0.5


class Projection:
    """The goals of an elastic surface, and the way to meet them.

    Parameters
    ----------
    elastic : Elastic
    goals : tuple of Goal

    Attributes
    ----------
    values : (g,) float array
        What the goals measure at the positions evaluated last.
    g : (g, n, 3) float array
        Their gradients there.
    worn : bool
        Whether the directions are no longer good ones.
    """

    def __init__(self, elastic: Elastic, goals: tuple[Goal, ...]) -> None:
        self._elastic = elastic
        self.goals = goals
        self._target = np.array([goal.target for goal in goals])
        self._unit = np.array([abs(goal.rest) for goal in goals])
        self.g = np.zeros((len(goals), *elastic.U.shape))
        self._y = np.zeros_like(self.g)
        self.evaluate(elastic.U)
        self.worn = True

    @property
    def met(self) -> bool:
        """Whether all goals are met at the positions evaluated last."""
        return self.worst <= MET

    @property
    def worst(self) -> float:
        """The largest miss there, relative to the value at rest."""
        return float(np.abs(self._misses(self.values)).max(initial=0.0))

    def evaluate(self, U: np.ndarray) -> None:
        """Find values and gradients at ``U`` (n, 3)."""
        both = zip(self.goals, self.g, strict=True)
        self.values = np.array([goal.value_and_gradient(U, g) for goal, g in both])

    def refresh(self) -> None:
        """Make the directions those of the gradients of today."""
        free = self._elastic.free
        for y, g in zip(self._y, self.g, strict=True):
            y[free] = self._elastic.solve(g[free])
        self._slopes = self._measured_slopes()
        self._power = np.diag(self._slopes).copy()
        self.worn = False

    def multipliers(self, G: np.ndarray) -> np.ndarray:
        """How much of each goal's gradient to take from ``G`` (f, 3) so that no direction is uphill, (g,)."""
        free = self._elastic.free
        along = [vectors.dots(vectors.taken(y, free)[None], G)[0] for y in self._y]
        return np.linalg.lstsq(self._slopes.T, np.array(along), rcond=1e-10)[0] if along else np.zeros(0)

    def onto(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The positions near ``U`` (n, 3) that meet the goals, if there are any, and how far along each way.

        Leaves values and gradients of the positions that it returns. On the way the slopes are corrected
        by what each step has brought [Broyden 1965]: values cost less than gradients.
        """
        mu = np.zeros(len(self.goals))
        values = self._measured(U)
        share = 1.0
        fresh = False  # whether gradients and directions are those of U
        for _ in range(_NEWTON_STEPS):
            worst = self._worst_that_can_move(values)
            if worst <= MET:
                break
            step = share * self._newton_step(values)
            there = vectors.moved(U, step, self._y)
            tried = self._measured(there)
            if self._worst_that_can_move(tried) < (1.0 - 0.1 * share) * worst:
                surprise = tried - values - self._slopes @ step
                self._slopes = self._slopes + np.outer(surprise, step) / (step @ step)
                U, values, mu, share, fresh = there, tried, mu + step, 1.0, False
            elif fresh:
                share *= 0.5
            else:
                self.evaluate(U)
                self.refresh()
                fresh = True
        self.evaluate(U)
        self._slopes = self._measured_slopes()
        self.worn = bool((np.diag(self._slopes) < _FADED * self._power).any())
        return U, mu

    def _measured(self, U: np.ndarray) -> np.ndarray:
        return np.array([goal.value(U) for goal in self.goals])

    def _misses(self, values: np.ndarray) -> np.ndarray:
        return (values - self._target) / self._unit

    def _worst_that_can_move(self, values: np.ndarray) -> float:
        return float(np.abs(self._misses(values)[self._power > 0.0]).max(initial=0.0))

    def _measured_slopes(self) -> np.ndarray:
        """How fast each goal (rows) changes along each direction (columns)."""
        slopes = [vectors.dots(self._y, g) for g in self.g]
        return np.array(slopes).reshape(2 * (len(self.goals),))

    def _newton_step(self, values: np.ndarray) -> np.ndarray:
        """How far to go along each direction; goals that ask for the same are met as well as they can be."""
        missing = self._target - values
        step = np.zeros(len(self.goals))
        movable = np.flatnonzero(self._power > 0.0)
        scale = np.sqrt(self._power[movable])
        slopes = self._slopes[np.ix_(movable, movable)] / np.outer(scale, scale)
        step[movable] = np.linalg.lstsq(slopes, missing[movable] / scale, rcond=1e-4)[0] / scale
        return step
