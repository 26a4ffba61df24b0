"""Press of two plates closing on a mesh in steps, each with an equilibrium shape."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.contact.contact_obstacles import Obstacle, plate, shifted_obstacles
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.energy.cell_bending import cell_stiffness, load_excess
from apd_viewer.geometry.energy.membrane import Membrane
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.geometry.goals.goal_projection import GOAL_TOLERANCE
from apd_viewer.geometry.mesh.arrays import (
    as_float,
    check_argument,
    checked_direction,
    diagonal,
    is_whole_number,
    used_vertices,
)
from apd_viewer.geometry.solver.contact_descent import ContactDescent
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.held_vertices import checked_start
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, method_named
from apd_viewer.language import tr

DEFAULT_STEPS, MOST_STEPS = 20, 1000
# Largest number of iterations per step.
DEFAULT_ITERATIONS = 10_000
# Attempts to move on once contact has stopped the plates.
_RETRIES = 5
# Fraction of the load before opening, above which opening plates still touch.
_TOUCHES = 1e-9
# Energy per area below which it is mere rounding error; corresponds to strains of 1e-6.
_NO_ENERGY = 1e-12


class PlatePress:
    """Two parallel plates closing on a mesh in equal steps.

    Initially they touch the mesh. Without held vertices it may slide between them, but not rotate as a whole.
    A mesh is filled to a larger volume in cubic mesh units before the plates touch it.

    Parameters
    ----------
    rest : RestMesh
    axis : (3,) float array
        Direction in which they press.
    to : float or str
        Final distance of the plates, mesh units; less than the extent of the mesh. Text such as ``"50%"`` is
        a percentage of the extent at the first touch.
    steps, iterations : int
        Number of steps, and at most so many iterations for each.
    fixed : (k,) ints
        Vertices that are held where they are at rest; none need be.
    start : (n, 3) float array or None
        Shape to begin from, such as a twisted one; None for the shape at rest.
    settings
        Other arguments of :class:`Deformation`.

    Attributes
    ----------
    travel : PlateTravel
    solver : Deformation

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.
    """

    def __init__(
        self,
        rest: RestMesh,
        axis: np.ndarray,
        to: float | str,
        steps: int = DEFAULT_STEPS,
        iterations: int = DEFAULT_ITERATIONS,
        *,
        fixed: Sequence[int] | np.ndarray = (),
        start: np.ndarray | None = None,
        **settings: Any,
    ) -> None:
        _check_count(steps, MOST_STEPS, tr("The number of steps must be a whole number from 1 to {most:,}."))
        check_argument("iterations", iterations)
        if not method_named(settings.get("method", DEFAULT_METHOD)).may_use_contact:
            raise InputError(tr("Only the methods Exact, Local, Wall and ARAP press; choose one of them."))
        apart = contact_thickness(rest.diagonal, settings.get("thickness"))
        self._rest, self._asked = rest, (axis, to, apart)
        self._count, self._iterations = steps, iterations
        # A given start shape first relaxes to equilibrium, and a bag is filled, with the plates set apart.
        self._has_start = start is not None
        self._relaxes = self._has_start or _is_to_be_filled(rest, settings)
        U = rest.solve_mesh.V if start is None else checked_start(start, rest)[rest.weld.first]
        plates = self._plates_around(U, aside=rest.diagonal if self._relaxes else 0.0)
        settings |= {"obstacles": shifted_obstacles(plates, rest.centre), "contact": True, "calm": False}
        self.solver = Deformation(rest.V, rest.F, fixed, rest=rest, **settings)
        # Plates in local coordinates are exact even far from the origin, and so are their loads.
        self._contact.replace_obstacles(plates)
        self._targets = (rest.to_mesh_coordinates(rest.V) if start is None else start)[self.solver.fixed]
        self._from = self._to = 0.0
        if start is None:
            self._contact.restart(U)
            return
        if not self._contact.contact.can_start_at(U):
            raise InputError(tr("The initial shape intersects itself; deform it with walls kept apart."))
        self.solver.aim(self._targets, start)

    def _plates_around(self, U: np.ndarray, aside: float = 0.0) -> list[Obstacle]:
        """Plates on both sides of a local shape ``U`` (k, 3), ``aside`` away from it."""
        X, (axis, to, apart) = U[used_vertices(self._rest.solve_mesh.F)], self._asked
        # How far plates close is known once they touch.
        self.travel = way = plate_travel(X, axis, "50%" if aside else to, apart)
        # Centre of the bounding box: plates also need a position perpendicular to their axis.
        middle, size = 0.5 * (X.min(axis=0) + X.max(axis=0)), diagonal(X)
        middle = middle - (middle @ way.axis) * way.axis
        self._shifts = 0.5 * way.length * np.array([way.axis, -way.axis])
        return [
            plate(middle + (way.low - aside) * way.axis, way.axis, size),
            plate(middle + (way.high + aside) * way.axis, -way.axis, size),
        ]

    @property
    def _contact(self) -> ContactDescent:
        assert self.solver.contact is not None
        return self.solver.contact

    @property
    def travel_fraction(self) -> float:
        """Fraction of the plates' travel completed."""
        return self._from + self._contact.path_fraction * (self._to - self._from)

    @property
    def is_stopped(self) -> bool:
        """True if the plates can move no further."""
        return self._contact.is_stopped

    @property
    def load_excess(self) -> float | None:
        """Expected overestimate of the loads; see :func:`load_excess`."""
        shape = self._rest.solve_mesh
        return load_excess(self._contact.surface.material, cell_stiffness(shape.V, shape.F))

    def steps(self, tick: Callable[[float], object] = lambda _: None) -> Iterator[PressStep]:
        """Press the mesh; yield the equilibrium shapes from the first contact on.

        A given start shape relaxes to equilibrium before the plates touch it.

        Parameters
        ----------
        tick : callable
            Called after every iteration with the estimated fraction of the work done; an exception raised by
            it ends the work.
        """
        settled = True
        if self._relaxes:
            self.settle_at(0.0, partial(_tick_at, tick, 0, self._count))
            if self._has_start and not self._contact.progress.has_met_goals:
                raise InputError(
                    tr("The initial shape has another area or volume; deform it with the same targets.")
                )
            settled = self.solver.settled and self._contact.progress.has_met_goals
            U = self._contact.progress.U
            self._contact.replace_obstacles(self._plates_around(U))
            self._contact.restart(U)
            self.set_target(0.0)
        yield self._step(settled)
        for k in range(self._count):
            self.settle_at((k + 1) / self._count, partial(_tick_at, tick, k, self._count))
            yield self._step(self.solver.settled)
            if self.is_stopped:
                return

    def release(self, tick: Callable[[float], object] = lambda _: None) -> Iterator[PressStep]:
        """Open the plates; yield the equilibrium shapes until they no longer touch.

        Parameters
        ----------
        tick : callable
            As of :meth:`steps`.
        """
        fraction, k = self.travel_fraction, 0
        touching = _TOUCHES * self._largest_load
        while fraction > 0.0 and self._largest_load > touching:
            fraction = max(0.0, fraction - 1.0 / self._count)
            self.settle_at(fraction, partial(_tick_at, tick, k, self._count))
            k += 1
            yield self._step(self.solver.settled)

    @property
    def _largest_load(self) -> float:
        return float(np.abs(self.solver.frame().loads).max())

    def settle_at(self, fraction: float, tick: Callable[[float], object] = lambda _: None) -> None:
        """Move the plates to a fraction of their travel, and iterate to equilibrium.

        Walls in the way of the plates may give way once they have come to rest.
        """
        self._go_to(fraction, tick)
        for _ in range(_RETRIES):
            if not self.is_stopped:
                return
            self._go_to(self.travel_fraction, tick)
            self._go_to(fraction, tick)

    def set_target(self, fraction: float) -> None:
        """Set the plates' next target, a fraction of their travel."""
        self._from, self._to = self.travel_fraction, fraction
        self.solver.aim(self._targets, shifts=fraction * self._shifts)

    def _go_to(self, fraction: float, tick: Callable[[float], object]) -> None:
        self.set_target(fraction)
        solver, count = self.solver, 0
        while not solver.settled and count < self._iterations and not self.is_stopped:
            solver.iterate()
            count += 1
            tick(count / (count + 200.0))

    def _step(self, settled: bool) -> PressStep:
        frame, rest = self.solver.frame(), self._rest
        crossed = crossings(self._contact.progress.U, rest.solve_mesh.F)
        low, high = frame.loads @ self.travel.axis
        gone = self.travel_fraction * self.travel.length
        return PressStep(
            U=frame.U,
            distance=self.travel.first_distance - gone,
            deflection=gone,
            load_low=float(-low),
            load_high=float(high),
            stretching=self._stretching,
            energy=self._contact.energy_in_contact,
            volume=frame.volume,
            volume_capped=frame.volume_capped,
            area_error=frame.area_error,
            crossings=None if crossed is None else len(crossed),
            settled=settled,
            stable=frame.stable,
            iterations=frame.iteration,
        )

    @property
    def _stretching(self) -> float:
        """Fraction of the elastic energy due to stretching, 0 to 1."""
        surface = self._contact.surface
        if isinstance(surface, WallSurface):
            return surface.stretching_fraction
        if surface.energy <= _NO_ENERGY * self._rest.area:
            return 0.0
        self._membrane.local_step(surface.U)
        return min(1.0, self._membrane.energy / surface.energy)

    @cached_property
    def _membrane(self) -> Membrane:
        """Membrane with the wall's stretching energy alone, without bending."""
        shape, material = self._rest.solve_mesh, self._contact.surface.material
        return Membrane(shape.V, shape.all_triangles, 2.0 * material.rigidity + material.shear, material.area)


def _tick_at(tick: Callable[[float], object], step: int, count: int, done: float) -> None:
    tick((step + done) / count)


def _check_count(given: int, most: int, otherwise: str) -> None:
    if not is_whole_number(given) or not 1 <= given <= most:
        raise InputError(otherwise.format(most=most))


@dataclass(frozen=True, eq=False)
class PressStep:
    """Shape between two plates after a step, and its readings.

    Attributes
    ----------
    U : (n, 3) float array
        Positions in the order of the file, mesh units, read-only.
    distance : float
        Distance of the plates, mesh units.
    deflection : float
        Reduction of the distance since first contact.
    load_low, load_high : float
        Force on the plate below and on the one above, energy per length: that of a material of stiffness 1.
        At rest, unless something is held, they are the same, and the slope of the energy as the plates close.
    stretching : float
        Fraction of the wall's energy due to stretching, 0 to 1; the rest is due to bending.
    energy : float
        Energy of the method, including gaps; squared lengths.
    volume, volume_capped : float or None
        Enclosed volume; None if the surface is open. With flat caps over its openings; None without any.
    area_error : float
        ``area / rest area - 1``.
    crossings : int or None
        Triangles that cross others; None where that cannot be found.
    settled : bool
        The shape is at rest.
    stable : bool or None
        True at a minimum of the energy as far as examined, False on a saddle; None if not examined.
    iterations : int

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> plates = {"axis": (0, 0, 1), "to": 1.8, "steps": 1}
    >>> first, last = apd_viewer.press(ball.vertices, ball.faces, **plates, stiffness=0.01).steps
    >>> bool(last.load_low > first.load_low), bool(last.volume < first.volume)
    (True, True)
    """

    U: np.ndarray
    distance: float
    deflection: float
    load_low: float
    load_high: float
    stretching: float
    energy: float
    volume: float | None
    volume_capped: float | None
    area_error: float
    crossings: int | None
    settled: bool
    stable: bool | None
    iterations: int

    @property
    def load(self) -> float:
        """Mean load on both plates."""
        return 0.5 * (self.load_low + self.load_high)


class PlateTravel(NamedTuple):
    """Travel of two parallel plates.

    Attributes
    ----------
    axis : (3,) float array
        Direction in which they press, of length 1.
    low, high : float
        Places of the plates along the axis at the first touch, mesh units.
    last_distance : float
        Final distance of the plates, mesh units.
    """

    axis: np.ndarray
    low: float
    high: float
    last_distance: float

    @property
    def first_distance(self) -> float:
        """Distance of the plates at first contact."""
        return self.high - self.low

    @property
    def length(self) -> float:
        """Distance by which the plates close."""
        return self.first_distance - self.last_distance


def _fraction(text: str) -> float:
    """Fraction from text such as ``"50%"``; NaN if it is none."""
    number = text.strip().removesuffix("%")
    try:
        return 0.01 * float(number)
    except ValueError:
        return np.nan


def _is_to_be_filled(rest: RestMesh, settings: Mapping[str, Any]) -> bool:
    """True if a pressure, or a volume larger than at rest, is asked for."""
    if settings.get("pressure") is not None:
        return True
    asked = settings.get("filled_volume")
    return asked is not None and as_float(asked) > (1.0 + GOAL_TOLERANCE) * (rest.volume_capped or 0.0)


def plate_travel(
    points: np.ndarray, axis: np.ndarray, to: float | str, thickness: float | None
) -> PlateTravel:
    """Travel of plates from first contact with ``points`` to a distance ``to``.

    Parameters
    ----------
    points : (k, 3) float array
        Vertices of a mesh, without loose ones.
    axis : (3,) float array
    to : float or str
        Mesh units, or text such as ``"50%"`` of the extent of the points; less than that.
    thickness : float or None
        Distance that plates and walls keep, mesh units; None for a thousandth of the diagonal.

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.
    """
    axis, apart = checked_direction(axis), contact_thickness(diagonal(points), thickness)
    height = points @ axis
    if isinstance(to, str):
        to = _fraction(to) * float(np.ptp(height))
    way = PlateTravel(axis, float(height.min()) - apart, float(height.max()) + apart, to)
    if not 0.0 < as_float(to) < way.first_distance:
        raise InputError(
            tr("The plates start {first:.4g} apart; enter a smaller distance greater than 0.").format(
                first=way.first_distance
            )
        )
    return way
