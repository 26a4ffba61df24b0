"""Protocols of the solvers, so that one can hold another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.energy.elastic import Elastic
    from apd_viewer.geometry.solver.goals import Goal


class IterativeSolver(Protocol):
    """Iterations of an elastic surface towards goals, with some vertices held.

    Attributes
    ----------
    elastic : Elastic
        The surface that is iterated.
    """

    elastic: Elastic

    @property
    def U(self) -> np.ndarray:
        """The shape to show, (n, 3) float array."""

    @property
    def held(self) -> np.ndarray:
        """Positions of the held vertices, then the targets of the soft ones, (k + s, 3) float array."""

    @property
    def values(self) -> np.ndarray:
        """Values of the goals at ``U``, (g,) float array."""

    @property
    def met(self) -> bool:
        """Whether all goals are met at ``U``."""

    @property
    def energy(self) -> float | None:
        """The energy of ``U``; None if it is not known."""

    @property
    def hides(self) -> bool:
        """Whether ``U`` is not the shape that is iterated."""

    @property
    def ready(self) -> bool:
        """Whether a step has nothing to wait for, such as a factor."""

    @property
    def stuck(self) -> bool:
        """Whether the goals have been given up; ``U`` is then the best shape found, and stays."""

    @property
    def converged(self) -> bool | None:
        """Whether further steps would gain next to nothing; None if only their lengths can tell."""

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k + s, 3) from now on, and draw the soft ones there."""

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""

    def step(self) -> None:
        """Do one iteration."""


class Level(IterativeSolver, Protocol):
    """A solver whose shapes, down to the coarsest level, can be saved and restored."""

    def shapes(self) -> list[np.ndarray]:
        """The shape that is iterated, then those of the coarser levels."""

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""
