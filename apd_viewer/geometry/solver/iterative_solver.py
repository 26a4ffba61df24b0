"""Protocols of the iterative solvers, for composing them."""

from typing import NamedTuple, Protocol

import numpy as np

from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium


class SolverProgress(NamedTuple):
    """Shape and readings of an iterative solver after a step.

    Attributes
    ----------
    U : (n, 3) float array
        The shape to show.
    held_positions : (k + s, 3) float array
        Positions of held vertices, then targets of soft ones.
    goal_values : (g,) float array
        Values of the goals at the iterated shape.
    has_met_goals : bool
        All goals are met there.
    is_iterate_hidden : bool
        ``U`` is not the iterated shape.
    stuck : bool
        The goals are given up; ``U`` is then the best shape, for good.
    converged : bool or None
        Further steps gain next to nothing; None if only lengths tell.
    may_rest : bool
        The shape is at rest after a step of rounding errors alone.
    convergence_ratio : float or None
        Measure of convergence in multiples of its tolerance; None while not known.
    seconds_left : float or None
        Expected seconds to convergence while a factor is made; None if not known.
    """

    U: np.ndarray
    held_positions: np.ndarray
    goal_values: np.ndarray
    has_met_goals: bool
    is_iterate_hidden: bool = False
    stuck: bool = False
    converged: bool | None = None
    may_rest: bool = True
    convergence_ratio: float | None = None
    seconds_left: float | None = None


class IterativeSolver(Protocol):
    """Iterations of an elastic surface towards goals, with some vertices held."""

    @property
    def surface(self) -> HeldSurface:
        """Elastic surface that is deformed."""

    @property
    def progress(self) -> SolverProgress:
        """Current shape and readings."""

    @property
    def energy(self) -> float | None:
        """Energy of the displayed shape; None if unknown."""

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Surface in equilibrium, for the stability search; None without a descent."""

    def set_tolerance(self, tolerance: float) -> None:
        """Set the tolerance on the relative energy decrease over ten steps."""

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Replace the goals."""

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the target positions (k + s, 3) of the held and soft vertices."""

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""

    def step(self) -> None:
        """Do one iteration."""


class LevelSolver(IterativeSolver, Protocol):
    """Solver with shapes of all levels to save and restore."""

    @property
    def has_ended(self) -> bool:
        """True if converged, or stuck because goals cannot be met."""

    def shapes(self) -> list[np.ndarray]:
        """Shapes of all levels, from the finest to the coarsest."""

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""

    def smooth(self, iterations: int) -> None:
        """Iterate without a coarser level, to smooth the roughness due to its rotations."""
