"""Projection onto the goals by Newton's method along a few fixed directions.

With g the gradients of the goals c, the directions are ``y = K^-1 g``: the smoothest displacements that
change the goals. They may be those of earlier gradients, as long as the goals can be met along them.
"""

from typing import Protocol

import numpy as np

from apd_viewer.geometry.goals.goals import Goal, GoalMeasures
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.weighted_areas import row_nonzeros

# Tolerance of goals, relative to the rest value; ten times tighter than documented.
GOAL_TOLERANCE = 1e-10
_NEWTON_STEPS = 8
# Bound of the relative change of slopes per relative violation of the goals, measured as about 1.
_CURVED = 4.0
# Steps whose change is below this fraction of the expected one, or of opposite sign, do not update slopes.
_PLAUSIBLE = 0.1
# Growth of a goal's steps, relative to fresh directions, above which directions are recomputed.
_FADED = 2.0


class ElasticResponse(Protocol):
    """Interface of an elastic surface to a projection."""

    @property
    def U(self) -> np.ndarray:
        """Current positions, (n, 3) float array."""

    @property
    def free(self) -> np.ndarray:
        """Free vertices, (f,) int array."""

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Response of the free vertices to the forces ``b_f``, both (f, 3)."""


class GoalProjection:
    """Projection of the positions of an elastic surface onto its goals.

    Parameters
    ----------
    surface : ElasticResponse
    goals : tuple of Goal

    Attributes
    ----------
    values : (g,) float array
        Values of the goals at the last positions.
    g : (g, n, 3) float array
        Gradients of the goals at the last positions.
    """

    def __init__(self, surface: ElasticResponse, goals: tuple[Goal, ...]) -> None:
        self._elastic = surface
        self.goals = goals
        self._measures = GoalMeasures(goals)
        self._support = row_nonzeros(self._measures.support.reshape(len(surface.U), len(goals)))
        self._target = self._final = np.array([goal.target for goal in goals])
        self._unit = np.array([abs(goal.rest) for goal in goals])
        self.g = np.zeros((len(goals), *surface.U.shape))
        self._y = np.zeros_like(self.g)
        self._inverse = np.zeros((len(goals), len(goals)))
        self._inverse_at_first = self._inverse
        self._reach = np.full(len(goals), np.inf)
        self.evaluate(surface.U)

    @property
    def has_met_goals(self) -> bool:
        """True if all goals are met at the last positions."""
        return self.largest_violation <= GOAL_TOLERANCE

    @property
    def largest_violation(self) -> float:
        """Largest goal violation at the last positions, relative to rest."""
        return _largest_violation(self.values, self._target, self._unit)

    @property
    def is_at_targets(self) -> bool:
        """True if all goals are met, and none of them at an intermediate target."""
        return self._target is self._final and self.largest_violation <= GOAL_TOLERANCE

    def approach_targets(self, U: np.ndarray, most: float) -> None:
        """Set intermediate targets at most so far from ``U`` (n, 3), relative to rest."""
        self.evaluate(U)
        violation = _largest_violation(self.values, self._final, self._unit)
        between = self.values + most / max(violation, GOAL_TOLERANCE) * (self._final - self.values)
        self._target = self._final if violation <= most else between

    @property
    def has_outdated_directions(self) -> bool:
        """True if the step directions should be recomputed."""
        return _has_faded(self._inverse, self._inverse_at_first)

    def force_stiffness(self, multipliers: np.ndarray, edge: float) -> float:
        """Rate of change of the multipliers' forces with the shape, relative to K.

        Parameters
        ----------
        multipliers : (g,) float array
        edge : float
            Length of an edge.
        """
        return self._measures.force_stiffness(multipliers, edge)

    def evaluate(self, U: np.ndarray) -> None:
        """Compute the goals' values and gradients at ``U`` (n, 3)."""
        self.values = self._measures.values_and_gradients(U, self.g)

    def refresh_directions(self, U: np.ndarray) -> None:
        """Evaluate the goals at ``U`` (n, 3) and recompute their step directions."""
        self.evaluate(U)
        free = self._elastic.free
        for y, g in zip(self._y, self.g, strict=True):
            y[free] = self._elastic.solve(g[free])
        slopes = self._slopes()
        # A goal without free vertices cannot change, and is ignored.
        self._reach = np.where(np.diag(slopes) > 0.0, self._unit, np.inf)
        self._inverse = self._inverse_at_first = self._inverse_of(slopes)

    def _inverse_of(self, slopes: np.ndarray) -> np.ndarray:
        movable = np.flatnonzero(np.isfinite(self._reach))
        scale = np.sqrt(np.abs(np.diag(slopes)[movable]))
        scales, block = np.outer(scale, scale), np.ix_(movable, movable)
        inverse = np.zeros_like(slopes)
        # Dependent goals are met in the least-squares sense.
        inverse[block] = np.linalg.pinv(slopes[block] / scales, rcond=1e-4) / scales
        return inverse

    def _slopes(self) -> np.ndarray:
        """Slope of each goal (rows) along each direction (columns)."""
        return parallel_ops.inner_products(self.g, *self._support, self._y).reshape(len(self.g), len(self._y))

    def lagrangian_gradient(self, G: np.ndarray, multipliers: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Gradient ``G - sum_k mult_k g_k`` (f, 3), for ``G`` (f, 3) and ``g`` (g, n, 3)."""
        return parallel_ops.subtracted_rows(G, multipliers, g, *self._support, self._elastic.free)

    def multipliers(self, G: np.ndarray) -> np.ndarray:
        """Lagrange multipliers (g,) cancelling ``G`` (f, 3) along the directions."""
        along = parallel_ops.inner_products_at(self._y, self._elastic.free, G)
        slopes = self._slopes()
        if len(self.goals) > 1:  # Broyden updates corrected the slopes along one line only
            self._inverse = self._inverse_of(slopes)
        return np.linalg.lstsq(slopes.T, along, rcond=1e-10)[0]

    def energy_at_targets(self, energy: float, multipliers: np.ndarray) -> float:
        """Energy that the last positions would have if they met the goals exactly.

        Goals are met to a tolerance, which at the ``multipliers`` (g,) may be worth more than a step gains.
        """
        return energy + 4.0 * float(multipliers @ (self._target - self.values))

    def project(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions near ``U`` (n, 3) meeting the goals, and steps (g,) along directions.

        :attr:`values` are then those of the returned positions. Meanwhile the slopes are corrected by what
        each step has brought [Broyden 1965]: values cost less than gradients. Towards a single goal such a
        step leaves of a miss about as much as the product of the last two, and no less than slopes that are
        off in other directions can spoil; where that is nothing, the last step is not measured. Of several
        goals the slopes are known along the line of the last step alone, and a miss may stay as it was.
        """
        mu = np.zeros(len(self.goals))
        self.values = self._measures.values(U)
        worst = foreseen = self._largest_reachable_violation(self.values)
        fraction = 1.0
        fresh = False  # true once gradients and directions are those of U
        for _ in range(_NEWTON_STEPS):
            if worst <= GOAL_TOLERANCE or worst == np.inf:  # inf if a trial overshoots by far
                break
            missing = self._target - self.values
            step = fraction * (self._inverse @ missing)
            there = parallel_ops.plus_linear_combination(U, step, self._y)
            if foreseen <= GOAL_TOLERANCE:
                self.values = self.values + np.where(np.isfinite(self._reach), missing, 0.0)
                return there, mu + step
            tried = self._measures.values(there)
            left = self._largest_reachable_violation(tried)
            if left < (1.0 - 0.1 * fraction) * worst:
                self._inverse = _broyden_update(self._inverse, step, tried - self.values)
                foreseen = left * max(left / worst, _CURVED * worst) if len(mu) == 1 else left
                U, self.values, worst, mu, fraction, fresh = there, tried, left, mu + step, 1.0, False
            elif fresh:
                fraction *= 0.5
            else:
                self.refresh_directions(U)
                fresh, foreseen = True, worst
        return U, mu

    def _largest_reachable_violation(self, values: np.ndarray) -> float:
        return _largest_violation(values, self._target, self._reach)


# Compiled although small: every iteration calls them several times.


@njit(cache=True, nogil=True)
def _broyden_update(inverse: np.ndarray, step: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Broyden update of the inverse slopes by a ``step`` and its ``change``."""
    g = len(step)
    expected, pulled = np.zeros(g), np.zeros(g)
    for i in range(g):
        for j in range(g):
            expected[i] += inverse[i, j] * change[j]
            pulled[j] += step[i] * inverse[i, j]
    along = (step * expected).sum()
    if along <= _PLAUSIBLE * (step * step).sum():
        return inverse
    learned = np.empty_like(inverse)
    for i in range(g):
        for j in range(g):
            learned[i, j] = inverse[i, j] + (step[i] - expected[i]) / along * pulled[j]
    return learned


@njit(cache=True, nogil=True)
def _has_faded(inverse: np.ndarray, at_first: np.ndarray) -> bool:
    """True if a goal needs much larger steps than with fresh directions."""
    faded = False
    for i in range(len(inverse)):
        faded |= inverse[i, i] > _FADED * at_first[i, i]
    return faded


@njit(cache=True, nogil=True)
def _largest_violation(values: np.ndarray, targets: np.ndarray, units: np.ndarray) -> float:
    """Largest of ``|values - targets| / units``; infinite if any is NaN."""
    worst = 0.0
    for i in range(len(values)):
        miss = abs(values[i] - targets[i]) / units[i]
        if not miss <= worst:
            worst = miss if miss == miss else np.inf
    return worst
