"""Pressing of a mesh between two plates in one call.

The words are those of the column crush test [ASTM D2659, Standard test method for column crush properties
of blown thermoplastic containers]: crushing yield load, deflection at it, apparent stiffness.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import checked
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE, Convergence
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_POISSON,
    DEFAULT_SHEAR_STIFFNESS,
)
from apd_viewer.geometry.solver.plate_press import DEFAULT_ITERATIONS, DEFAULT_STEPS, PlatePress, PressStep

# Estimated fraction of the time for closing, if the plates open again.
_PRESSING = 0.7


@dataclass(frozen=True, eq=False)
class Pressed:
    """Steps of a pressed mesh, with its load curve.

    Attributes
    ----------
    steps : tuple of PressStep
        Steps from first contact on.
    released : tuple of PressStep
        Steps of the opening plates, until they no longer touch; empty if they stay closed.
    curve : LoadCurve
        Curve of the mean of both loads while the plates close.
    stopped : bool
        True if the plates could move no further.
    load_excess : float or None
        Expected overestimate of the loads by bending of the mesh's cells, 0.1 for 10 %; None without
        stiffness, when the loads are due to the cells alone.

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> pressed = apd_viewer.press(ball.vertices, ball.faces, axis=(0, 0, 1), to=1.8, steps=2, stiffness=0.01)
    >>> len(pressed.steps), pressed.U.shape, pressed.stopped
    (3, (162, 3), False)
    """

    steps: tuple[PressStep, ...]
    released: tuple[PressStep, ...]
    curve: LoadCurve
    stopped: bool
    load_excess: float | None

    @property
    def stretching(self) -> float:
        """Largest fraction of the energy due to stretching while the plates close."""
        return max(step.stretching for step in self.steps)

    def deflection_under(self, weight: float, drop: float | None = None) -> float | None:
        """Deflection at which the wall bears a weight; None if it never does.

        Parameters
        ----------
        weight : float
            In the units of the loads.
        drop : float, optional
            Height from which it falls, mesh units: it stops where the work of the load is that of the weight.
            By default it is set down slowly, and rests where the load first reaches it.
        """
        x, load = np.array([(step.deflection, step.load) for step in self.steps]).T
        work = np.append(0.0, np.cumsum(np.diff(x) * 0.5 * (load[1:] + load[:-1])))
        missing = weight - load if drop is None else weight * (drop + x) - work
        borne = np.flatnonzero(missing[1:] <= 0.0)
        if not len(borne):
            return None
        k = int(borne[0])
        step = x[k + 1] - x[k]
        rise = (load[k + 1] - load[k]) / step
        if drop is None:
            return float(x[k] + missing[k] / rise)
        # Work is quadratic within a step.
        roots = np.roots([0.5 * rise, load[k] - weight, -missing[k]])
        within = roots.real[(abs(roots.imag) == 0.0) & (roots.real > 1e-9 * step)]
        return float(x[k] + min(within.min(initial=step), step))

    @property
    def last(self) -> PressStep:
        """Last step, of the release if there was one."""
        return (self.steps + self.released)[-1]

    @property
    def U(self) -> np.ndarray:
        """The last shape, (n, 3) float array."""
        return self.last.U


@checked
def press(
    V: np.ndarray,
    F: np.ndarray,
    axis: Sequence[float] | np.ndarray,
    to: float | str,
    steps: int = DEFAULT_STEPS,
    *,
    fixed: Sequence[int] | np.ndarray = (),
    method: str = DEFAULT_METHOD,
    stiffness: float = 0.0,
    area_stiffness: float = DEFAULT_AREA_STIFFNESS,
    shear_stiffness: float = DEFAULT_SHEAR_STIFFNESS,
    wall_thickness: float | np.ndarray | None = None,
    poisson: float = DEFAULT_POISSON,
    tension_field: bool = False,
    area: float | None = None,
    volume: float | None = None,
    filled_volume: float | None = None,
    thickness: float | None = None,
    yield_radius: float | None = None,
    hardening: float = 0.0,
    start: np.ndarray | None = None,
    gas: float | None = None,
    pressure: float | None = None,
    release: bool = False,
    iterations: int = DEFAULT_ITERATIONS,
    convergence: Convergence = DEFAULT_CONVERGENCE,
    weld: bool = False,
    progress: Callable[[float], object] = lambda _: None,
) -> Pressed:
    """Press a mesh between two plates closing along ``axis``.

    A mesh with a ``filled_volume`` or a ``pressure`` is filled before the plates touch it.

    Parameters
    ----------
    V, F : (n, 3) float and (m, 3) int arrays
    axis : (3,) floats
    to : float or str
        Final distance of the plates, mesh units, or text such as ``"50%"`` of the extent at the first touch.
    steps : int
        Number of equal steps of the closing plates; after each, the mesh comes to rest.
    fixed : (k,) ints
        Vertices held at their positions; may be empty.
    method, stiffness, area_stiffness, shear_stiffness, wall_thickness, poisson, tension_field, area, volume,
    filled_volume, thickness, hardening, pressure, convergence, weld
        See :class:`~apd_viewer.geometry.solver.deformation.Deformation`.
    yield_radius : float, optional
        Walls bent from flat to a smaller radius, mesh units, keep a crease; by default they are elastic.
    start : (n, 3) float array, optional
        Start shape, such as a twisted one. It springs back first, since only ``fixed`` is held; its creases
        by the ``yield_radius`` remain.
    gas : float, optional
        Pressure of enclosed gas times volume, at rest, in areas of the surface: an ideal gas at constant
        temperature, at the outside pressure at rest. Openings are capped. By default there is no gas.
    release : bool
        Whether to open the plates again at the end, to find the permanent deformation.
    iterations : int
        Largest number of iterations per step.
    progress : callable
        Called with the finished fraction of the work.

    Returns
    -------
    Pressed

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> pressed = apd_viewer.press(ball.vertices, ball.faces, axis=(0, 0, 1), to=1.8, steps=2, stiffness=0.01)
    >>> [f"{step.distance:.2f}" for step in pressed.steps[1:]]  # the first is at the touch
    ['1.90', '1.80']
    """
    plates = PlatePress(
        RestMesh.from_arrays(V, F, weld),
        np.asarray(axis),
        to,
        steps,
        iterations,
        fixed=fixed,
        start=start,
        method=method,
        stiffness=stiffness,
        area_stiffness=area_stiffness,
        shear_stiffness=shear_stiffness,
        wall_thickness=wall_thickness,
        poisson=poisson,
        tension_field=tension_field,
        area=area,
        volume=volume,
        filled_volume=filled_volume,
        thickness=thickness,
        yield_radius=yield_radius,
        hardening=hardening,
        gas=gas,
        pressure=pressure,
        convergence=convergence,
    )
    return press_between(plates, release, progress)


def press_between(
    plates: PlatePress, release: bool, progress: Callable[[float], object] = lambda _: None
) -> Pressed:
    """Press with given plates; see :func:`press`."""
    part = _PRESSING if release else 1.0
    steps = list(plates.steps(lambda done: progress(part * done)))
    stopped = plates.is_stopped
    released = list(plates.release(lambda done: progress(part + (1.0 - part) * done))) if release else []
    return pressed_mesh(steps, released, stopped, plates.load_excess)


def pressed_mesh(
    steps: Sequence[PressStep], released: Sequence[PressStep], is_stopped: bool, excess: float | None
) -> Pressed:
    """Result of pressing from its steps, with the readings of its load curve."""
    loads = [step.load for step in steps]
    curve = load_curve(np.array([step.deflection for step in steps]), np.array(loads))
    return Pressed(tuple(steps), tuple(released), curve, is_stopped, excess)


# Relative fall of the load after its maximum taken as yielding; smaller ones are convergence noise.
_FALLS = 0.01
# Fraction of the yield load up to which points are fitted for the apparent stiffness.
_STRAIGHT = 0.5


class LoadCurve(NamedTuple):
    """Readings of a load-deflection curve.

    Attributes
    ----------
    yield_load : float or None
        The first maximum, from which the load falls; None if it only rises.
    yield_deflection : float or None
        Deflection at it, mesh units.
    apparent_stiffness : float or None
        Load per deflection at the beginning: of the line through 0 nearest to the points up to half of the
        yield load, or of the last load. None if the plates have not moved.
    work : float
        Work of the load over the whole deflection.
    """

    yield_load: float | None
    yield_deflection: float | None
    apparent_stiffness: float | None
    work: float


def load_curve(deflection: np.ndarray, load: np.ndarray) -> LoadCurve:
    """Readings of the curve of loads (s,) over deflections (s,), both from 0.

    Parameters
    ----------
    deflection : (s,) float array
        Ascending, from 0 at the first touch on; at least two.
    load : (s,) float array
    """
    x, y = np.asarray(deflection, dtype=float), np.asarray(load, dtype=float)
    top = _first_maximum(y)
    most = y[top] if top is not None else y[-1]
    straight = (y <= _STRAIGHT * most) & (np.arange(len(y)) <= (len(y) if top is None else top))
    straight[1] = True
    slope = float(x[straight] @ y[straight] / (x[straight] @ x[straight])) if x[-1] > 0.0 else None
    work = float(np.trapezoid(y, x))
    if top is None:
        return LoadCurve(None, None, slope, work)
    return LoadCurve(float(y[top]), float(x[top]), slope, work)


def _first_maximum(y: np.ndarray) -> int | None:
    """Index of the first maximum followed by a fall; None without one."""
    top = 0
    for k in range(1, len(y)):
        if y[k] > y[top]:
            top = k
        elif y[k] < (1.0 - _FALLS) * y[top]:
            return top
    return None
