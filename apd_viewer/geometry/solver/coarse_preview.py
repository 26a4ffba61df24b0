"""Previews of a fine surface that waits for its factor, and its expected end."""

from __future__ import annotations

import time

import numpy as np

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goal_projection import GoalProjection
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.solver.coarse_level import CoarseLevel

# Seconds to factor grow with this power of the unknowns (nested dissection on surfaces), times what another
# process loses by the work of this one (1.1 to 1.4).
_FACTORING, _BESIDE = 1.5, 1.3
# The fine descent takes about 6 times the root of the coarse iterations (18 and 26 for 15, 25 for 22, 41 for
# 53, 66 for 69, 113 for 135, 58 for 298). The seconds of each grow with this power of the unknowns.
_DESCENT, _ITERATION = 6.0, 1.3


class CoarsePreview:
    """Shapes of a fine surface, moved along with a coarse one.

    They are not at rest, but held where they are asked to be, and they meet the goals, as all others do.

    Parameters
    ----------
    elastic : ElasticSurface
        The fine surface; it is not touched.
    coarse : CoarseLevel
    goals : tuple of Goal

    Attributes
    ----------
    free : (f,) int array
        Vertices that may move.
    U : (n, 3) float array
        The last shape.
    projection : GoalProjection
        Its goals.
    """

    def __init__(self, elastic: ElasticSurface, coarse: CoarseLevel, goals: tuple[Goal, ...]) -> None:
        self._elastic, self._coarse = elastic, coarse
        self.free = elastic.free
        self.U = elastic.U
        self.projection = GoalProjection(self, goals)
        self.projection.refresh_directions(self.U)

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Smooth response (f, 3) to forces ``b_f`` (f, 3), for meeting goals."""
        return self._coarse.response(b_f)

    def follow_coarse(self, targets: np.ndarray) -> None:
        """Follow the coarse surface, with the held vertices at ``targets`` (k, 3)."""
        U = self._coarse.prolonged_positions(targets)
        if self.projection.has_outdated_directions:
            self.projection.refresh_directions(U)
        self.U, _ = self.projection.project(U)


class PreviewForecast:
    """Expected convergence of a fine surface that waits for its factor.

    Parameters
    ----------
    elastic : ElasticSurface
        The fine surface.
    coarse : CoarseLevel
    """

    def __init__(self, elastic: ElasticSurface, coarse: CoarseLevel) -> None:
        self._elastic, self._coarse = elastic, coarse
        self.reset()

    @property
    def seconds_left(self) -> float | None:
        """Seconds until then; None while nothing is known."""
        return None if self._end is None else max(self._end - time.monotonic(), 0.0)

    @property
    def factor_seconds(self) -> float:
        """Expected seconds to factor the matrix of the fine surface in another process."""
        return _BESIDE * self._coarse.factor_seconds * self._coarse.refinement_ratio**_FACTORING

    @property
    def iterations(self) -> float:
        """Expected iterations of the fine surface, from those of the converged coarse one."""
        return _DESCENT * float(np.sqrt(self._coarse.steps))

    @property
    def descent_seconds(self) -> float:
        """Expected seconds of these iterations."""
        return (
            self.iterations * self._coarse.seconds_per_iteration * self._coarse.refinement_ratio**_ITERATION
        )

    def reset(self) -> None:
        """Expect nothing, as the targets have moved."""
        self._end: float | None = None
        self._began, self._done = 0.0, 0

    def expect_factor(self) -> None:
        """Expect the factor, and the iterations after it."""
        if self._coarse.converged:
            factoring = self.factor_seconds - self._elastic.factor.seconds
            self._end = time.monotonic() + max(factoring, 0.0) + self.descent_seconds

    def begin_descent(self) -> None:
        """The first iteration begins."""
        self._began = time.monotonic()

    def count_iteration(self) -> None:
        """Expect the other iterations at the pace of those so far."""
        if self._end is not None:
            self._done += 1
            now = time.monotonic()
            self._end = now + max(self.iterations - self._done, 0.0) * (now - self._began) / self._done
