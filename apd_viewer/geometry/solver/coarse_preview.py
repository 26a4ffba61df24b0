"""Preview of a fine surface before its first global step."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.goals.goal_projection import Projection
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.solver.coarse_level import CoarseLevel


class Preview:
    """Shapes of a fine surface, moved along with a coarse one.

    They are not at rest, but held where they are asked to be, and they meet the goals, as all others do.

    Parameters
    ----------
    elastic : Elastic
        The fine surface; it is not touched.
    coarse : CoarseLevel
    goals : tuple of Goal

    Attributes
    ----------
    free : (f,) int array
        Vertices that may move.
    U : (n, 3) float array
        The last shape.
    """

    def __init__(self, elastic: Elastic, coarse: CoarseLevel, goals: tuple[Goal, ...]) -> None:
        self._elastic, self._coarse = elastic, coarse
        self.free = elastic.free
        self.U = elastic.U
        self._projection = Projection(self, goals)
        self._projection.refresh(self.U)

    @property
    def values(self) -> np.ndarray:
        """Values of the goals at ``U``, (g,) float array."""
        return self._projection.values

    @property
    def met(self) -> bool:
        """True if all goals are met at ``U``."""
        return self._projection.met

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Smooth response (f, 3) to forces ``b_f`` (f, 3), for meeting goals."""
        return self._coarse.give_way(b_f)

    def follow(self, targets: np.ndarray) -> None:
        """Follow the coarse surface, with the held vertices at ``targets`` (k, 3)."""
        U = self._coarse.carried(self._elastic.U)
        U[self._elastic.fixed] = targets[: len(self._elastic.fixed)]
        if self._projection.worn:
            self._projection.refresh(U)
        self.U, _ = self._projection.onto(U)
