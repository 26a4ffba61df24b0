"""Descent of a surface without crossing itself or obstacles.

Before the first contact, the shapes are those of a solver without contact, each reached by a collision-free
step. From then on the surface descends in contact with itself, until new targets are set while nothing
touches.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse.csgraph import connected_components

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.contact.mesh_contact import mesh_contact
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.enclosed_gas import EnclosedVolume
from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_path import HeldPath
from apd_viewer.geometry.solver.constrained_descent import ENERGY_TOLERANCE
from apd_viewer.geometry.solver.iterative_solver import IterativeSolver, SolverProgress
from apd_viewer.geometry.solver.loose_components import LooseComponents
from apd_viewer.geometry.solver.methods import Method
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium
from apd_viewer.geometry.solver.touching_descent import TouchingDescent
from apd_viewer.geometry.solver.touching_surface import (
    CollisionFreeProjection,
    TouchingElasticSurface,
    TouchingSurface,
)
from apd_viewer.geometry.solver.touching_wall import TouchingWall
from apd_viewer.language import tr

# Path increment in mesh sizes, and number of steps between two increments.
_PART, _STEPS = 0.05, 10
# Stiffness of the gaps of a thin wall, by its thickness in mesh sizes: stiffer gaps would hardly close under
# small bending forces, softer ones would vanish under denting forces.
_SOFTNESS = 10.0
# Area relative to that at rest, above which a pressure is too high: materials yield or tear before.
_MOST_AREA = 2.0
_NO_STEP = 1e-9  # of the size: a step of a shape that nothing moves
# Number of blocked substeps taken as a sign of contact: the first shapes after a motion may be rough.
_PATIENCE = 60


def check_contact(method: Method, plain: bool) -> None:
    """Raise InputError unless the iterations of a method can keep walls apart."""
    if plain and method.is_wall:
        raise InputError(tr("The method Wall has no plain iterations; omit their number."))
    if plain or not method.may_use_contact:
        raise InputError(
            tr(
                "Contact needs one of the methods Exact, Local, Wall and ARAP, and no number of plain "
                "iterations; choose another method, or deform without contact."
            )
        )


def check_obstacles(obstacles: Sequence[Obstacle], contact: bool) -> None:
    """Raise InputError unless all are obstacles, and contact is on if there are any."""
    listed = isinstance(obstacles, Sequence) and not isinstance(obstacles, str | bytes)
    if not listed or not all(isinstance(each, Obstacle) for each in obstacles):
        raise InputError(tr("Obstacles must be a list made with plate, sphere and capsule."))
    if len(obstacles) and not contact:
        raise InputError(tr("Obstacles need contact; switch it on, or remove the obstacles."))


def needs_contact(
    method: Method,
    contact: bool,
    yield_radius: float | None,
    gas: float | None,
    pressure: float | None,
    *volumes: float | str | None,
) -> bool:
    """True if gas or creases need contact.

    Raises
    ------
    InputError
        If contact is off then, or a pressure meets another method, gas or a target among the ``volumes``. A
        vacuum needs contact, too: a surface that passes through itself would turn inside out.
    """
    needed = gas is not None or yield_radius is not None
    if needed and not contact:
        raise InputError(tr("Creases and gas need contact; switch it on, or omit them."))
    if pressure is None:
        return needed
    if not method.is_wall:
        raise InputError(tr("Only the method Wall has a pressure; choose it, or omit the pressure."))
    if any(other is not None for other in (gas, *volumes)):
        raise InputError(
            tr("A pressure, enclosed gas and a kept volume exclude each other; give one of them.")
        )
    if pressure < 0.0 and not contact:
        raise InputError(tr("Reduced pressure needs contact; switch it on, or omit the pressure."))
    return needed


def stop_sentence(fraction: float, contact: ContactDescent | None = None) -> str:
    """Sentence about what is stopped: the wall by itself, or a handle or obstacle."""
    if contact is not None and contact.is_overstretched:
        return tr("The pressure stretches the wall to twice its area and more; enter less.")
    moves = (contact.path.moves_held, contact.path.moves_obstacles) if contact else (True, False)
    said = {
        (True, True): tr("Contact stops handle and obstacle at {percent:.0f} % of the path."),
        (False, True): tr("Contact stops the obstacle at {percent:.0f} % of the path."),
    }.get(moves, tr("Contact stops the handle at {percent:.0f} % of the path."))
    return said.format(percent=math.floor(100.0 * fraction))


def whole_path_frame(frame: Frame, leg: int, legs: int, contact: ContactDescent | None) -> Frame:
    """Frame of a path segment, with fraction and stop sentence of the whole path."""
    fraction = (leg + (1.0 if contact is None else contact.path_fraction)) / legs
    stopped = frame.share_reached < 1.0 and frame.unreached is not None
    said = stop_sentence(fraction, contact) if stopped else frame.unreached
    return replace(frame, share_reached=fraction, unreached=said)


def contact_descent(
    inner: IterativeSolver | WallSurface,
    goals: tuple[Goal, ...],
    rest: RestMesh,
    handle_of: np.ndarray,
    thickness: float | None = None,
    loose: LooseComponents | None = None,
    obstacles: Sequence[Obstacle] = (),
    gas: EnclosedVolume | None = None,
    touches: bool = True,
) -> ContactDescent:
    """Solver keeping all shapes free of collisions with themselves and obstacles.

    Parameters
    ----------
    inner : IterativeSolver or WallSurface
        Steps without contact; a wall has none.
    goals : tuple of Goal
        Of the inner solver too.
    rest : RestMesh
    handle_of : (k + s,) int array
        Handle of the held and soft vertices, counted from 1; 0 for the base. Where there is no handle, each
        connected part of the held vertices is taken for one.
    thickness : float, optional
        Distance that walls keep, mesh units.
    loose : LooseComponents, optional
        Loose parts carried along by the surface; without, they are left out.
    obstacles : sequence of Obstacle
        The surface enters among them with its first step.
    gas : EnclosedVolume, optional
    touches : bool
        Without, the surface passes through itself; only a wall can.
    """
    surface = inner if isinstance(inner, WallSurface) else inner.surface
    shape, fixed = rest.solve_mesh, surface.fixed
    if len(fixed) and not handle_of.any():
        handle_of = connected_components(shape.L[fixed][:, fixed])[1] + 1
    softness = 1.0
    if isinstance(inner, WallSurface) and not surface.material.is_relaxed:
        softness = min(1.0, _SOFTNESS * surface.material.thickness / rest.diagonal)
    held = shape, fixed, handle_of[: len(fixed)], rest.diagonal, thickness
    contact = mesh_contact(*held, loose, softness=softness, touches=touches)
    return ContactDescent(inner, goals, contact, handle_of, obstacles, gas)


class ContactDescent:
    """Collision-free steps of a surface in contact with itself and obstacles.

    Without held vertices, obstacles alone move the surface: it slides until all forces are balanced, and does
    not rotate as a whole. All steps are then steps in contact, as with gas or creases, which the inner solver
    does not support, and as for a wall, which has no inner solver.

    Parameters
    ----------
    inner : IterativeSolver or WallSurface
        Steps without contact; a wall has none.
    goals : tuple of Goal
        Of the inner solver too.
    contact : Contact
    handle_of : (k + s,) int array
        Held and soft vertices of one number move as one.
    obstacles : sequence of Obstacle
    gas : EnclosedVolume, optional

    Attributes
    ----------
    surface : HeldSurface
    contact : Contact
    held_positions : (k + s, 3) float array
        Positions that the held vertices have reached, then the targets of the soft ones.
    path : HeldPath
        Path to the targets.
    path_fraction : float
        Completed fraction of the path.
    shifts : (o, 3) float array
        Displacements reached by the obstacles.
    target_shifts : (o, 3) float array
        Displacements of the obstacles at the targets of :meth:`set_targets`.
    start_shifts : (o, 3) float array or None
        Displacements at the shape of the next :meth:`restart`; None for the current ones.
    """

    def __init__(
        self,
        inner: IterativeSolver | WallSurface,
        goals: tuple[Goal, ...],
        contact: Contact,
        handle_of: np.ndarray,
        obstacles: Sequence[Obstacle] = (),
        gas: EnclosedVolume | None = None,
    ) -> None:
        self._inner = None if isinstance(inner, WallSurface) else inner
        self.surface: HeldSurface = inner if isinstance(inner, WallSurface) else inner.surface
        self.contact, self.gas = contact, gas
        softened = gas or self.surface.creases
        self._always_touches = not (self._inner and len(self.surface.fixed)) or bool(softened)
        self._goals, self._handle_of = goals, handle_of
        self._tolerance, self._refused = ENERGY_TOLERANCE, 0
        self._touching: TouchingDescent | None = None
        self._U = V = self.surface.rest.V
        self._size = float(np.linalg.norm(np.ptp(V, axis=0)))
        self._at_rest = np.concatenate([V[self.surface.fixed], V[self.surface.soft.ids]])
        self.held_positions = self._targets = self._at_rest
        self.replace_obstacles(obstacles)

    @property
    def progress(self) -> SolverProgress:
        """Shape and readings, marked as not to be displayed before the end of the path.

        No time left is estimated before contact.
        """
        running = self._touching or self._inner
        assert running is not None
        progress = running.progress
        progress = progress._replace(U=self._U, held_positions=self.held_positions)
        if self.is_overstretched:
            return progress._replace(stuck=True)
        if self.is_on_its_way:
            return progress._replace(
                is_iterate_hidden=True, converged=False, convergence_ratio=None, seconds_left=None
            )
        hidden = progress.is_iterate_hidden or (self._touching is None and self._refused > 0)
        return progress._replace(is_iterate_hidden=hidden)

    @property
    def energy(self) -> float | None:
        """Elastic energy of the displayed shape, without contact; None if unknown."""
        return self.surface.energy if self._touching or self._inner is None else self._inner.energy

    @property
    def energy_in_contact(self) -> float:
        """Energy of the displayed shape, including gap and gas energy."""
        return self._touching_surface.energy

    @property
    def _touching_surface(self) -> TouchingSurface:
        if isinstance(self.surface, WallSurface):
            return TouchingWall(self.surface, self.contact, self.gas)
        assert isinstance(self.surface, ElasticSurface)
        return TouchingElasticSurface(self.surface, self.contact, self.gas)

    @property
    def load_imbalance(self) -> float:
        """Length of the sum of all loads over the sum of their lengths; 0 if held."""
        return self._touching.load_imbalance if self._touching else 0.0

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""
        return self._inner is None or self._inner.ready

    @property
    def share_reached(self) -> float:
        """Completed fraction of the path from rest to the targets."""
        left = (1.0 - self.path_fraction) * self.path.length
        return 1.0 - left / max(self._whole, left) if left else 1.0

    @property
    def is_stopped(self) -> bool:
        """True if contact stops the held vertices, or a pressure is too high."""
        return self.is_overstretched or (self._touching is not None and self._touching.is_stopped)

    @property
    def is_on_its_way(self) -> bool:
        """True if held vertices or obstacles are still moving along their path."""
        return self.path_fraction < 1.0 and not self.is_stopped

    @property
    def is_overstretched(self) -> bool:
        """True if a pressure stretches the surface more than any wall."""
        if self.gas is None or not self.gas.metric_pressure:
            return False
        patch = self.surface.rest.all_triangles
        return patch.area(self._U) > _MOST_AREA * patch.area(self.surface.rest.V)

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Surface in contact and in equilibrium, for the stability search; None if none."""
        if self._touching or self._inner is None:
            return self._touching.equilibrium if self._touching else None
        inner = self._inner.equilibrium
        if inner is None:
            return None
        surface = self._touching_surface
        projection = CollisionFreeProjection(surface, self._goals)
        projection.refresh_directions(surface.U)
        return inner._replace(surface=surface, projection=projection)

    def set_tolerance(self, tolerance: float) -> None:
        """Set the tolerance on the relative energy decrease over ten steps."""
        self._tolerance = tolerance
        if self._inner:
            self._inner.set_tolerance(tolerance)
        if self._touching:
            self._touching.tolerance = tolerance

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Replace the goals."""
        self._goals = goals
        if self._inner:
            self._inner.set_goals(goals)
        if self._touching:
            self._begin_contact()
        self._set_path()

    def replace_obstacles(self, obstacles: Sequence[Obstacle]) -> None:
        """Replace the obstacles; they take effect with :meth:`restart`.

        Otherwise the surface starts from the rest shape at the next step.
        """
        self.contact.replace_obstacles(obstacles)
        self.shifts = self.target_shifts = self._places = np.zeros((len(obstacles), 3))
        self._before = self._U, self.shifts
        self._is_inside = not obstacles
        self.start_shifts: np.ndarray | None = None
        self._touching = self._touching_descent() if self._always_touches else None
        self._set_path()

    def restart(self, U: np.ndarray) -> None:
        """Continue from positions ``U`` (n, 3), or from the rest shape if they intersect.

        If ``U`` intersects the obstacles at their start, they start at their initial positions.

        Raises
        ------
        InputError
            If not even the rest shape is clear of obstacles at their initial positions.
        """
        shifts, self.start_shifts = self.start_shifts, None
        if shifts is None:
            # U may be the previous shape, with shifts of its own.
            shifts = self._before[1] if U is self._before[0] else self.shifts
        rest, places = self.surface.rest.V, self._places
        ways = [(U, shifts), (U, places), (rest, places)]
        found = next((way for way in ways if self.contact.can_start_at(*way)), None)
        if found is None and len(places) and not self.contact.is_clear(rest, places):
            raise InputError(tr("An obstacle intersects the initial shape; move it away, or remove it."))
        U, self.shifts = found or (rest, places)
        self.contact.start_at(U, self.shifts)
        self._U, self._is_inside, self._refused = U, True, 0
        self.held_positions = np.concatenate([U[self.surface.fixed], U[self.surface.soft.ids]])
        self._end_contact()
        self._set_path()

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the targets (k + s, 3) of held and soft vertices, with a path to them."""
        self._targets, self.start_shifts = targets, None
        if self._touching and not (self.contact.may_touch or self.is_on_its_way):
            self._end_contact()
        self._set_path()

    def _set_path(self) -> None:
        ends = np.array([self.shifts, self.target_shifts])
        self.path = HeldPath(self.held_positions, self._targets, self._handle_of, ends)
        ends = np.array([self._places, self.target_shifts])
        self._whole = HeldPath(self._at_rest, self._targets, self._handle_of, ends).length
        self.path_fraction = 0.0 if self.path.length else 1.0
        self._part = _PART * self._size / max(self.path.length, _PART * self._size)
        self._ahead = max(self.path_fraction, self._part)
        self._steps = 0
        if self._touching:
            self._touching.follow_path(self.path, self.path_fraction)
        elif self._inner:
            self._inner.set_targets(self.path.positions_at(self._ahead))

    def step(self) -> None:
        """Do a collision-free step; see :meth:`restart`."""
        if not self._is_inside:
            self.start_shifts = self._places
            self.restart(self.surface.rest.V)
        self._before = self._U, self.shifts
        if self._touching is None:
            self._step_freely()
        else:
            self._touching.step()
            self._U, self.path_fraction, self.held_positions = (
                self._touching.U,
                self._touching.path_fraction,
                self._touching.held_positions,
            )
            self.shifts = self.path.shifts_at(self.path_fraction)

    def _step_freely(self) -> None:
        """Accept the inner solver's next shape if the step to it is collision-free."""
        assert self._inner is not None
        assert isinstance(self.surface, ElasticSurface)
        self._steps += 1
        self._inner.step()
        progress, shifts = self._inner.progress, self.path.shifts_at(self._ahead)
        W = progress.U
        stands = W is self._U and (self.path.moves_held or self.path_fraction == self._ahead)
        if stands or self.contact.move_to(W, shifts):
            if not stands:
                self._U, self.path_fraction, self.held_positions, self._refused = (
                    W,
                    self._ahead,
                    progress.held_positions,
                    0,
                )
                self.shifts = shifts
            if self.surface.factor.ready and self._rests_at_gaps(progress.converged):
                self._begin_contact()
        elif self.surface.factor.ready:  # contact steps need the factor
            self._refused += self.contact.examined_parts
            # The shapes of the inner solver will not give way to an obstacle that comes.
            is_pushed = self.contact.is_blocked_by_obstacle and not self.path.moves_held
            if is_pushed or self._refused >= _PATIENCE or progress.converged:
                self._begin_contact()
                self.step()
                return
        # Without the factor, previews may stop improving; move on before the usual number of steps.
        if self.path_fraction == self._ahead < 1.0 and (self._steps >= _STEPS or not self._inner.ready):
            self._ahead, self._steps = min(1.0, self._ahead + self._part), 0
            self._inner.set_targets(self.path.positions_at(self._ahead))

    def _rests_at_gaps(self, converged: bool | None) -> bool:
        """True if a shape that nothing else moves has gaps with a force.

        A gap may become small without a blocked step, but there is no rest without its force.
        """
        if self.path_fraction < 1.0 or not self.contact.energy_at(self._U):
            return False
        step = float(np.abs(self._U - self._before[0]).max(initial=0.0))
        return converged is not False or step <= _NO_STEP * self._size

    def _begin_contact(self) -> None:
        """Continue with contact from the last shape."""
        self._touching = self._touching_descent()
        self._touching.follow_path(self.path, self.path_fraction)

    def _touching_descent(self) -> TouchingDescent:
        surface = self._touching_surface
        return TouchingDescent(surface, self._U, self.held_positions, self._goals, self._tolerance)

    def _end_contact(self) -> None:
        """Continue without contact from the last shape, if allowed."""
        if self._inner and not self._always_touches:
            self._touching = None
            self._inner.restart(self._U)
        elif self._touching is None or self._touching.U is not self._U:
            self._touching = self._touching_descent()
