"""Protocols of the solvers, for solvers composed of others."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goals import Goal


class IterativeSolver(Protocol):
    """Iterations of an elastic surface towards goals, with some vertices held.

    Attributes
    ----------
    elastic : ElasticSurface
        The surface that is iterated.
    """

    elastic: ElasticSurface

    @property
    def U(self) -> np.ndarray:
        """The shape to show, (n, 3) float array."""

    @property
    def held_positions(self) -> np.ndarray:
        """Positions of held vertices, then targets of soft ones, (k + s, 3)."""

    @property
    def goal_values(self) -> np.ndarray:
        """Values of the goals at ``U``, (g,) float array."""

    @property
    def has_met_goals(self) -> bool:
        """True if all goals are met at ``U``."""

    @property
    def energy(self) -> float | None:
        """The energy of ``U``; None if it is not known."""

    @property
    def is_iterate_hidden(self) -> bool:
        """True if ``U`` is not the iterated shape."""

    @property
    def ready(self) -> bool:
        """True if a step has nothing to wait for, such as a factor."""

    @property
    def stuck(self) -> bool:
        """True once the goals are given up; ``U`` is then the best shape, for good."""

    @property
    def converged(self) -> bool | None:
        """True if further steps gain next to nothing; None if only lengths tell."""

    @property
    def convergence_ratio(self) -> float | None:
        """Measure of convergence in multiples of its tolerance; None while not known."""

    @property
    def seconds_left(self) -> float | None:
        """Expected seconds to convergence while a factor is made; None if not known."""

    def set_tolerance(self, tolerance: float) -> None:
        """Converge once ten steps together reduce the energy by at most this part."""

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""

    def aim(self, targets: np.ndarray) -> None:
        """Hold and draw vertices at ``targets`` (k + s, 3) from now on."""

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""

    def step(self) -> None:
        """Do one iteration."""


class LevelSolver(IterativeSolver, Protocol):
    """Solver with shapes, down to the coarsest level, to save and restore."""

    def shapes(self) -> list[np.ndarray]:
        """Iterated shape, then those of the coarser levels."""

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""

    def smooth(self, iterations: int) -> None:
        """Iterate without a coarser level: its rotations leave a stiff surface rough."""
