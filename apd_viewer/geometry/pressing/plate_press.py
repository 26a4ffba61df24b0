"""Two plates that close on a mesh in steps, each at rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from numbers import Integral

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.contact.mesh_contact import thickness_of
from apd_viewer.geometry.contact.obstacles import direction, plate
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pressing.pressing import DEFAULT_OPTIONS, Pressing, PressOptions
from apd_viewer.language import tr

DEFAULT_STEPS, MOST_STEPS = 20, 1000
# For each step.
DEFAULT_ITERATIONS = 3000


@dataclass(frozen=True, eq=False)
class PressStep:
    """Shape between two plates at rest, and its readings.

    Attributes
    ----------
    U : (n, 3) float array
        Positions in the order of the file, mesh units, read-only.
    distance : float
        Of the plates from each other, mesh units.
    deflection : float
        How much nearer they are than at the first touch.
    load_low, load_high : float
        Force on the plate below and on the one above, energy per length: that of a material of stiffness 1.
        At rest, unless something is held, they are the same, and the slope of the energy as the plates close.
    energy : float
        Of the method, with that of the gaps; squared lengths.
    volume, volume_capped : float or None
        Enclosed volume; None if the surface is open. With flat caps over its openings; None without any.
    area_error : float
        ``area / rest area - 1``.
    crossings : int or None
        Triangles that cross others; None where that cannot be found.
    settled : bool
        The shape is at rest.
    iterations : int
    """

    U: np.ndarray
    distance: float
    deflection: float
    load_low: float
    load_high: float
    energy: float
    volume: float | None
    volume_capped: float | None
    area_error: float
    crossings: int | None
    settled: bool
    iterations: int


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
        self.axis, self._rest = direction(axis), rest
        _check_count(steps, MOST_STEPS, tr("The number of steps must be a whole number from 1 to {most:,}."))
        _check_count(iterations, 10**9, tr("The number of iterations must be a whole number of at least 1."))
        self._count, self._iterations = steps, iterations
        apart = thickness_of(rest.diagonal, options.thickness)
        height = rest.shape.V[np.unique(rest.shape.F)] @ self.axis
        self._low, self._high = float(height.min()) - apart, float(height.max()) + apart
        self.first = self._high - self._low
        if not 0.0 < to < self.first:
            raise InputError(
                tr(
                    "The plates are {first:.4g} apart at first; enter a smaller distance, and greater than 0."
                ).format(first=self.first)
            )
        # The middle of the bounding box: plates need a place across their axis, too.
        middle = 0.5 * (rest.shape.V.min(axis=0) + rest.shape.V.max(axis=0))
        middle = middle - (middle @ self.axis) * self.axis
        plates = [
            plate(middle + self._low * self.axis, self.axis, rest.diagonal),
            plate(middle + self._high * self.axis, -self.axis, rest.diagonal),
        ]
        self._way = self.first - to
        shifts = 0.5 * self._way * np.array([self.axis, -self.axis])
        self.pressing = Pressing(rest, plates, shifts, options)

    def steps(self, tick: Callable[[float], object] = lambda _: None) -> Iterator[PressStep]:
        """Press: the shapes at rest, from the first touch on.

        Parameters
        ----------
        tick : callable
            Called after every iteration with the share of the work that is done, at a guess; what it raises
            ends the work.
        """
        yield self._step()
        for k in range(self._count):
            self.pressing.aim((k + 1) / self._count)
            while not self.pressing.settled and self.pressing.iterations < self._iterations:
                self.pressing.iterate()
                done = self.pressing.iterations
                tick((k + done / (done + 200.0)) / self._count)
                if self.pressing.is_stopped:
                    break
            yield self._step()
            if self.pressing.is_stopped:
                return

    def _step(self) -> PressStep:
        pressing, rest = self.pressing, self._rest
        shape = pressing.U[rest.weld.first]
        found, crossed = rest.measure(shape), crossings(shape, rest.shape.F)
        low, high = pressing.loads @ self.axis
        gone = pressing.share * self._way
        return PressStep(
            U=frozen(pressing.U),
            distance=self.first - gone,
            deflection=gone,
            load_low=float(-low),
            load_high=float(high),
            energy=pressing.energy,
            volume=found.volume,
            volume_capped=found.volume_capped,
            area_error=found.area / rest.area - 1.0,
            crossings=None if crossed is None else len(crossed),
            settled=pressing.settled or not pressing.share,
            iterations=pressing.iterations,
        )


def _check_count(given: int, most: int, otherwise: str) -> None:
    if not isinstance(given, Integral) or not 1 <= given <= most:
        raise InputError(otherwise.format(most=most))
