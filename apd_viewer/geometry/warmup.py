"""Compile the kernels of a deformation before they are needed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numba.core import event

from apd_viewer.geometry.analysis import area_change, deviation
from apd_viewer.geometry.analysis.double_wall import double_wall
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.linalg.linear_solver import supernodal_works
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import DEFAULT_AREA_STIFFNESS, DEFAULT_SHEAR_STIFFNESS, METHODS

# So many are compiled by `warm_up`, kernels within kernels included, where others compile what PARTS has
# besides the drag; fewer where they were first.
_KERNELS = 231


def warm_up(enough: Callable[[], bool] = lambda: False) -> None:
    """Run every kernel once: compiled at first (about 100 s), then cached (0.5 s).

    Between two steps ``enough()`` may end it. They come in the order in which a window needs them.
    """
    for step in (_drag, _contact, supernodal_works, _methods, _membrane, deviation.warm_up, _double_wall):
        if enough():
            return
        step()


def tell_of_compiling(tell: Callable[[float], object]) -> Callable[[], object]:
    """Call ``tell(share)`` at the end of each compilation, until the result is called.

    The ``share`` is the part of all kernels compiled so far in this process, at most 1.
    """
    count = _Count(tell)
    event.register("numba:compile", count)
    return partial(event.unregister, "numba:compile", count)


class _Count(event.Listener):
    """Counts compilations."""

    def __init__(self, tell: Callable[[float], object]) -> None:
        self._tell, self._count = tell, 0

    def on_start(self, _: event.Event) -> None:
        """Wait for the end."""

    def on_end(self, _: event.Event) -> None:
        """Count a kernel."""
        self._count += 1
        self._tell(min(1.0, self._count / _KERNELS))


def _drag() -> None:
    _deform("exact", 0.0)
    area_change.warm_up()


def _methods() -> None:
    for name in METHODS:
        _deform(name, 1e-3)


def _deform(name: str, stiffness: float) -> None:
    V, F = _ball()
    fixed = np.concatenate([np.arange(200), np.arange(len(V) - 200, len(V))])
    solver = Deformation(V, F, fixed, method=name, handle=fixed[200:], stiffness=stiffness)
    if not METHODS[name].keeps_only_total_area:
        solver.keep(None, 100.0, (Region("region", np.arange(500), 100.0),))
    solver.aim(V[fixed] * [1.0, 1.0, 1.1])
    for _ in range(3):
        solver.step()


def _membrane() -> None:
    V, F = _ball()
    membrane = METHODS["local"].material(0.0, DEFAULT_AREA_STIFFNESS, DEFAULT_SHEAR_STIFFNESS)
    elastic = Elastic(SolveMesh(V, F), np.arange(200), membrane)
    elastic.hessian.factored_at(V).solve(V[elastic.free])


def _double_wall() -> None:
    V, F = _ball()
    both, one = np.vstack([V, 0.95 * V]), np.ones(len(F))
    double_wall(both, np.vstack([F, F + len(V)]), np.repeat([0, 1], len(F)), np.r_[one, one], 8.0)


def _contact() -> None:
    V, F = _ball()
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, 0.01)
    contact.shares(2.0 * V)  # so far at once that nobody may take all of it
    contact.gradient(V)
    contact.springs(V)


def _ball() -> tuple[np.ndarray, np.ndarray]:
    """Sphere large enough for a coarse level."""
    around, along = 64, 48
    u, v = np.meshgrid(np.arange(around) * (2 * np.pi / around), np.linspace(0.05, np.pi - 0.05, along))
    V = np.column_stack([(np.sin(v) * np.cos(u)).ravel(), (np.sin(v) * np.sin(u)).ravel(), np.cos(v).ravel()])
    i = np.arange(along - 1)[:, None] * around + np.arange(around)
    j = np.arange(along - 1)[:, None] * around + (np.arange(around) + 1) % around
    quads = np.stack([i, i + around, j + around, j], axis=-1).reshape(-1, 4)
    caps = np.arange(1, around - 1)
    top = np.column_stack([np.zeros_like(caps), caps, caps + 1])
    last = (along - 1) * around
    return V, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], top, last + top[:, ::-1]])


# What a first drag needs, and other processes can compile beside it.
PARTS: dict[str, Callable[[], object]] = {"drag": _drag, "contact": _contact, "factor": supernodal_works}
