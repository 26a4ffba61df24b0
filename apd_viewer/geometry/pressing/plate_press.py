"""Two plates that close on a mesh in steps, each at rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.contact.contact_obstacles import Obstacle, plate
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import check_argument, diagonal, frozen, is_whole_number
from apd_viewer.geometry.pressing.plate_travel import plate_travel
from apd_viewer.geometry.pressing.press_options import DEFAULT_OPTIONS, PressOptions
from apd_viewer.geometry.pressing.press_solver import PressSolver
from apd_viewer.geometry.pressing.press_step import PressStep
from apd_viewer.language import tr

DEFAULT_STEPS, MOST_STEPS = 20, 1000
# For each step.
DEFAULT_ITERATIONS = 10_000
# Plates that are stopped try again so many times.
_RETRIES = 5
# Plates that open touch while they carry this part of what they carried.
_TOUCHES = 1e-9


class PlatePress:
    """Two parallel plates that close on a mesh in equal steps.

    They touch it at first. With nothing held the mesh may slide between them, but not turn as a whole.

    Parameters
    ----------
    rest : RestMesh
    axis : (3,) float array
        Direction in which they press.
    to : float
        Their distance in the end, mesh units; less than the extent of the mesh.
    steps, iterations : int
        Number of steps, and at most so many iterations for each.
    options : PressOptions

    Attributes
    ----------
    travel : PlateTravel
    solver : PressSolver

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.
    """

    def __init__(
        self,
        rest: RestMesh,
        axis: np.ndarray,
        to: float,
        steps: int = DEFAULT_STEPS,
        iterations: int = DEFAULT_ITERATIONS,
        options: PressOptions = DEFAULT_OPTIONS,
    ) -> None:
        _check_count(steps, MOST_STEPS, tr("The number of steps must be a whole number from 1 to {most:,}."))
        check_argument("iterations", iterations)
        self._rest, self._asked = rest, (axis, to, contact_thickness(rest.diagonal, options.thickness))
        self._count, self._iterations = steps, iterations
        self._relaxes = options.start is not None
        if self._relaxes:
            self.solver = PressSolver(rest, (), np.zeros((0, 3)), options)
            self._plates_around(self.solver.solve_positions)
        else:
            self.solver = PressSolver(rest, *self._plates_around(rest.solve_mesh.V), options)

    def _plates_around(self, U: np.ndarray) -> tuple[list[Obstacle], np.ndarray]:
        """Plates at a local shape ``U`` (k, 3) of the solve, and their ways (2, 3)."""
        X = U[np.unique(self._rest.solve_mesh.F)]
        self.travel = way = plate_travel(X, *self._asked)
        # The middle of the bounding box: plates need a place across their axis, too.
        middle, size = 0.5 * (X.min(axis=0) + X.max(axis=0)), diagonal(X)
        middle = middle - (middle @ way.axis) * way.axis
        plates = [
            plate(middle + way.low * way.axis, way.axis, size),
            plate(middle + way.high * way.axis, -way.axis, size),
        ]
        return plates, 0.5 * way.length * np.array([way.axis, -way.axis])

    def steps(self, tick: Callable[[float], object] = lambda _: None) -> Iterator[PressStep]:
        """Press: the shapes at rest, from the first touch on.

        A shape to begin from comes to rest by itself before the plates touch it.

        Parameters
        ----------
        tick : callable
            Called after every iteration with the share of the work that is done, at a guess; what it raises
            ends the work.
        """
        if self._relaxes:
            self.settle_at(0.0, partial(_tick_at, tick, 0, self._count))
            if not self.solver.has_met_goals:
                raise InputError(
                    tr("The shape to begin from has another area or volume; deform it with the same targets.")
                )
            self.solver.replace_obstacles(*self._plates_around(self.solver.solve_positions))
        yield self._step(settled=True)
        for k in range(self._count):
            self.settle_at((k + 1) / self._count, partial(_tick_at, tick, k, self._count))
            yield self._step(self.solver.settled)
            if self.solver.is_stopped:
                return

    def release(self, tick: Callable[[float], object] = lambda _: None) -> Iterator[PressStep]:
        """Open the plates again: the shapes at rest, until the plates no longer touch.

        Parameters
        ----------
        tick : callable
            As of :meth:`steps`.
        """
        share, k = self.solver.share, 0
        touching = _TOUCHES * np.abs(self.solver.loads).max()
        while share > 0.0 and np.abs(self.solver.loads).max() > touching:
            share = max(0.0, share - 1.0 / self._count)
            self.settle_at(share, partial(_tick_at, tick, k, self._count))
            k += 1
            yield self._step(self.solver.settled)

    def settle_at(self, share: float, tick: Callable[[float], object]) -> None:
        """Go to a share of the way, and come to rest there, as far as iterations suffice.

        Walls in the way of the plates may give way once they have come to rest.
        """
        self._go_to(share, tick)
        for _ in range(_RETRIES):
            if not self.solver.is_stopped:
                return
            self._go_to(self.solver.share, tick)
            self._go_to(share, tick)

    def _go_to(self, share: float, tick: Callable[[float], object]) -> None:
        pressing = self.solver
        pressing.aim(share)
        while not pressing.settled and pressing.iterations < self._iterations and not pressing.is_stopped:
            pressing.iterate()
            tick(pressing.iterations / (pressing.iterations + 200.0))

    def _step(self, settled: bool) -> PressStep:
        pressing, rest = self.solver, self._rest
        found, crossed = (
            rest.measure(pressing.solve_positions),
            crossings(pressing.solve_positions, rest.solve_mesh.F),
        )
        low, high = pressing.loads @ self.travel.axis
        gone = pressing.share * self.travel.length
        return PressStep(
            U=frozen(pressing.U),
            distance=self.travel.first_distance - gone,
            deflection=gone,
            load_low=float(-low),
            load_high=float(high),
            stretching=pressing.stretching,
            energy=pressing.energy,
            volume=found.volume,
            volume_capped=found.volume_capped,
            area_error=found.area / rest.area - 1.0,
            crossings=None if crossed is None else len(crossed),
            settled=settled,
            iterations=pressing.iterations,
        )


def _tick_at(tick: Callable[[float], object], step: int, count: int, done: float) -> None:
    tick((step + done) / count)


def _check_count(given: int, most: int, otherwise: str) -> None:
    if not is_whole_number(given) or not 1 <= given <= most:
        raise InputError(otherwise.format(most=most))
