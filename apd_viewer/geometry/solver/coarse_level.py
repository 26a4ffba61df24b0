"""Coarse level of an elastic surface, to lead the fine one.

Low frequencies take iterations by the hundred on a fine mesh, and next to nothing on a coarse one. What is
handed over are rotations: how far each place of the coarse surface has turned since the last time. The
global step of the fine surface then carries all frequencies at once, and its details turn with it. Where
there is no time for a global step, the coarse surface carries the fine one along.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import Goal, at_rest
from apd_viewer.geometry.linalg.quaternions import blended, difference
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.decimation import Thinning
from apd_viewer.geometry.solver.iterative_solver import Level
from apd_viewer.geometry.solver.prolongation import Prolongation

# A held vertex this many coarse edges from all held coarse vertices gets one of its own.
_UNHEARD = 1.5
# Seconds to factor grow with this power of the unknowns (nested dissection on surfaces).
_FACTORING = 1.5


class CoarseLevel:
    """Coarse surface with the material and the held vertices of the fine one.

    Its vertices are some of the fine one's, so that what is held needs no interpolation.

    Parameters
    ----------
    elastic : Elastic
        The fine surface.
    goals : tuple of Goal
    solver_of : callable
        Makes the solver of the coarse surface.

    Attributes
    ----------
    vertices : (c,) int array
        The vertices of the fine surface that it has.
    """

    def __init__(
        self,
        elastic: Elastic,
        goals: tuple[Goal, ...],
        solver_of: Callable[[Elastic, tuple[Goal, ...]], Level],
    ) -> None:
        rest, fixed = elastic.rest, elastic.fixed
        thinning = rest.thinning
        self.vertices = _with_held(rest, thinning, fixed)
        self.F = thinning.F
        unchanged = np.array_equal(self.vertices, thinning.vertices)
        self._shape = rest.thinner if unchanged else SolveMesh(rest.V[self.vertices], self.F)
        held = np.flatnonzero(np.isin(self.vertices, fixed))
        soft, own = elastic.soft, np.full(len(rest.V), -1)
        own[self.vertices] = np.arange(len(self.vertices))
        has = own[soft.ids] >= 0
        self._which = np.concatenate(
            [np.searchsorted(fixed, self.vertices[held]), len(fixed) + np.flatnonzero(has)]
        )
        drawn = soft.among(has)._replace(ids=own[soft.ids[has]])
        self._elastic = Elastic(self._shape, held, elastic.material, soft=drawn)
        self._solver = solver_of(self._elastic, self._own(goals))
        self._near, self._weight = thinning.near, thinning.weight
        self._fine, self._free, self._fixed = rest, elastic.free, fixed
        self._steps, self._pace = 0, 0.0
        self._set_reference()

    @property
    def converged(self) -> bool:
        """True if further iterations would show next to nothing."""
        return self._solver.stuck or bool(self._solver.converged)

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals of the fine surface, as far as a coarse one can."""
        self._solver.keep(self._own(goals))

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3) of the fine surface."""
        self._solver.restart(U[self.vertices])
        self._set_reference()

    def shapes(self) -> list[np.ndarray]:
        """The shape of this level, then those of the coarser ones."""
        return self._solver.shapes()

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""
        self._solver.restore(shapes)
        self._set_reference()

    def aim(self, targets: np.ndarray) -> None:
        """Hold and draw vertices at the fine surface's ``targets`` (k + s, 3)."""
        self._solver.aim(targets[self._which])
        self._steps = 0

    def iterate(self, iterations: int) -> None:
        """Do some iterations, or as many as it takes to converge."""
        with cores_for(len(self.vertices)):
            for _ in range(iterations):
                if self.converged:
                    break
                self._solver.step()
                self._steps += 1

    def smooth(self, iterations: int) -> None:
        """Do iterations without a coarser level, before the shape is shown."""
        begun = time.monotonic()
        with cores_for(len(self.vertices)):
            self._solver.smooth(iterations)
        self._pace = (time.monotonic() - begun) / iterations

    @property
    def fine_factor_seconds(self) -> float:
        """Expected seconds to factor the matrix of the fine surface."""
        return self._elastic.factor.seconds * self._growth**_FACTORING

    @property
    def fine_descent_seconds(self) -> float:
        """Expected seconds of the fine descent: as many iterations as here so far."""
        return self._steps * self._pace * self._growth

    @property
    def _growth(self) -> float:
        return len(self._free) / len(self._elastic.free)

    def turns(self) -> np.ndarray:
        """Rotations of the fine vertices since the last call, (n, 4) quaternions."""
        turns = blended(self._turned(), self._near, self._weight)
        self._set_reference()
        return turns

    def carried(self, U: np.ndarray) -> np.ndarray:
        """Positions ``U`` (n, 3) of the last :meth:`turns`, moved along since then."""
        moved = self._elastic.U - self._reference[1]
        return self._prolongation.carried(U, U[self.vertices], self._turned(), moved)

    def give_way(self, b: np.ndarray) -> np.ndarray:
        """Response of the free fine vertices to forces ``b``, both (f, 3).

        ``P K^-1 P^T b`` with K the coarse matrix and P the interpolation.
        """
        forces = self._prolongation.gathered(b, self._free)
        own = self._elastic.free
        given = np.zeros_like(forces)
        given[own] = self._elastic.solve(forces[own])
        return self._prolongation.interpolated(given, self._free)

    @cached_property
    def _prolongation(self) -> Prolongation:
        """Weights of the coarse vertices at the fine ones, for previews only."""
        rows, best = np.arange(len(self._near)), self._weight.argmax(axis=1)
        nearest = np.where(self._weight[rows, best] > 0.0, self._near[rows, best], -1)
        return Prolongation(self._fine.V, self.vertices, self.F, nearest, self._fixed)

    def _set_reference(self) -> None:
        self._reference = self._elastic.q.copy(), self._elastic.U

    def _turned(self) -> np.ndarray:
        return difference(self._elastic.q, self._reference[0])

    def _own(self, goals: tuple[Goal, ...]) -> tuple[Goal, ...]:
        """The goals for the coarse surface: the same percentages of its rest values."""
        shape, own = self._shape, []
        for goal in goals:
            weight = None if goal.weight is None else goal.weight[self.vertices]
            coarse = at_rest(replace(goal, patch=shape.whole, weight=weight), shape.V)
            if coarse.rest:
                own.append(coarse)
        return tuple(own)


def _with_held(rest: SolveMesh, thinning: Thinning, fixed: np.ndarray) -> np.ndarray:
    """Vertices of a decimated mesh, some replaced by held ones.

    So every held part has a vertex in the coarse mesh.
    """
    V, vertices = rest.V, thinning.vertices.copy()
    while True:
        heard = vertices[np.isin(vertices, fixed)]
        away = KDTree(V[heard]).query(V[fixed], workers=-1)[0] if len(heard) else np.full(len(fixed), np.inf)
        same = np.isin(rest.piece[fixed], rest.piece[vertices[~np.isin(vertices, fixed)]])
        farthest = int(np.argmax(np.where(same, away, 0.0)))
        if not same.any() or away[farthest] <= _UNHEARD * thinning.edge:
            return vertices
        lonely = fixed[farthest]
        others = np.flatnonzero(~np.isin(vertices, fixed) & (rest.piece[vertices] == rest.piece[lonely]))
        vertices[others[np.argmin(np.linalg.norm(V[vertices[others]] - V[lonely], axis=1))]] = lonely
