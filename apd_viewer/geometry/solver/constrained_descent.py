"""Goals met exactly, at every iteration, with the held vertices where they were put.

The energy is minimised subject to ``c(U) = 0``, the misses of the goals. With g the gradients of the
goals and the multipliers so far put into the right-hand side, one global step gives p; from there the
goals are met along directions y that need not be made anew for every iteration:

    p = K^-1 (b + mult g),   y = K^-1 g,   U = p + mu y  with  c(U) = 0,   mult += mu.

Where nothing changes any more mu is zero, and ``K U = b + mult g`` is the condition of Karush, Kuhn and
Tucker. Without goals this is the plain iteration.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numba import njit

from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.solver.descent import Descent
from apd_viewer.geometry.solver.goal_projection import MET, Projection
from apd_viewer.geometry.solver.goals import Goal

# The directions y age as the shape turns: made anew after so many iterations.
_REFRESH = 100
# The gradients lag up to so many iterations behind, unless multipliers press harder than that.
_LAG = 8
_CALM = 0.1
# They lag one behind in any case: beyond this multiplier a whole step would overshoot.
_STEADY = 0.5
# What it takes to meet the goals far from rest says little about the end; and goals that nearly contradict
# each other would press against each other without end.
_RUSH = 0.5
_STRONGEST = 2.0
_SHORTER = (1.0, 0.25, 0.0625)
# Goals out of reach are given up once so many iterations have not brought them a hundredth nearer.
_PATIENCE = 60
_NEARER = 0.99
# Over so many steps a descent is judged, and ended where they have taken no more of the energy away.
_WINDOW = 10
WORTH_WHILE = 1e-7


class Constrained:
    """Iterations of an elastic surface, each ending where the goals are met.

    Parameters
    ----------
    elastic : Elastic
    goals : tuple of Goal
    worth_while : float
        A descent is at its end once ten steps have taken no more than this part of the energy away.

    Attributes
    ----------
    held : (k + s, 3) float array
        Positions of the held vertices, and where the soft ones are drawn to.
    stuck : bool
        Whether the goals have been given up; ``U`` is then the best shape that was found, and stays.
    """

    def __init__(
        self, elastic: Elastic, goals: tuple[Goal, ...] = (), worth_while: float = WORTH_WHILE
    ) -> None:
        self._elastic = elastic
        self._worth_while = worth_while
        self.goals: tuple[Goal, ...] = ()
        self._mult = np.zeros(0)
        self.keep(goals)

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self._elastic.U

    @property
    def ready(self) -> bool:
        """Whether an iteration has nothing to wait for."""
        return self._elastic.factor.ready

    @property
    def values(self) -> np.ndarray:
        """What the goals measure at ``U``, (g,) float array."""
        return self._projection.values

    @property
    def met(self) -> bool:
        """Whether all goals are met at ``U``."""
        return self._projection.met

    @property
    def energy(self) -> float | None:
        """The energy of ``U``; None if it is not known."""
        return self._descent.energy if self._descent else self._elastic.energy

    @property
    def hides(self) -> bool:
        """Whether ``U`` is not the shape that is iterated."""
        return False

    @property
    def exhausted(self) -> bool:
        """Whether descending further would gain next to nothing."""
        return self._bottom or self._gained_at_most(self._worth_while)

    def _gained_at_most(self, part: float) -> bool:
        """Whether the last steps together have taken no more than this part of the energy away."""
        E = self._energies
        return len(E) > _WINDOW and E[0] - E[-1] <= part * E[-1]

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""
        if [goal.measured for goal in goals] != [goal.measured for goal in self.goals]:
            self._mult = np.zeros(len(goals))
        self.goals = goals
        edge = np.sqrt(self._elastic.rest.vertex_areas.mean())
        self._grip = np.array([edge if goal.is_volume else 1.0 for goal in goals])
        self._projection = Projection(self._elastic, goals)
        self._start_over()

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self._elastic.restart(U)
        self._projection.evaluate(U)
        self._mult = np.zeros(len(self.goals))
        self._start_over()

    def shapes(self) -> list[np.ndarray]:
        """The current shape, and those of coarser surfaces that it follows."""
        return [self._elastic.U]

    def put_back(self, shapes: list[np.ndarray]) -> None:
        """Continue from where :meth:`shapes` was asked."""
        self.restart(shapes[0])

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k + s, 3) from now on, and draw the soft ones there."""
        self.held = targets
        self._hope_again()

    def _start_over(self) -> None:
        self._age = 0
        self._hope_again()

    def _hope_again(self) -> None:
        self._nearest = (np.inf, self._elastic.U)
        self._waited = 0
        self.stuck = False
        self._descent: Descent | None = None
        self._energies: deque[float] = deque(maxlen=_WINDOW + 1)
        self._bottom = False
        self._lag = 0

    def descend(self) -> None:
        """Go downhill in energy while the goals stay met; until they are, a plain iteration.

        The first iteration after the held vertices have moved is always a plain one.
        """
        if self._descent is None:
            self.iterate()
            if self.met and not self.stuck:
                self._descent = Descent(self._elastic, self._projection)
        else:
            self._bottom = not self._descent.step(self.held)
            self._mult = self._descent.multipliers
            self._energies.append(self._descent.energy)

    def iterate(self) -> None:
        """A global step that ends where the goals are met, then the local step."""
        if self.stuck:
            return
        elastic, projection = self._elastic, self._projection
        if not self.goals:
            elastic.iterate(self.held)
            return
        held_before, pressure = self.met, _pressure(self._mult, self._grip)
        if self._age % _REFRESH == 0 or projection.worn:
            projection.refresh(elastic.U)
            self._age = 0
        elif self._lag % _LAG == 0 or pressure > _CALM:
            projection.evaluate(elastic.U)
        self._age += 1
        self._lag += 1
        start, end = elastic.U, elastic.global_step(self.held, self._mult, projection.g)
        steady = 1.0 / max(1.0, _STEADY + pressure)
        for shorter in _SHORTER if held_before else _SHORTER[:1]:
            share = shorter * steady
            U, mu = projection.onto(end if share == 1.0 else self._part_of_the_way(start, end, share))
            if self.met:
                break
        self._mult = _taken_further(self._mult, mu, share, self._grip)
        elastic.local_step(U)
        self._judge()

    def _part_of_the_way(self, start: np.ndarray, end: np.ndarray, share: float) -> np.ndarray:
        U = start + share * (end - start)
        U[self._elastic.fixed] = self.held[: len(self._elastic.fixed)]
        return U

    def _judge(self) -> None:
        """Give the goals up once they have not come nearer for long."""
        worst = self._projection.worst
        if worst <= MET or worst < _NEARER * self._nearest[0]:
            self._nearest, self._waited = (worst, self._elastic.U), 0
            return
        self._waited += 1
        if self._waited >= _PATIENCE:
            self.stuck = True
            self._elastic.local_step(self._nearest[1])
            self._projection.evaluate(self._elastic.U)


# Kernels, small as they are: every iteration asks for them.


@njit(cache=True, nogil=True)
def _pressure(mult: np.ndarray, grip: np.ndarray) -> float:
    """How hard multipliers press: how fast their forces change with the shape, against K."""
    return (np.abs(mult) * grip).sum()


@njit(cache=True, nogil=True)
def _taken_further(mult: np.ndarray, mu: np.ndarray, share: float, grip: np.ndarray) -> np.ndarray:
    """The multipliers and a share of what the last step adds to them, neither more than is good."""
    mult = mult + share * mu / max(1.0, _pressure(mu, grip) / _RUSH)
    return mult / max(1.0, _pressure(mult, grip) / _STRONGEST)
