"""A fine surface that follows a coarse one, which may follow a coarser one, and is finished by itself."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.solve_mesh import FEWEST, RestShape
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.decimation import Thinning
from apd_viewer.geometry.solver.coarse_level import Coarse
from apd_viewer.geometry.solver.coarse_preview import Preview
from apd_viewer.geometry.solver.constrained_descent import WORTH_WHILE, Constrained
from apd_viewer.geometry.solver.goals import Goal

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
    vertices = elastic.rest.thinning.vertices
    helps = _thin(elastic.rest) and np.isin(vertices, elastic.free).sum() > FEWEST / 2
    return (kind or Guided if helps else Constrained)(elastic, goals, worth_while)


def _roughly(elastic: Elastic, goals: tuple[Goal, ...]) -> Constrained:
    return guided(elastic, goals, _ROUGHLY)


def make_ready(rest: RestMesh) -> tuple[Thinning, ...]:
    """Find what every deformation of a mesh will need, whatever is held, and what takes longest: it is kept.

    With these thinnings another :class:`RestMesh` of the mesh need not find them.
    """
    shape, found = rest.shape, []
    with cores_for(len(shape.V)):
        while len(shape.V) >= _ALONE:
            found.append(shape.thinning)
            if not _thin(shape):
                break
            shape = shape.thinner
    return tuple(found)


def _thin(rest: RestShape) -> bool:
    """Whether the thinner mesh is thin enough to be of use."""
    return len(rest.thinning.vertices) < len(rest.V) / 2


class Guided(Constrained):
    """Iterations that first follow a coarse copy, until that has settled, and then descend.

    Every one ends where the goals are met, with the held vertices where they were put, just as without.

    Where the matrix is factored elsewhere, the surface is a large one, and a global step takes longer than
    a hand likes to wait. Then previews are shown until the coarse surface has settled and the factor is
    there.
    """

    def __init__(
        self, elastic: Elastic, goals: tuple[Goal, ...] = (), worth_while: float = WORTH_WHILE
    ) -> None:
        self._coarse = Coarse(elastic, goals, _roughly)
        self._leap = 1 if self._coarse.is_guided else _LEAP
        self._preview: Preview | None = None
        super().__init__(elastic, goals, worth_while)

    @property
    def U(self) -> np.ndarray:
        """The shape to show, (n, 3) float array."""
        return self._preview.U if self._preview else self._elastic.U

    @property
    def values(self) -> np.ndarray:
        """What the goals measure at ``U``, (g,) float array."""
        return self._preview.values if self._preview else super().values

    @property
    def met(self) -> bool:
        """Whether all goals are met at ``U``."""
        return self._preview.met if self._preview else super().met

    @property
    def energy(self) -> float | None:
        """The energy of ``U``; None if it is not known."""
        return None if self._preview else super().energy

    @property
    def hides(self) -> bool:
        """Whether ``U`` is not the shape that is iterated."""
        return self._preview is not None

    @property
    def ready(self) -> bool:
        """Whether an iteration has nothing to wait for."""
        return (self._previews and not self._coarse.settled) or super().ready

    @property
    def exhausted(self) -> bool:
        """Whether going on would gain next to nothing."""
        return self._coarse.settled and not self._previews and super().exhausted

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""
        self._preview = None
        self._coarse.keep(goals)
        super().keep(goals)

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self._preview = None
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
        """Hold the fixed vertices at ``targets`` (k + s, 3) from now on, and draw the soft ones there."""
        self._coarse.aim(targets)
        super().aim(targets)

    def _hope_again(self) -> None:
        self._ahead = 1
        self._previews = self._elastic.factor.elsewhere
        super()._hope_again()

    def descend(self) -> None:
        """Turn as the coarse surface has turned; once that is settled, go downhill."""
        if self._previews and not (self._coarse.settled and super().ready):
            self._go_ahead()
            self._preview = self._preview or Preview(self._elastic, self._coarse, self.goals)
            self._preview.follow(self.held)
        elif self._previews:
            self._take_over()
        elif self._coarse.settled or self.stuck:
            super().descend()
        else:
            self._go_ahead()
            self._elastic.turn(self._coarse.turns())
            self.iterate()

    def _go_ahead(self) -> None:
        self._coarse.go_on(self._leap * self._ahead)
        self._ahead = min(2 * self._ahead, _FARTHEST)

    def _take_over(self) -> None:
        """Iterate from where the previews have led."""
        self._elastic.turn(self._coarse.turns())
        if self._preview is not None:
            self._elastic.U, self._preview = self._preview.U, None
        self._previews = False
        self.iterate()
