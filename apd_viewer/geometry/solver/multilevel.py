"""Multilevel descent: coarse levels lead, the fine one finishes."""

from __future__ import annotations

import time

import numpy as np

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.solve_mesh import FEWEST_COARSE_VERTICES, SolveMesh
from apd_viewer.geometry.goals.goal_projection import GoalProjection
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.solver.coarse_level import CoarseLevel
from apd_viewer.geometry.solver.constrained_descent import ENERGY_TOLERANCE, ConstrainedDescent
from apd_viewer.geometry.solver.iterative_solver import LevelSolver, SolverProgress
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium

# Number of free vertices below which a surface converges as fast without a coarse level.
_ALONE = 4 * FEWEST_COARSE_VERTICES
# Convergence tolerance of a coarse level; the finer one reduces the remaining error faster.
_COARSE_TOLERANCE = 1e-4
# Iterations of the coarsest level per iteration of the next finer one; both take about as long.
_COARSEST_ITERATIONS = 16
# Coarse rotations leave a stiff surface rough: dihedral angles are up to 8 times those at rest, 3.3 times
# after three fine iterations, and 2.7 times after six. Fabric gets only three: after six, the preview of a
# bent bar crossed itself, and contact blocked all further steps until the matrix was factored.
_SMOOTHING, _SMOOTHING_OF_FABRIC = 6, 3
# The iterations of a coarse level double from step to step up to this factor: the first step must be quick,
# since the targets may soon move again.
_MOST_AHEAD = 8


def gains_from_coarse_level(surface: ElasticSurface) -> bool:
    """True if a surface converges sooner with a coarse level."""
    if len(surface.free) < _ALONE:
        return False
    # Thousands of loose triangles cannot be decimated, and the held vertices may leave the coarse mesh no
    # freedom.
    vertices = surface.rest.decimation.vertices
    enough = surface.is_free[vertices].sum() > FEWEST_COARSE_VERTICES / 2
    return _is_well_decimated(surface.rest) and bool(enough)


def multilevel_descent(
    surface: ElasticSurface, goals: tuple[Goal, ...], tolerance: float = ENERGY_TOLERANCE
) -> MultilevelDescent:
    """Solver of a surface with all useful coarse levels."""
    return MultilevelDescent(
        ConstrainedDescent(surface, goals, tolerance), CoarseLevel(surface, goals, _coarse)
    )


def _coarse(surface: ElasticSurface, goals: tuple[Goal, ...]) -> LevelSolver:
    if gains_from_coarse_level(surface):
        return multilevel_descent(surface, goals, _COARSE_TOLERANCE)
    return ConstrainedDescent(surface, goals, _COARSE_TOLERANCE)


def compute_decimations(rest: RestMesh) -> tuple[Decimation, ...]:
    """Compute and cache the decimations common to all deformations of a mesh.

    They take most of the time independent of the held vertices; another :class:`RestMesh` of the mesh can
    reuse them.
    """
    shape, found = rest.solve_mesh, []
    while len(shape.V) >= _ALONE:
        found.append(shape.decimation)
        if not _is_well_decimated(shape):
            break
        shape = shape.coarse_mesh
    return tuple(found)


def _is_well_decimated(rest: SolveMesh) -> bool:
    """True if decimation removes at least half of the vertices."""
    return len(rest.decimation.vertices) < len(rest.V) / 2


class MultilevelDescent:
    """Steps led by a coarse level until it converges, then fine descent.

    Each step ends with the goals met and the held vertices in place, just as without a coarse level.

    Where the matrix is factored by another process, the surface is large, and a global step takes longer
    than a user likes to wait. Then previews are shown until the coarse level has converged and the factor
    is ready.

    Parameters
    ----------
    fine : ConstrainedDescent
    coarse : CoarseLevel

    Attributes
    ----------
    surface : ElasticSurface
        The fine surface.
    forecast : PreviewForecast
    """

    def __init__(self, fine: ConstrainedDescent, coarse: CoarseLevel) -> None:
        self.surface = fine.surface
        self.fine, self.coarse = fine, coarse
        self._coarse_iterations = 1 if len(coarse.shapes()) > 1 else _COARSEST_ITERATIONS
        self._preview: CoarsePreview | None = None
        self._shows_preview = False
        self.forecast = PreviewForecast(self.surface, coarse)
        self._reset()

    @property
    def progress(self) -> SolverProgress:
        """Readings of the fine surface, or of its unconverged preview."""
        progress = self.fine.progress._replace(seconds_left=self.forecast.seconds_left)
        if not self._is_descending:
            progress = progress._replace(converged=False, convergence_ratio=None)
        if (preview := self._shown_preview) is None:
            return progress
        return progress._replace(
            U=preview.U,
            goal_values=preview.projection.values,
            has_met_goals=preview.projection.has_met_goals,
            is_iterate_hidden=True,
        )

    @property
    def has_ended(self) -> bool:
        """True if converged, or stuck because goals cannot be met."""
        return self.fine.stuck or (self._is_descending and self.fine.has_converged)

    @property
    def _is_descending(self) -> bool:
        """True if only the fine surface has yet to converge."""
        return self.coarse.converged and not self._previews

    @property
    def energy(self) -> float | None:
        """Energy of the displayed shape; None if unknown."""
        return None if self._shown_preview else self.fine.energy

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""
        return (self._previews and not self.coarse.converged) or self.fine.ready

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Fine surface in equilibrium, for the stability search."""
        return self.fine.equilibrium

    def set_tolerance(self, tolerance: float) -> None:
        """Set the tolerance on the relative energy decrease over ten fine-level steps."""
        self.fine.set_tolerance(tolerance)

    def has_stalled(self, tolerance: float) -> bool:
        """True if the last fine steps reduced the energy by at most this fraction."""
        return self.coarse.converged and self.fine.has_stalled(tolerance)

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Replace the goals."""
        self._discard_preview()
        self.coarse.set_goals(goals)
        self.fine.set_goals(goals)
        self._reset()

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the target positions (k + s, 3) of the held and soft vertices."""
        self.coarse.set_targets(targets)
        self.fine.set_targets(targets)
        self._reset()

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self._discard_preview()
        self.coarse.restart(U)
        self.fine.restart(U)
        self._reset()

    def follow_coarse_again(self) -> None:
        """Follow the coarse level again from the current fine shape, without previews."""
        self.restart(self.surface.U)
        self._previews = False

    def shapes(self) -> list[np.ndarray]:
        """The fine shape, then those of the coarser levels."""
        return [*self.fine.shapes(), *self.coarse.shapes()]

    def restore(self, shapes: list[np.ndarray]) -> None:
        """Continue from the result of an earlier :meth:`shapes`."""
        self._discard_preview()
        self.fine.restart(shapes[0])
        self.coarse.restore(shapes[1:])
        self._reset()

    def _reset(self) -> None:
        self._ahead = 1
        self.forecast.reset()
        self._previews = self.surface.factor.is_in_other_process

    def prepare_previews(self) -> None:
        """Compute what the first preview waits for, and later ones reuse."""
        if self._previews:
            self.coarse.prepare_previews()
            self._prepared_preview()

    def step(self) -> None:
        """Prolong the coarse level's rotations; descend once it has converged."""
        if self._previews and not (self.coarse.converged and self.fine.ready):
            self._advance_coarse()
            self.coarse.smooth(_SMOOTHING_OF_FABRIC if self.surface.membrane else _SMOOTHING)
            self._prepared_preview().follow_coarse_surface(self.fine.held_positions)
            self._shows_preview = True
            self.forecast.expect_factor()
        elif self._previews:
            self._end_previews()
        elif self.coarse.converged or self.fine.stuck:
            self.fine.step()
            self.forecast.count_iteration()
        else:
            self._advance_coarse()
            self.surface.rotate_projections(self.coarse.take_rotations())
            self.fine.iterate()

    def smooth(self, iterations: int) -> None:
        """Iterate without the coarse level."""
        self.fine.smooth(iterations)

    @property
    def _shown_preview(self) -> CoarsePreview | None:
        return self._preview if self._shows_preview else None

    def _prepared_preview(self) -> CoarsePreview:
        self._preview = self._preview or CoarsePreview(self.surface, self.coarse, self.fine.goals)
        return self._preview

    def _discard_preview(self) -> None:
        self._preview, self._shows_preview = None, False

    def _advance_coarse(self) -> None:
        self.coarse.iterate(self._coarse_iterations * self._ahead)
        self._ahead = min(2 * self._ahead, _MOST_AHEAD)

    def _end_previews(self) -> None:
        """End the previews, and iterate from the last preview."""
        self.forecast.begin_descent()
        self.surface.rotate_projections(self.coarse.take_rotations())
        if (preview := self._shown_preview) is not None:
            self.surface.U = preview.U
        self._discard_preview()
        self._previews = False
        self.fine.iterate()
        self.forecast.count_iteration()


# Exponent of the factorization time in the unknowns (nested dissection on surfaces), and slowdown of another
# process by the work of this one (1.1 to 1.4).
_FACTORING, _BESIDE = 1.5, 1.3
# Fine iterations over the root of the coarse ones, as measured (18 and 26 for 15, 25 for 22, 41 for 53, 66
# for 69, 113 for 135, 58 for 298), and exponent of the time per iteration in the unknowns.
_DESCENT, _ITERATION = 6.0, 1.3


class CoarsePreview:
    """Shapes of a fine surface, moved along with a coarse one.

    Previews are not at equilibrium, but hold the held vertices and meet the goals like all other shapes.

    Parameters
    ----------
    surface : ElasticSurface
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

    def __init__(self, surface: ElasticSurface, coarse: CoarseLevel, goals: tuple[Goal, ...]) -> None:
        self._elastic, self._coarse = surface, coarse
        self.free = surface.free
        self.U = surface.U
        self.projection = GoalProjection(self, goals)
        self.projection.refresh_directions(self.U)

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Smooth response (f, 3) to forces ``b_f`` (f, 3), used to meet the goals."""
        return self._coarse.response(b_f)

    def follow_coarse_surface(self, targets: np.ndarray) -> None:
        """Follow the coarse surface, with the held vertices at ``targets`` (k, 3)."""
        U = self._coarse.prolonged_positions(targets)
        if self.projection.has_outdated_directions:
            self.projection.refresh_directions(U)
        self.U, _ = self.projection.project(U)


class PreviewForecast:
    """Forecast of the time to convergence of a fine surface during previews.

    Parameters
    ----------
    surface : ElasticSurface
        The fine surface.
    coarse : CoarseLevel
    """

    def __init__(self, surface: ElasticSurface, coarse: CoarseLevel) -> None:
        self._elastic, self._coarse = surface, coarse
        self.reset()

    @property
    def seconds_left(self) -> float | None:
        """Expected seconds until convergence; None if unknown."""
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
        """Expected seconds of the fine surface's iterations."""
        return (
            self.iterations * self._coarse.seconds_per_iteration * self._coarse.refinement_ratio**_ITERATION
        )

    def reset(self) -> None:
        """Discard the forecast, since the targets have moved."""
        self._end: float | None = None
        self._began, self._done = 0.0, 0

    def expect_factor(self) -> None:
        """Forecast the end of the factorization and of the iterations after it."""
        if self._coarse.converged:
            factoring = self.factor_seconds - self._elastic.factor.seconds
            self._end = time.monotonic() + max(factoring, 0.0) + self.descent_seconds

    def begin_descent(self) -> None:
        """Note the start of the first fine iteration."""
        self._began = time.monotonic()

    def count_iteration(self) -> None:
        """Update the forecast by the pace of the iterations so far."""
        if self._end is not None:
            self._done += 1
            now = time.monotonic()
            self._end = now + max(self.iterations - self._done, 0.0) * (now - self._began) / self._done
