"""Deform a mesh one iteration at a time: factor once, aim, step."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from numbers import Real

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.arap import Arap
from apd_viewer.geometry.mesh import check_mesh, frozen, numbers, whole_numbers
from apd_viewer.geometry.methods import LiHui, PlainArap
from apd_viewer.geometry.operators import area
from apd_viewer.geometry.rest_mesh import RestMesh

METHODS = ("paper", "arap")
DEFAULT_METHOD = "paper"
DEFAULT_TOLERANCE = 1e-3

# Settled: the last iteration moved no vertex by more than _STILL of the bounding box's diagonal, and
# all those to come together will move none by more than _REMAINING, guessed from how fast the steps
# have become shorter over the last _MEMORY iterations. Wrinkles of fine meshes creep on with ever
# smaller steps for thousands of iterations: below _CREEP nobody would see them go.
_STILL = 1e-5
_REMAINING = 1e-3
_MEMORY = 10
_CREEP = 5e-6
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Frame:
    """The shape after one iteration, and its readings.

    Attributes
    ----------
    U : (n, 3) float array
        Deformed positions in the order of the file, mesh units, read-only.
    iteration : int
        Iterations since the targets were last set.
    area, area_error : float
        Total area, and ``area / rest area - 1``.
    volume : float or None
        Enclosed volume; None if the surface is not closed.
    handle_drift : float
        Distance between the centroid of the handle where it was asked for and where it is.
    converged : bool
        The shape has settled and its area is within the tolerance.
    """

    U: np.ndarray
    iteration: int
    area: float
    area_error: float
    volume: float | None
    handle_drift: float
    converged: bool


class Deformation:
    """A mesh with some vertices held, deformed one iteration at a time.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
        Triangles.
    fixed : (k,) int array
        Vertices that are held: base and handle together.
    method : str
        "arap" (as rigid as possible) or "paper" (Li & Hui: area kept to the tolerance).
    handle : int array, optional
        Those of ``fixed`` that are handle. "paper" needs it; without it no drift is measured.
    tolerance : float
        Relative error of the total area that "paper" accepts.
    rest : RestMesh, optional
        Of the same V and F, to save computing it again.

    Raises
    ------
    InputError
        If the mesh or the held vertices cannot be used; the message says why.
    """

    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        fixed: np.ndarray,
        *,
        method: str = DEFAULT_METHOD,
        handle: np.ndarray | None = None,
        tolerance: float = DEFAULT_TOLERANCE,
        rest: RestMesh | None = None,
    ) -> None:
        if rest is None:
            V, F = numbers(V, "Vertices"), whole_numbers(F, "Faces")
            check_mesh(V, F)
            rest = RestMesh(V, F)
        self.rest = rest
        self.method = method
        self.fixed = _checked_ids(fixed, len(rest.V), "held")
        handle = _checked_ids([] if handle is None else handle, len(rest.V), "handle")
        solve_ids, self._chosen, self._inverse = np.unique(
            rest.weld.inverse[self.fixed], return_index=True, return_inverse=True
        )
        if not np.isin(rest.weld.inverse[handle], solve_ids).all():
            raise InputError("A handle vertex is not held; name the handle's vertices among the held ones.")
        self._is_handle = np.isin(solve_ids, rest.weld.inverse[handle])
        _check_method(method, self._is_handle)
        _check_tolerance(tolerance)
        if np.isin(rest.shape.piece, rest.shape.piece[solve_ids]).sum() == len(solve_ids):
            raise InputError("Every vertex is held; leave some free to deform.")
        started = time.perf_counter()
        self._arap = Arap(rest.shape, solve_ids)
        if method == "paper":
            self._method: LiHui | PlainArap = LiHui(self._arap, self._is_handle, tolerance)
        else:
            self._method = PlainArap(self._arap, tolerance)
        self.factor_seconds = time.perf_counter() - started
        self.aim(rest.V[self.fixed])

    @property
    def tolerance(self) -> float:
        """Relative error of the total area that is accepted."""
        return self._method.tolerance

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        _check_tolerance(tolerance)
        self._method.tolerance = tolerance

    def aim(self, targets: np.ndarray, U: np.ndarray | None = None) -> None:
        """Hold the fixed vertices at ``targets`` from now on.

        Parameters
        ----------
        targets : (k, 3) float array
            A position for each of ``fixed``.
        U : (n, 3) float array, optional
            Continue from these positions; otherwise from where the last iteration ended.
        """
        targets = numbers(targets, "Targets")
        if targets.shape != (len(self.fixed), 3) or not np.isfinite(targets).all():
            raise InputError(f"Targets must be {len(self.fixed)} finite positions, one for each held vertex.")
        asked = targets[self._chosen]
        if np.abs(targets - asked[self._inverse.ravel()]).max() > 1e-9 * self.rest.diagonal:
            raise InputError("A vertex is held at two places at once; give it one target.")
        if U is not None:
            U = numbers(U, "Positions to start from")
            if U.shape != self.rest.V.shape or not np.isfinite(U).all():
                raise InputError(f"Positions to start from must be {len(self.rest.V)} finite positions.")
            self._arap.restart(np.ascontiguousarray(U[self.rest.weld.first]))
        self._asked = asked
        self._method.aim(self._asked)
        self._iteration = 0
        self._steps: deque[float] = deque(maxlen=_MEMORY + 1)

    def step(self) -> Frame:
        """One iteration; the shape after it and its readings."""
        before = self._method.U
        self._method.iterate()
        self._iteration += 1
        self._steps.append(float(np.abs(self._method.U - before).max()) / self.rest.diagonal)
        U = frozen(self._method.U[self.rest.weld.inverse])
        total = area(U, self.rest.F)
        return Frame(
            U=U,
            iteration=self._iteration,
            area=total,
            area_error=total / self.rest.area - 1.0,
            volume=self.rest.volume_of(U),
            handle_drift=self._drift(),
            converged=self._settled() and self._method.within_tolerance,
        )

    def _settled(self) -> bool:
        last = self._steps[-1]
        if last <= _ROUNDING:
            return True
        if last > _STILL or len(self._steps) <= _MEMORY:
            return False
        rate = (last / self._steps[0]) ** (1.0 / _MEMORY)
        return rate < 1.0 and (last <= _CREEP or last * rate / (1.0 - rate) <= _REMAINING)

    def _drift(self) -> float:
        if not self._is_handle.any():
            return 0.0
        return float(np.linalg.norm((self._method.held - self._asked)[self._is_handle].mean(axis=0)))


def _checked_ids(ids: np.ndarray | list[int], n: int, what: str) -> np.ndarray:
    ids = whole_numbers(ids, f"The {what} vertices").ravel()
    if len(ids) and (ids.min() < 0 or ids.max() >= n):
        raise InputError(f"A {what} vertex does not exist: ids go from 0 to {n - 1:,}.")
    return ids


def _check_method(method: str, is_handle: np.ndarray) -> None:
    if method not in METHODS:
        raise InputError(f"There is no method {method!r}; choose one of {', '.join(METHODS)}.")
    if len(is_handle) == 0:
        raise InputError("Nothing is held; name the vertices that stay or move as given.")
    if method == "paper" and (is_handle.all() or not is_handle.any()):
        raise InputError(
            "The method 'paper' needs base and handle; name the handle's vertices among the held ones."
        )


def _check_tolerance(tolerance: float) -> None:
    if not isinstance(tolerance, Real) or not tolerance > 0.0:
        raise InputError("The tolerance must be greater than zero, such as 0.001 for 0.1 %.")
