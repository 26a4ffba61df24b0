"""Compile the kernels of a deformation before they are needed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from apd_viewer.geometry.analysis import area_change, deviation
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.energy.elastic import Elastic
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.linalg.linear_solver import supernodal_works
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import DEFAULT_AREA_STIFFNESS, DEFAULT_SHEAR_STIFFNESS, METHODS


def warm_up(enough: Callable[[], bool] = lambda: False) -> None:
    """Run every kernel once: compiled at first (about 100 s), then cached (0.5 s).

    Between two methods ``enough()`` may end it. What a window measures of a shape comes last.
    """
    area_change.warm_up()
    supernodal_works()
    V, F = _ball()
    fixed = np.concatenate([np.arange(200), np.arange(len(V) - 200, len(V))])
    targets = V[fixed] * [1.0, 1.0, 1.1]
    region = Region("region", np.arange(500), 100.0)
    for name, method in METHODS.items():
        if enough():
            return
        solver = Deformation(V, F, fixed, method=name, handle=fixed[200:], stiffness=1e-3)
        if not method.keeps_only_total_area:
            solver.keep(None, 100.0, (region,))
        solver.aim(targets)
        for _ in range(3):
            solver.step()
    membrane = METHODS["local"].material(0.0, DEFAULT_AREA_STIFFNESS, DEFAULT_SHEAR_STIFFNESS)
    elastic = Elastic(SolveMesh(V, F), fixed, membrane)
    elastic.hessian.factored_at(V).solve(V[elastic.free])
    if enough():
        return
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, 0.01)
    contact.shares(2.0 * V)  # so far at once that nobody may take all of it
    contact.gradient(V)
    contact.springs(V)
    if not enough():
        deviation.warm_up()


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
