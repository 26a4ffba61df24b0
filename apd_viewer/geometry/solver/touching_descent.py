"""Descent of a surface in contact with itself, along a path.

The held vertices go in short parts, as far as the way is free, and the free ones follow by the response of
the surface. Between two parts the surface descends with its gap energy.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from apd_viewer.geometry.goals.goal_projection import GOAL_TOLERANCE
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.pose.held_path import HeldPath
from apd_viewer.geometry.solver.constrained_descent import ENERGY_TOLERANCE
from apd_viewer.geometry.solver.iterative_solver import SolverProgress
from apd_viewer.geometry.solver.quasi_newton import QuasiNewton
from apd_viewer.geometry.solver.touching_surface import CollisionFreeProjection, TouchingSurface

# Lengths of parts, in sizes of the mesh: the first, the longest, and what is no part any more.
_FIRST, _LONGEST, _NONE = 2e-3, 8e-3, 1e-4
# A part that is refused is tried with less, so many times; the next one is longer.
_TRIES, _LESS, _MORE = 6, 0.4, 1.4
# Steps between two parts, as many as bring more than this part of the energy: a shape that has not followed
# would be wound up.
_LEAST_STEPS, _MOST_STEPS, _FOLLOWS = 4, 40, 1e-3
# The path ends where so many parts together bring the held vertices no farther.
_PATIENCE = 12
# Convergence is judged over so many steps.
_WINDOW = 10
# Where much is in the way, about as long a step as the last is what can be gone.
_GROWTH = 1.6
# Largest way of a disturbance, in sizes of the mesh: a tenth of the distance that walls keep by default.
_DISTURBED, _SEED = 1e-4, 0
# Loads on a mesh that nothing holds cancel out up to this part of their sum; so many more steps are spent.
_BALANCED, _MORE_STEPS = 2e-3, 300


class TouchingDescent:
    """Steps of a surface in contact with itself.

    Parameters
    ----------
    surface : TouchingSurface
    U : (n, 3) float array
        Where it begins; contact stands there.
    held_positions : (k + s, 3) float array
        Positions of the held vertices there, and targets of the soft ones.
    goals : tuple of Goal
    tolerance : float
        Converged once ten steps together reduce the energy by at most this part of it.

    Attributes
    ----------
    held_positions : (k + s, 3) float array
        Positions that the held vertices have reached.
    share : float
        Of the path, as far as it has been gone.
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
        surface.elastic.restart(U)
        surface.local_step(U)
        self._projection = CollisionFreeProjection(surface, goals)
        self._projection.refresh_directions(U)
        self._quasi_newton = QuasiNewton(surface, self._projection, _GROWTH)
        self._size = float(np.linalg.norm(np.ptp(surface.rest.V, axis=0)))
        self.share, self._steps = 1.0, 0
        self._begin_to_converge()

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self._surface.U

    @property
    def progress(self) -> SolverProgress:
        """Current shape and readings; hidden after a step that only tried to go on.

        It is stuck where no free way leads to shapes that meet the goals.
        """
        return SolverProgress(
            self.U,
            self.held_positions,
            self._projection.values,
            self.has_met_goals,
            is_iterate_hidden=self._steps == 0,
            stuck=self._at_minimum and not self.has_met_goals and not self.is_on_its_way,
            converged=self.converged,
            convergence_ratio=self.convergence_ratio,
        )

    @property
    def has_met_goals(self) -> bool:
        """True if all goals are met at ``U``."""
        return self._projection.largest_miss <= GOAL_TOLERANCE

    @property
    def is_stopped(self) -> bool:
        """True if contact lets the held vertices go no farther."""
        return self.share < 1.0 and self._waited >= _PATIENCE

    @property
    def is_on_its_way(self) -> bool:
        """True while the held vertices have part of their path ahead."""
        return self.share < 1.0 and not self.is_stopped

    @property
    def converged(self) -> bool:
        """True if the path has ended, and further steps would gain next to nothing.

        Where nothing is held, loads have to cancel out, too.
        """
        if self.is_on_its_way:
            return False
        return self._gains_little and (self._unbalanced > _MORE_STEPS or self.load_imbalance <= _BALANCED)

    @property
    def _gains_little(self) -> bool:
        return self._at_minimum or (self.convergence_ratio is not None and self.convergence_ratio <= 1.0)

    @property
    def load_imbalance(self) -> float:
        """Length of the sum of all loads on obstacles, in the sum of their lengths.

        0 where something is held, which takes the rest.
        """
        contact = self._surface.contact
        if len(self._surface.elastic.fixed) or not contact.obstacles:
            return 0.0
        contact.gradient(self.U)
        total = float(np.linalg.norm(contact.loads, axis=1).sum())
        return float(np.linalg.norm(contact.loads.sum(axis=0))) / total if total else 0.0

    @property
    def convergence_ratio(self) -> float | None:
        """Gain of the last steps in multiples of its tolerance; None before them."""
        E = self._energies
        return float(E[0] - E[-1]) / (self.tolerance * float(E[-1])) if len(E) > _WINDOW else None

    def follow_path(self, path: HeldPath, share: float) -> None:
        """Follow ``path`` from ``share``, the present place of the held vertices."""
        self._path, self.share = path, share
        part = self._size / max(path.length, _NONE * self._size)
        self._part, self._longest, self._no_part = _FIRST * part, _LONGEST * part, _NONE * part
        self._steps, self._waited, self._mark = 0, 0, share
        self._begin_to_converge()
        self._quasi_newton.resume()

    def _begin_to_converge(self) -> None:
        self._energies: deque[float] = deque(maxlen=_WINDOW + 1)
        self._at_minimum, self._unbalanced = False, 0

    def step(self) -> None:
        """Advance the held vertices if due, or reduce the energy."""
        if self.is_on_its_way and self._has_followed:
            self._walk()
            return
        self._steps += 1
        if self._surface.renew_springs():
            # The directions of the goals yield to what touches, too: otherwise each step pushes against it.
            self._projection.refresh_directions(self.U)
            self._quasi_newton.resume()
        self._at_minimum = not self._quasi_newton.step(self.held_positions)
        self._surface.contact.accept_shape(self.U)
        self._energies.append(self._quasi_newton.energy)
        self._unbalanced = self._unbalanced + 1 if self._gains_little else 0

    @property
    def _has_followed(self) -> bool:
        """True if the shape has come to where the held vertices are, by and large."""
        E = self._energies
        slow = len(E) > 1 and E[-2] - E[-1] <= _FOLLOWS * E[-1]
        return self._steps >= _MOST_STEPS or (self._steps >= _LEAST_STEPS and slow)

    def _walk(self) -> None:
        """Go the next part of the path, or as much of it as is free."""
        self._steps = 0
        for _ in range(_TRIES):
            share = min(1.0, self.share + self._part)
            if self._goes_to(share):
                self.share = share
                self._part = min(self._longest, _MORE * self._part)
                break
            self._part = max(_LESS * self._part, self._no_part)
        if self.share - self._mark > _PATIENCE * self._no_part:
            self._mark, self._waited = self.share, 0
        self._waited += 1
        self._begin_to_converge()
        self._quasi_newton.resume()

    def _goes_to(self, share: float) -> bool:
        """Move held vertices and obstacles, the free ones following; False if refused."""
        surface, projection, start = self._surface, self._projection, self._surface.U
        held = self._path.positions_at(share)
        surface.contact.aim_obstacles(self._path.shifts_at(share))
        if not self._moves_to(
            surface.all_positions(surface.following_positions(self.held_positions, held), held)
        ):
            surface.contact.aim_obstacles(self._path.shifts_at(self.share))
            projection.evaluate(start)
            return False
        self.held_positions = held
        return True

    def disturb_shape(self) -> None:
        """Move the free vertices a little, if that is free, always in the same manner.

        A wall that is pressed evenly would stay straight beyond the load at which it buckles: nothing would
        tell it to which side. So it gives to small random forces as its stiffness has it, most where it is
        about to buckle.
        """
        start = self._surface.U
        way = self._surface.solve(np.random.default_rng(_SEED).normal(size=(len(self._surface.free), 3)))
        way *= _DISTURBED * self._size / np.abs(way).max()
        if not self._moves_to(
            self._surface.all_positions(start[self._surface.free] + way, self.held_positions)
        ):
            self._projection.evaluate(start)
        self._quasi_newton.resume()

    def _moves_to(self, W: np.ndarray) -> bool:
        """Move to what is near ``W`` (n, 3) and meets the goals; False if refused."""
        W, _ = self._projection.project(W)
        if not self._projection.has_met_goals:
            return False
        self._surface.local_step(W)
        self._surface.contact.accept_shape(W)
        return True
