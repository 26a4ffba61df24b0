"""Goals met exactly, at every iteration, with the held vertices where they were put.

The energy is minimised subject to ``c(U) = 0``, the misses of the goals. With g the gradients of the
goals and the multipliers so far put into the right-hand side, one global step gives p; from there the
goals are met along directions y that need not be made anew for every iteration:

    p = K^-1 (b + mult g),   y = K^-1 g,   U = p + mu y  with  c(U) = 0,   mult += mu.

Where nothing changes any more mu is zero, and ``K U = b + mult g`` is the condition of Karush, Kuhn and
Tucker. Without goals this is the plain iteration.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry import vectors
from apd_viewer.geometry.elastic import Elastic
from apd_viewer.geometry.goals import Goal

# Relative to the value at rest; one order better than is promised.
MET = 1e-10
_NEWTON_STEPS = 8
# The directions y age as the shape turns: made anew after so many iterations, or once a goal moves only
# half as much along its direction as it did.
_REFRESH = 10
_FADED = 0.5
# The gradients lag one iteration behind: beyond this multiplier a whole step would overshoot.
_STEADY = 0.5
# What it takes to meet the goals far from rest says little about the end; and goals that nearly contradict
# each other would press against each other without end.
_RUSH = 0.5
_STRONGEST = 2.0
_SHORTER = (1.0, 0.25, 0.0625)
# Goals out of reach are given up once so many iterations have not brought them a hundredth nearer.
_PATIENCE = 60
_NEARER = 0.99


class Constrained:
    """Iterations of an elastic surface, each ending where the goals are met.

    Parameters
    ----------
    elastic : Elastic
    goals : tuple of Goal

    Attributes
    ----------
    held : (k, 3) float array
        Positions of the held vertices.
    values : (g,) float array
        What the goals measure at ``U``.
    stuck : bool
        Whether the goals have been given up; ``U`` is then the best shape that was found, and stays.
    """

    def __init__(self, elastic: Elastic, goals: tuple[Goal, ...] = ()) -> None:
        self._elastic = elastic
        self.goals: tuple[Goal, ...] = ()
        self._mult = np.zeros(0)
        self.keep(goals)

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self._elastic.U

    @property
    def met(self) -> bool:
        """Whether all goals are met at ``U``."""
        return self._worst(self.values) <= MET

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""
        if [goal.measured for goal in goals] != [goal.measured for goal in self.goals]:
            self._mult = np.zeros(len(goals))
        self.goals = goals
        self._g = np.zeros((len(goals), *self.U.shape))
        self._y = np.zeros_like(self._g)
        self._start_over()

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self._elastic.restart(U)
        self._mult[:] = 0.0
        self._start_over()

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k, 3) from now on."""
        self.held = targets
        self._hope_again()

    def _start_over(self) -> None:
        self.values = self._evaluate(self.U)
        self._age = 0
        self._hope_again()

    def _hope_again(self) -> None:
        self._best = (np.inf, self.U)
        self._waited = 0
        self.stuck = False

    def iterate(self) -> None:
        """A global step that ends where the goals are met, then the local step."""
        if self.stuck:
            return
        if self._age % _REFRESH == 0:
            self._make_directions()
        self._age += 1
        elastic, held_before = self._elastic, self.met
        b = elastic.pull()
        vectors.add(b, self._mult, self._g)
        start, end = self.U, elastic.global_step(b, self.held)
        steady = 1.0 / max(1.0, _STEADY + self._pressure(self._mult))
        for shorter in _SHORTER if held_before else _SHORTER[:1]:
            share = shorter * steady
            U, mu = self._meet(end if share == 1.0 else self._part_of_the_way(start, end, share))
            if self._worst(self.values) <= MET:
                break
        self._mult += share * mu / max(1.0, self._pressure(mu) / _RUSH)
        self._mult /= max(1.0, self._pressure(self._mult) / _STRONGEST)
        elastic.local_step(U)
        self._judge()

    def _part_of_the_way(self, start: np.ndarray, end: np.ndarray, share: float) -> np.ndarray:
        U = start + share * (end - start)
        U[self._elastic.fixed] = self.held
        return U

    def _pressure(self, multipliers: np.ndarray) -> float:
        """How hard multipliers press: how fast their forces change with the shape, against K."""
        edge = np.sqrt(self._elastic.rest.vertex_areas.mean())
        each = [edge if goal.is_volume else 1.0 for goal in self.goals]
        return float(np.abs(multipliers) @ np.array(each)) if each else 0.0

    # Meeting the goals

    def _measure(self, U: np.ndarray) -> np.ndarray:
        """What the goals measure at ``U`` (n, 3), (g,) float array."""
        return np.array([goal.value(U) for goal in self.goals])

    def _evaluate(self, U: np.ndarray) -> np.ndarray:
        """The same; leaves their gradients."""
        both = zip(self.goals, self._g, strict=True)
        return np.array([goal.value_and_gradient(U, g) for goal, g in both])

    def _misses(self, values: np.ndarray) -> np.ndarray:
        return np.array([goal.miss(value) for goal, value in zip(self.goals, values, strict=True)])

    def _worst(self, values: np.ndarray) -> float:
        return float(np.abs(self._misses(values)).max(initial=0.0))

    def _make_directions(self) -> None:
        free = self._elastic.free
        for y, g in zip(self._y, self._g, strict=True):
            y[free] = self._elastic.solve(g[free])
        self._slopes = self._measure_slopes()
        self._power = np.diag(self._slopes).copy()

    def _measure_slopes(self) -> np.ndarray:
        """How fast each goal (rows) changes along each direction (columns)."""
        slopes = [vectors.dots(self._y, g) for g in self._g]
        return np.array(slopes).reshape(2 * (len(self.goals),))

    def _meet(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Newton's method from ``U`` along the directions; the positions and how far along each.

        Leaves values, gradients and slopes at the positions that it returns. On the way the slopes are
        corrected by what each step has brought [Broyden 1965]: values cost less than gradients.
        """
        mu = np.zeros(len(self.goals))
        values = self._measure(U)
        share = 1.0
        fresh = False  # whether gradients and directions are those of U
        for _ in range(_NEWTON_STEPS):
            worst = self._worst_that_can_move(values)
            if worst <= MET:
                break
            step = share * self._newton_step(values)
            there = U.copy()
            vectors.add(there, step, self._y)
            tried = self._measure(there)
            if self._worst_that_can_move(tried) < (1.0 - 0.1 * share) * worst:
                surprise = tried - values - self._slopes @ step
                self._slopes = self._slopes + np.outer(surprise, step) / (step @ step)
                U, values, mu, share, fresh = there, tried, mu + step, 1.0, False
            elif fresh:
                share *= 0.5
            else:
                self._evaluate(U)
                self._make_directions()
                fresh = True
        self.values = self._evaluate(U)
        self._slopes = self._measure_slopes()
        if (np.diag(self._slopes) < _FADED * self._power).any():
            self._age = 0
        return U, mu

    def _worst_that_can_move(self, values: np.ndarray) -> float:
        return float(np.abs(self._misses(values)[self._power > 0.0]).max(initial=0.0))

    def _newton_step(self, values: np.ndarray) -> np.ndarray:
        """How far to go along each direction; goals that ask for the same are met as well as they can be."""
        missing = np.array([goal.target - value for goal, value in zip(self.goals, values, strict=True)])
        step = np.zeros(len(self.goals))
        movable = np.flatnonzero(self._power > 0.0)
        scale = np.sqrt(self._power[movable])
        slopes = self._slopes[np.ix_(movable, movable)] / np.outer(scale, scale)
        step[movable] = np.linalg.lstsq(slopes, missing[movable] / scale, rcond=1e-4)[0] / scale
        return step

    def _judge(self) -> None:
        """Give the goals up once they have not come nearer for long."""
        worst = self._worst(self.values)
        if worst <= MET or worst < _NEARER * self._best[0]:
            self._best, self._waited = (worst, self.U), 0
            return
        self._waited += 1
        if self._waited >= _PATIENCE:
            self.stuck = True
            self._elastic.local_step(self._best[1])
            self.values = self._evaluate(self.U)
