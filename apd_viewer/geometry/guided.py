"""A fine surface that follows a coarse one, which may follow a coarser one, and is finished by itself."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.coarse import Coarse
from apd_viewer.geometry.constrained import WORTH_WHILE, Constrained
from apd_viewer.geometry.cores import cores_for
from apd_viewer.geometry.elastic import Elastic
from apd_viewer.geometry.goals import Goal
from apd_viewer.geometry.rest_mesh import RestMesh
from apd_viewer.geometry.rest_shape import FEWEST, RestShape

# Below so many free vertices a surface finds its way as soon alone.
_ALONE = 4 * FEWEST
# How far a coarse surface is to be iterated: what it leaves, the finer one sees better.
_ROUGHLY = 1e-4
# Iterations of the coarsest surface for one of the next, which takes as long as they.
_LEAP = 16
# A coarse surface goes further ahead from iteration to iteration: the first is for a hand that moves on.
_FARTHEST = 8


def guided(
    elastic: Elastic,
    goals: tuple[Goal, ...],
    worth_while: float = WORTH_WHILE,
    kind: type[Guided] | None = None,
) -> Constrained:
    """Iterations of a surface that follow a coarse one, if it is fine enough to gain by that."""
    if len(elastic.free) < _ALONE:
        return Constrained(elastic, goals, worth_while)
    # Thousands of loose triangles cannot be thinned, and what is held may leave the thin mesh no freedom.
    vertices = elastic.rest.thinner.vertices
    helps = _thin(elastic.rest) and np.isin(vertices, elastic.free).sum() > FEWEST / 2
    return (kind or Guided if helps else Constrained)(elastic, goals, worth_while)


def _roughly(elastic: Elastic, goals: tuple[Goal, ...]) -> Constrained:
    return guided(elastic, goals, _ROUGHLY)


def make_ready(rest: RestMesh) -> None:
    """Find what every deformation of a mesh will need, whatever is held; it is kept."""
    shape = rest.shape
    with cores_for(len(shape.V)):
        while len(shape.V) >= _ALONE and _thin(shape):
            shape = shape.thinner.shape


def _thin(rest: RestShape) -> bool:
    """Whether the thinner mesh is thin enough to be of use."""
    return len(rest.thinner.vertices) < len(rest.V) / 2


class Guided(Constrained):
    """Iterations that first follow a coarse copy, until that has settled, and then descend.

    Every one ends where the goals are met, with the held vertices where they were put, just as without.
    """

    def __init__(
        self, elastic: Elastic, goals: tuple[Goal, ...] = (), worth_while: float = WORTH_WHILE
    ) -> None:
        self._coarse = Coarse(elastic, goals, _roughly)
        self._leap = 1 if self._coarse.is_guided else _LEAP
        super().__init__(elastic, goals, worth_while)

    @property
    def exhausted(self) -> bool:
        """Whether going on would gain next to nothing."""
        return self._coarse.settled and super().exhausted

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""
        self._coarse.keep(goals)
        super().keep(goals)

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self._coarse.restart(U)
        super().restart(U)

    def shapes(self) -> list[np.ndarray]:
        """The current shape, and those of the coarser surfaces."""
        return [*super().shapes(), *self._coarse.shapes()]

    def put_back(self, shapes: list[np.ndarray]) -> None:
        """Continue from where :meth:`shapes` was asked."""
        Constrained.restart(self, shapes[0])
        self._coarse.put_back(shapes[1:])

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k, 3) from now on."""
        self._coarse.aim(targets)
        super().aim(targets)

    def _hope_again(self) -> None:
        self._ahead = 1
        super()._hope_again()

    def descend(self) -> None:
        """Turn as the coarse surface has turned; once that is settled, go downhill."""
        if self._coarse.settled or self.stuck:
            super().descend()
        else:
            self._elastic.turn(self._coarse.turns(self._leap * self._ahead))
            self.iterate()
            self._ahead = min(2 * self._ahead, _FARTHEST)
