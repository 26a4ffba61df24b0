"""Coarse level of an elastic surface, solved ahead of the fine one.

Low frequencies converge in hundreds of iterations on a fine mesh, but quickly on a coarse one. The coarse
surface passes on the rotations of its vertices since the last time. The global step of the fine surface then
converts them to positions of all frequencies, with rotated details. For previews without a global step, the
fine surface is moved along with the coarse one.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numba import prange
from scipy.spatial import KDTree

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import Goal, goal_at_rest
from apd_viewer.geometry.linalg.rotations import blended_rotations, relative_rotations
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.decimation import with_held_vertices
from apd_viewer.geometry.mesh.prolongation import Prolongation
from apd_viewer.geometry.solver.iterative_solver import LevelSolver

# Number of timed iterations: their median is robust against delays by other processes.
_PACES = 5
# Width of the free collar beside held vertices that previews smooth, in coarse edges: widths 2, 3, 4 leave
# dihedral angles of 1.9, 1.7, 1.6 times those at rest.
_COLLAR = 3.0


class CoarseLevel:
    """Coarse surface with the material and the held vertices of the fine one.

    Its vertices are a subset of the fine ones, so that held vertices need no interpolation.

    Parameters
    ----------
    surface : ElasticSurface
        The fine surface.
    goals : tuple of Goal
    make_solver : callable
        Makes the solver of the coarse surface.

    Attributes
    ----------
    vertices : (c,) int array
        The vertices of the fine surface that it has.
    steps : int
        Iterations since the targets moved.
    """

    def __init__(
        self,
        surface: ElasticSurface,
        goals: tuple[Goal, ...],
        make_solver: Callable[[ElasticSurface, tuple[Goal, ...]], LevelSolver],
    ) -> None:
        rest, fixed = surface.rest, surface.fixed
        thinning = rest.decimation
        self.vertices = with_held_vertices(rest.V, rest.component, thinning, surface.is_held)
        self.F = thinning.F
        unchanged, coarse = np.array_equal(self.vertices, thinning.vertices), rest.coarse_mesh
        self._shape = coarse if unchanged else coarse.with_positions(rest.V[self.vertices])
        held = np.flatnonzero(surface.is_held[self.vertices])
        soft, own = surface.soft, np.full(len(rest.V), -1)
        own[self.vertices] = np.arange(len(self.vertices))
        has = own[soft.ids] >= 0
        self._which = np.concatenate(
            [np.searchsorted(fixed, self.vertices[held]), len(fixed) + np.flatnonzero(has)]
        )
        drawn = soft.subset(has)._replace(ids=own[soft.ids[has]])
        self._elastic = ElasticSurface(self._shape, held, surface.material, soft=drawn)
        self._solver = make_solver(self._elastic, self._coarse_goals(goals))
        self._near, self._weight = thinning.coarse_neighbours, thinning.weight
        self._fine = surface
        self.steps, self._paces = 0, deque[float](maxlen=_PACES)
        self._set_reference()

    @property
    def converged(self) -> bool:
        """True if further iterations would hardly change the shape."""
        return self._solver.has_ended

    @property
    def energy(self) -> float:
        """Energy of the coarse surface."""
        return self._elastic.energy

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Set the fine surface's goals, at the same percentages of coarse rest values."""
        self._solver.set_goals(self._coarse_goals(goals))

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

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the targets of held and soft vertices from the fine ones (k + s, 3)."""
        self._solver.set_targets(targets[self._which])
        self.steps = 0

    def iterate(self, iterations: int) -> None:
        """Do at most ``iterations`` iterations, until converged."""
        with cores_for(len(self.vertices)):
            for _ in range(iterations):
                if self.converged:
                    break
                self._solver.step()
                self.steps += 1

    def smooth(self, iterations: int) -> None:
        """Iterate without a coarser level, to smooth the shape before display."""
        begun = time.monotonic()
        with cores_for(len(self.vertices)):
            self._solver.smooth(iterations)
        self._paces.append((time.monotonic() - begun) / iterations)

    @property
    def seconds_per_iteration(self) -> float:
        """Median number of seconds per iteration."""
        return float(np.median(self._paces))

    @property
    def factor_seconds(self) -> float:
        """Seconds taken to factor the matrix."""
        return self._elastic.factor.seconds

    @property
    def refinement_ratio(self) -> float:
        """Ratio of free vertices of the fine surface to those of this level."""
        return len(self._fine.free) / len(self._elastic.free)

    def take_rotations(self) -> np.ndarray:
        """Rotations of the fine vertices since the last call, (n, 4) quaternions."""
        turns = blended_rotations(self._relative_rotations(), self._near, self._weight)
        self._set_reference()
        return turns

    def prolonged_positions(self, targets: np.ndarray) -> np.ndarray:
        """Fine positions, moved along with this level since :meth:`take_rotations`.

        Its held vertices are at ``targets`` (k + s, 3).
        """
        U, fixed, is_held = self._fine.U, self._fine.fixed, self._fine.is_held[self.vertices]
        X, moved = U[self.vertices], self._elastic.U - self._reference[1]
        U = self._prolongation.moved_positions(U, X, self._relative_rotations(), moved, is_held)
        U[fixed] = targets[: len(fixed)]
        return self._collar.smoothed_positions(U)

    def prepare_previews(self) -> None:
        """Compute what the first :meth:`prolonged_positions` waits for."""
        _ = self._prolongation, self._collar

    def response(self, b: np.ndarray) -> np.ndarray:
        """Response of the free fine vertices to forces ``b``, both (f, 3).

        ``P K^-1 P^T b`` with K the coarse matrix and P the interpolation.
        """
        forces = self._prolongation.restricted_values(b, self._fine.free)
        own = self._elastic.free
        given = np.zeros_like(forces)
        given[own] = self._elastic.solve(forces[own])
        return self._prolongation.prolonged_values(given, self._fine.free)

    @cached_property
    def _prolongation(self) -> Prolongation:
        """Interpolation from the coarse vertices to the fine ones, for previews only."""
        rest = self._fine.rest
        if np.array_equal(self.vertices, rest.decimation.vertices):
            return rest.prolongation
        return Prolongation(rest.V, self.vertices, self.F, rest.decimation.nearest)

    @cached_property
    def _collar(self) -> Collar:
        return Collar(self._fine, _COLLAR * self._fine.rest.decimation.edge_length)

    def _set_reference(self) -> None:
        self._reference = self._elastic.q.copy(), self._elastic.U

    def _relative_rotations(self) -> np.ndarray:
        return relative_rotations(self._elastic.q, self._reference[0])

    def _coarse_goals(self, goals: tuple[Goal, ...]) -> tuple[Goal, ...]:
        """Goals of the coarse surface, at the same percentages of its rest values."""
        shape, own = self._shape, []
        for goal in goals:
            weight = None if goal.weight is None else goal.weight[self.vertices]
            coarse = goal_at_rest(replace(goal, patch=shape.all_triangles, weight=weight), shape.V)
            if coarse.rest:
                own.append(coarse)
        return tuple(own)


# Rings of triangles around the solved vertices, the reach of the bending energy.
_RINGS = 2
# Largest number of cells along a side of the table of vertices near held ones.
_MOST_CELLS = 128
# Largest number of solved vertices: beyond it the factorization takes too long.
_MOST = 100_000


class Collar:
    """Free vertices within a distance of held ones, solved with all others fixed.

    A preview bends as sharply as the coarse surface beside held vertices. A global step of the collar alone
    smooths it there.

    Parameters
    ----------
    surface : ElasticSurface
        The whole surface; it is not touched.
    width : float
        The distance, mesh units.
    """

    def __init__(self, surface: ElasticSurface, width: float) -> None:
        V, F = surface.rest.V, surface.rest.F
        held, corners = surface.is_held, surface.is_held[F].sum(axis=1)
        border = used_vertices(F[(corners > 0) & (corners < 3)])
        solved = _within(V, V[border[held[border]]], width) & ~held
        self._part = self._vertices = None
        if 0 < solved.sum() <= _MOST:
            self._part, self._vertices = _subsurface(surface, solved)

    def smoothed_positions(self, U: np.ndarray) -> np.ndarray:
        """Positions ``U`` (n, 3) after an iteration of the collar."""
        if self._part is None:
            return U
        part, start = self._part, U[self._vertices]
        part.restart(start)
        part.local_step(part.global_step(start[part.fixed]))
        smoothed = U.copy()
        smoothed[self._vertices] = part.U
        return smoothed


def _within(V: np.ndarray, points: np.ndarray, width: float) -> np.ndarray:
    """Mask (n,) of the positions nearer than ``width`` to one of the ``points``."""
    near = np.zeros(len(V), dtype=bool)
    if len(points):
        # In a large mesh, nearly all vertices are far from the points, and a table of cells tells so at once.
        low = points.min(axis=0) - width
        side = max(width, float((points.max(axis=0) + width - low).max()) / _MOST_CELLS)
        count = np.floor((points.max(axis=0) + width - low) / side).astype(int) + 1
        own = np.floor((points - low) / side).astype(int)
        table = np.zeros(count, dtype=bool)
        for step in np.ndindex(3, 3, 3):
            i, j, k = np.clip(own + step - 1, 0, count - 1).T
            table[i, j, k] = True
        inside = np.flatnonzero(_are_in_cells(V, low, side, table))
        away = KDTree(points).query(V[inside], distance_upper_bound=width, workers=-1)[0]
        near[inside] = np.isfinite(away)
    return near


@parallel()
def _are_in_cells(V: np.ndarray, low: np.ndarray, side: float, table: np.ndarray) -> np.ndarray:
    """Mask (n,) of positions in the marked cells of a grid from ``low`` (3,)."""
    found = np.zeros(len(V), dtype=np.bool_)
    for v in prange(len(V)):
        i, j, k = (V[v, 0] - low[0]) / side, (V[v, 1] - low[1]) / side, (V[v, 2] - low[2]) / side
        if min(i, j, k) >= 0.0 and i < table.shape[0] and j < table.shape[1] and k < table.shape[2]:
            found[v] = table[int(i), int(j), int(k)]
    return found


def _subsurface(surface: ElasticSurface, solved: np.ndarray) -> tuple[ElasticSurface, np.ndarray]:
    """Surface around the vertices ``solved`` (n,) bool, and its vertex indices."""
    rest, near = surface.rest, solved.copy()
    F = rest.F
    for _ in range(_RINGS):
        near[F[near[F].any(axis=1)]] = True
    F = F[near[F].all(axis=1)]
    vertices = used_vertices(F)
    corners = np.searchsorted(vertices, F)
    shape = SolveMesh(rest.V[vertices], corners)
    # Bending and coupling energies scale with the total area of the mesh.
    growth, material = rest.vertex_areas.sum() / shape.vertex_areas.sum(), surface.material
    material = replace(material, bending=growth * material.bending, coupling=growth * material.coupling)
    return ElasticSurface(shape, np.flatnonzero(~solved[vertices]), material), vertices
