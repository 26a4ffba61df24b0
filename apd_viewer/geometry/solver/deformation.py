"""Deformation of a mesh, one iteration at a time."""

import time
from collections.abc import Sequence
from functools import partial
from typing import NoReturn, cast

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact_obstacles import Obstacle, shifted_obstacles
from apd_viewer.geometry.contact.mesh_contact import contact_readings
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.enclosed_gas import enclosed_volume
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.energy.wall_surface import WallSurface, joints_sentence
from apd_viewer.geometry.goals.calm_parts import calm_level_weights
from apd_viewer.geometry.goals.goals import Region, RegionReading
from apd_viewer.geometry.linalg.linear_solver import Factorizer
from apd_viewer.geometry.linalg.parallel_ops import largest_difference
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import checked, frozen
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.contact_descent import (
    ContactDescent,
    check_contact,
    check_obstacles,
    contact_descent,
    needs_contact,
    stop_sentence,
)
from apd_viewer.geometry.solver.convergence import (
    DEFAULT_CONVERGENCE,
    Convergence,
    StepConvergence,
    check_convergence,
)
from apd_viewer.geometry.solver.goal_set import GoalSet
from apd_viewer.geometry.solver.held_vertices import (
    HeldVertices,
    check_any_free,
    checked_rest_mesh,
    checked_shifts,
    checked_soft_targets,
    checked_start,
    soft_solve_constraints,
)
from apd_viewer.geometry.solver.iterative_solver import IterativeSolver, SolverProgress
from apd_viewer.geometry.solver.loose_components import GO, LooseComponents
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_POISSON,
    DEFAULT_SHEAR_STIFFNESS,
    DEFAULT_TOLERANCE,
    check_wall_size,
    checked_method,
    method_material,
    wall_material,
)
from apd_viewer.geometry.solver.restarts import make_solver
from apd_viewer.geometry.solver.stability import Stability
from apd_viewer.language import tr


class Deformation:
    """A mesh with some vertices held, deformed one iteration at a time.

    Parameters
    ----------
    V, F : (n, 3) float array, (m, 3) int array
        Rest positions, and triangles.
    fixed : (k,) int array
        Held vertices: base and handles together.
    method : str
        "exact" (as rigid as possible, preserving the total area to the last digits), "local" (preserving
        every triangle's area), "wall" (a thin elastic wall), "paper" (Li & Hui: preserving the total area to
        the tolerance, with drifting handles), "arap" (as rigid as possible) or "sr-arap" (as in CGAL).
    handle : int array or sequence of int arrays, optional
        Members of ``fixed`` in the handle, or in each handle; needed by "paper", calm parts and drift.
    tolerance : float
        Relative error of the total area accepted by "paper".
    stiffness : float
        Weight of bending, 0 to about 0.1; for "sr-arap" CGAL's alpha.
    area_stiffness, shear_stiffness : float
        Stiffness of every triangle's area (area modulus) and shape (shear modulus) for "local".
    wall_thickness : float or array, optional
        Of "wall", mesh units, or one for each vertex or triangle; 1/1000 of the diagonal by default.
    poisson, hardening : float
        Of the wall: Poisson's ratio, and its stiffness where it yields over the elastic one.
    tension_field : bool
        Whether the wall wrinkles finer than its mesh, resisting no compression, as film and cloth do.
    area, volume : float or str, optional
        Targets of the total area and the enclosed volume, in percent of the rest values; below 10 as a string
        such as ``"5%"``. By default "exact" and "paper" keep the area; all else is free.
    filled_volume : float, optional
        Target of the volume in cubic mesh units instead, also of a closed surface that is flat at rest.
    regions : sequence of Region, optional
        Regions to measure, some of them with target areas.
    plain : bool
        Do plain iterations, a local and a global step each, comparable with other programs. Otherwise methods
        minimising an energy (not "paper" and "sr-arap") do quasi-Newton steps.
    rest : RestMesh, optional
        Rest mesh of the same V and F, to save its computation.
    factored : callable, optional
        Function that factors a matrix, for example in another process.
    soft : SoftConstraints
        Vertices pulled along by handles without being held.
    loose : "go", "stay" or int array
        Connected parts without held vertices: all follow the nearest surface, all stay, or those with these.
    convergence : Convergence
        Criteria that end the iterations.
    calm : bool
        Whether "exact" also preserves the area of calm parts, hardly reached by the gesture.
    contact : bool
        Whether to prevent self-intersections beyond those at rest; they may stop held vertices on their way.
    thickness : float, optional
        Distance kept by walls in contact, mesh units; 1/1000 of the bounding box's diagonal by default.
    obstacles : sequence of Obstacle
        Obstacles that no shape enters with contact on, without friction. No vertices need be held then: the
        surface slides, but does not rotate as a whole.
    yield_radius : float, optional
        Walls bent from flat to a smaller radius, mesh units, keep a crease; by default they are elastic.
        Needs contact, and stiffness or the method "wall". Creases become permanent once a shape has settled.
    gas, pressure : float, optional
        Pressure of gas times volume at rest, in areas of the surface: ideal, at one temperature, as outside
        at rest; needs contact. Or, for "wall", a constant difference of pressure, inside less outside, 1 /
        mesh unit, where Young's modulus times thickness is 4. Openings are capped.
    weld : bool
        Whether to weld seams with nearly touching sides; see :meth:`apd_viewer.Mesh.welded`.

    Attributes
    ----------
    solver, loose, contact : IterativeSolver, LooseComponents, ContactDescent or None

    Raises
    ------
    InputError
        If the mesh or the held vertices cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> V, F = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]]
    >>> solver = apd_viewer.Deformation(V, F, [0, 1, 3], handle=[3])
    >>> solver.aim([[0, 0, 0], [1, 0, 0], [1, 1, 1]])
    >>> solver.step().handle_drift
    0.0
    """

    @checked
    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        fixed: np.ndarray | Sequence[int],
        *,
        method: str = DEFAULT_METHOD,
        handle: np.ndarray | Sequence[np.ndarray] | None = None,
        tolerance: float = DEFAULT_TOLERANCE,
        stiffness: float = 0.0,
        area_stiffness: float = DEFAULT_AREA_STIFFNESS,
        shear_stiffness: float = DEFAULT_SHEAR_STIFFNESS,
        wall_thickness: float | np.ndarray | None = None,
        poisson: float = DEFAULT_POISSON,
        tension_field: bool = False,
        area: float | str | None = None,
        volume: float | str | None = None,
        filled_volume: float | None = None,
        regions: Sequence[Region] = (),
        plain: bool = False,
        rest: RestMesh | None = None,
        factored: Factorizer | None = None,
        soft: SoftConstraints = NO_SOFT_CONSTRAINTS,
        loose: str | Sequence[int] | np.ndarray = GO,
        convergence: Convergence = DEFAULT_CONVERGENCE,
        calm: bool = True,
        contact: bool = False,
        thickness: float | None = None,
        obstacles: Sequence[Obstacle] = (),
        yield_radius: float | None = None,
        hardening: float = 0.0,
        gas: float | None = None,
        pressure: float | None = None,
        weld: bool = False,
    ) -> None:
        self.rest = rest = checked_rest_mesh(rest, V, F, weld)
        self.method, self._total = method, 0
        self._held = HeldVertices(fixed, handle, rest)
        held, handle_of = self._held.ids, self._held.handle_of
        check_obstacles(obstacles, contact)
        self._traits = checked_method(method, handle_of, len(obstacles) > 0)
        in_contact = needs_contact(self._traits, contact, yield_radius, gas, pressure, volume, filled_volume)
        self.loose = LooseComponents(rest, held, handle_of, loose, contact)
        self._soft, self._drawn = soft_solve_constraints(soft, rest, held)
        material = method_material(self._traits, stiffness, area_stiffness, shear_stiffness, yield_radius)
        wall = wall_map_of(wall_thickness, rest.V, rest.F), poisson, yield_radius, tension_field, hardening
        thin = wall_material(rest.diagonal, *wall)
        check_any_free(rest, held)
        with cores_for(len(rest.solve_mesh.V)):
            levels = partial(calm_level_weights, rest.solve_mesh, held, handle_of, self._soft)
            self._kept = GoalSet(rest, method, self._traits, tolerance, levels, filled_volume)
            self._kept.set_targets(area, volume, regions, calm and len(held) > 0)
            started = time.perf_counter()
            of, goals = np.concatenate([handle_of, self._soft.handle + 1]), self._kept.goals
            touching = rest, of, thickness, self.loose, shifted_obstacles(obstacles, -rest.centre)
            inside = enclosed_volume(rest, gas, pressure)
            inner: IterativeSolver | WallSurface
            if self._traits.is_wall:
                check_wall_size(len(rest.solve_mesh.V))
                inner = WallSurface(rest.solve_mesh, held, thin, self._soft)
            else:
                surface = ElasticSurface(rest.solve_mesh, held, material, factored, self._soft)
                inner = make_solver(surface, goals, self._traits, of, plain or in_contact)
            self.contact: ContactDescent | None = None
            if contact or self._traits.is_wall:
                check_contact(self._traits, plain)
                self.contact = contact_descent(inner, goals, *touching, inside, contact)
            self.solver = cast(IterativeSolver, self.contact or inner)
        self._stability, self._convergence = Stability(self.solver, rest.diagonal), DEFAULT_CONVERGENCE
        self.convergence = convergence
        self.factor_seconds = time.perf_counter() - started
        self._begin()
        self.aim(rest.to_mesh_coordinates(rest.V[self.fixed]))

    def __reduce_ex__(self, _: object) -> NoReturn:
        """Raise InputError instead of copying or pickling the object."""
        raise InputError(
            tr(
                "A Deformation cannot be copied or pickled; make another one with the same arguments, and "
                "aim it with the U of its last frame."
            )
        )

    @property
    def fixed(self) -> np.ndarray:
        """Held vertices, (k,) int array."""
        return self._held.fixed

    @property
    def tolerance(self) -> float:
        """Relative error of the total area accepted by the "paper" method."""
        return self._kept.tolerance

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        with cores_for(len(self.rest.solve_mesh.V)):
            self._kept.tolerance = tolerance
            if self._traits.has_tolerance:
                self.solver.set_goals(self._kept.goals)

    @property
    def convergence(self) -> Convergence:
        """Criteria that end the iterations."""
        return self._convergence

    @convergence.setter
    def convergence(self, convergence: Convergence) -> None:
        check_convergence(convergence)
        with cores_for(len(self.rest.solve_mesh.V)):
            before, self._convergence = self._convergence, convergence
            self._stability.imperfection, self._stability.seed = convergence.imperfection, convergence.seed
            if convergence.energy_tolerance != before.energy_tolerance:
                self.solver.set_tolerance(convergence.energy_tolerance)
                self._begin()
            elif (convergence.imperfection, convergence.seed) != (before.imperfection, before.seed):
                self._begin()

    @checked
    def keep(
        self,
        area: float | str | None = None,
        volume: float | str | None = None,
        regions: Sequence[Region] = (),
        calm: bool = True,
    ) -> None:
        """Set new targets for areas and the volume, without a new factorization."""
        with cores_for(len(self.rest.solve_mesh.V)):
            self._kept.set_targets(area, volume, regions, calm and len(self.fixed) > 0)
            self.solver.set_goals(self._kept.goals)
            self._begin()

    def replace_obstacles(self, obstacles: Sequence[Obstacle]) -> None:
        """Replace the obstacles, without a new factorization.

        Aim with ``U`` then: without, the surface begins at rest. Raises InputError without contact.
        """
        check_obstacles(obstacles, self.contact is not None)
        checked_method(self.method, self._held.handle_of, len(obstacles) > 0)
        with cores_for(len(self.rest.solve_mesh.V)):
            if self.contact is not None:
                self.contact.replace_obstacles(shifted_obstacles(obstacles, -self.rest.centre))
            self._begin()

    def aim(
        self,
        targets: np.ndarray,
        U: np.ndarray | None = None,
        soft_targets: np.ndarray | None = None,
        shifts: np.ndarray | None = None,
        begin: np.ndarray | None = None,
    ) -> None:
        """Set the target positions of the held vertices.

        Raises InputError, also if obstacles at their initial positions intersect the rest shape.

        Parameters
        ----------
        targets : (k, 3) float array
            Target position of each vertex in ``fixed``.
        U : (n, 3) float array, optional
            Start positions, with their creases by the yield radius; by default those of the last iteration.
        soft_targets : (s, 3) float array, optional
            Targets of the soft vertices; their rest positions by default.
        shifts : (o, 3) float array, optional
            Final displacement of each obstacle, moving straight with the held vertices; zero by default.
        begin : (o, 3) float array, optional
            Displacement of each obstacle at ``U``; by default the final one. If it intersects ``U`` there, it
            starts at its initial position; if also there, the surface starts at rest.
        """
        U = None if U is None else checked_start(U, self.rest)
        count = 0 if self.contact is None else len(self.contact.shifts)
        shifts = checked_shifts(shifts, count)
        begin = shifts if begin is None else checked_shifts(begin, count)
        with cores_for(len(self.rest.solve_mesh.V)):
            self._held.set_targets(targets)
            surface = self.solver.surface
            if surface.creases and self.contact and (self.contact.is_stopped or self.settled):
                surface.commit_creases()
            if self._kept.restore_dropped_goals():
                self.solver.set_goals(self._kept.goals)
            if self.contact is not None:
                self.contact.target_shifts, self.contact.start_shifts = shifts, begin
            if U is not None:
                if surface.creases:
                    surface.creases.clear_flow()
                self.solver.restart(
                    self.loose.with_loose_parts_at_rest(np.ascontiguousarray(U[self.rest.weld.first]))
                )
                surface.commit_creases()
            drawn = checked_soft_targets(soft_targets, self.rest, self._soft, *self._drawn)
            asked = self._held.targets
            self.solver.set_targets(np.concatenate([asked, drawn]) if len(drawn) else asked)
            self._begin()

    def _begin(self) -> None:
        self._iteration, self._steps = 0, StepConvergence()
        self._stability.reset()

    def step(self) -> Frame:
        """Do one iteration; return the shape and its readings."""
        self.iterate()
        return self.frame()

    def iterate(self) -> None:
        """Do one iteration, without readings; in equilibrium, examine the stability."""
        with cores_for(len(self.rest.solve_mesh.V)):
            in_equilibrium = self._is_in_equilibrium and self.share_reached == 1.0
            if self._stability.is_due(in_equilibrium, self._iteration):
                if self._stability.step(in_equilibrium):
                    self._steps = StepConvergence()
            else:
                self._descend()
            self._iteration += 1
            self._total += 1

    def _descend(self) -> None:
        """Do a step; repeat it without the area goals of calm parts if they are missed."""
        solver, kept = self.solver, self._kept
        if kept.may_retry_dropped_goals and self._has_settled(solver.progress):
            kept.retry_dropped_goals()
            solver.set_goals(kept.goals)
        before = solver.progress.U
        solver.step()
        if kept.has_calm_goals and not solver.progress.has_met_goals:
            kept.drop_calm_goals()
            solver.set_goals(kept.goals)
            solver.restart(before)
            solver.step()
        self._steps.append(largest_difference(solver.progress.U, before) / self.rest.diagonal)

    @property
    def ready(self) -> bool:
        """True if an iteration need not wait for a factorization."""
        return self.solver.ready

    @property
    def settled(self) -> bool:
        """True if further iterations would change nothing."""
        # Stability, which takes an energy, is examined at the targets, not where contact stops the handles.
        at_rest = self._is_in_equilibrium and (self.share_reached < 1.0 or not self._stability.is_pending)
        return self.solver.progress.stuck or at_rest

    @property
    def _is_in_equilibrium(self) -> bool:
        """True if the shape is in equilibrium, stable or not."""
        return self._has_settled(self.solver.progress) and not self._kept.may_retry_dropped_goals

    def _has_settled(self, progress: SolverProgress) -> bool:
        converged = progress.converged
        if converged is None or not self._steps.has_steps:
            converged = self._steps.has_converged(self._convergence)
        elif self._steps.is_at_rounding_level and progress.may_rest and not progress.is_iterate_hidden:
            converged = True
        return progress.has_met_goals and converged

    def frame(self) -> Frame:
        """Shape after the last iteration, and its readings."""
        progress, settled = self.solver.progress, self.settled
        with cores_for(len(progress.U)):
            found = self.rest.measure(progress.U)
            regions = self._kept.region_areas(progress.U)
            energy = self.solver.energy
        return Frame(
            U=frozen(self.rest.to_mesh_coordinates(self._file_positions(progress))),
            iteration=self._iteration,
            **found._asdict(),
            area_error=found.area / self.rest.area - 1.0,
            handle_drift=self._held.drift(progress.held_positions),
            converged=settled and progress.has_met_goals and not progress.stuck and self.share_reached == 1.0,
            settled=settled,
            regions=regions,
            unreached=self._unreached_sentence(progress),
            energy=energy,
            stable=self._stability.is_stable if settled else None,
            saddle_escapes=self._stability.saddle_escapes,
            total=self._total,
            gap=self._steps.convergence_ratio(self._convergence)
            if progress.converged is None
            else progress.convergence_ratio,
            seconds_left=progress.seconds_left,
            share_reached=self.share_reached,
            **(contact_readings(at.contact, progress.U, at.shifts) if (at := self.contact) else {}),
        )

    @property
    def share_reached(self) -> float:
        """Fraction of the path to the targets completed, as far as contact allows."""
        return 1.0 if self.contact is None else self.contact.share_reached

    @property
    def is_on_its_way(self) -> bool:
        """True if the held vertices are still moving towards their targets."""
        return self.contact is not None and self.contact.is_on_its_way

    def _file_positions(self, progress: SolverProgress) -> np.ndarray:
        """Local positions of all vertices of the file."""
        spread = self.rest.weld.to_file_vertices(self.loose.with_followers(progress.U))
        if self.rest.weld.offset is not None and not self._traits.moves_handles:
            self._held.write_positions(spread, progress.held_positions)
        return spread

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about loose parts, a missing volume and open seams, a sentence each."""
        why = None if self.rest.volume_capped else self.rest.missing_volume_reason
        volume = tr("There is no volume: {why}.").format(why=why) if why else None
        said = self.loose.warning, volume, joints_sentence(self.solver.surface), *self.rest.seams.sentences
        return tuple(sentence for sentence in said if sentence)

    def readings(self, frame: Frame) -> tuple[RegionReading, ...]:
        """Readings of the regions in ``frame``."""
        return self._kept.readings(frame.regions)

    def target(self, name: str) -> float | None:
        """Target of "the area" or "the volume"; None without one."""
        return self._kept.target(name)

    @property
    def missed_goals_sentence(self) -> str | None:
        """Goals not met by the last frame, and their values; None if all are met."""
        return self._kept.missed_goals_sentence(self.solver.progress.goal_values)

    def _unreached_sentence(self, progress: SolverProgress) -> str | None:
        stopped = self.contact is not None and self.contact.is_stopped
        if stopped and progress.has_met_goals:  # otherwise goals, not contact, stop the handles
            return stop_sentence(self.share_reached, self.contact)
        return self._kept.out_of_reach_sentence(progress.goal_values if stopped or progress.stuck else None)
