"""Descent that ends by a Hessian: sooner, at the same minimum, with goals and held vertices in place."""

import numpy as np
import pytest
from meshes import rotation, tube

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver import adaptive_metric
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation

V, F = tube(20, 30, height=4.0)
REST = RestMesh(V, F)
Z = V[:, 2]
FIXED = np.flatnonzero((Z.min() + 0.4 > Z) | (Z.max() - 0.4 < Z))
HANDLE = Z[FIXED] > Z.mean()


def turned(angle):
    targets = V[FIXED].copy()
    targets[HANDLE] = targets[HANDLE] @ rotation([0, 0, 1], angle).T + [0.0, 0.0, -0.2]
    return targets


def to_the_end(solver, targets, most=6000):
    """Energy and metric after every iteration; everything kept is checked in each."""
    solver.aim(targets)
    surface, course = solver.solver.surface, []
    while not solver.settled:
        frame = solver.step()
        course.append((frame.energy, surface.metric is not surface.factor))
        assert np.array_equal(frame.U[FIXED], targets)
        assert solver.target("the area") is None or abs(frame.area_error) <= 1e-9
        assert len(course) < most
    energies, late = np.array(course).T
    return energies, late.astype(bool)


@pytest.mark.parametrize(("options", "rise"), [({}, 1e-14), ({"area": 100.0}, 1e-9)], ids=["free", "area"])
def test_adaptive_metric_ends_sooner_and_as_low(options, rise, monkeypatch):
    """Where there is one minimum: turned farther, either may end in another fold.

    The area is kept to 1e-10, and the energy may rise by what that is worth.
    """
    energies, late = to_the_end(Deformation(V, F, FIXED, method="local", rest=REST, **options), turned(0.6))
    switch = int(np.argmax(late))
    assert late[switch:].all()
    assert not late[:switch].any()
    assert (np.diff(energies[switch - 10 :]) <= rise * energies[-1]).all()
    monkeypatch.setattr(adaptive_metric, "MOST_HESSIAN_VERTICES", 0)
    by_k, never = to_the_end(Deformation(V, F, FIXED, method="local", rest=REST, **options), turned(0.6))
    assert not never.any()
    assert len(energies) < len(by_k)
    assert energies[-1] <= by_k[-1] * (1 + 1e-4)


@pytest.mark.parametrize(("method", "stiffness"), [("arap", 0.0), ("exact", 0.0), ("local", 1e-3)])
def test_adaptive_metric_never_replaces_k_with_bending_or_without_a_membrane(method, stiffness):
    solver = Deformation(V, F, FIXED, method=method, stiffness=stiffness, rest=REST)
    _, late = to_the_end(solver, turned(0.6))
    assert not late.any()


def test_adaptive_metric_begins_with_k_at_a_new_aim():
    solver = Deformation(V, F, FIXED, method="local", area=100.0, rest=REST)
    assert to_the_end(solver, turned(0.6))[1][-1]
    _, late = to_the_end(solver, turned(0.8))
    assert not late[0]
    assert late[-1]


def test_adaptive_metric_ends_with_k_at_a_coarse_tolerance():
    solver = Deformation(V, F, FIXED, method="local", rest=REST)
    solver.solver.set_tolerance(1e-4)
    assert not to_the_end(solver, turned(0.6))[1].any()


@pytest.mark.parametrize("tolerance", [1e-7, 1e-10])
def test_adaptive_metric_lets_no_descent_converge_before_its_steps_gain_too_little(tolerance):
    """Ten steps at most the tolerance together, or forty by a Hessian at most forty times that."""
    solver = Deformation(
        V, F, FIXED, method="local", rest=REST, convergence=Convergence(energy_tolerance=tolerance)
    )
    solver.aim(turned(1.2))
    surface, energies, by_hessian = solver.solver.surface, [], []
    while not solver.solver.progress.converged:
        solver.iterate()
        energies.append(solver.solver.energy)
        if surface.metric is not surface.factor:
            by_hessian.append(energies[-1])
    assert len(by_hessian) > 41, "the case decides"
    least = tolerance * energies[-1]
    assert energies[-11] - energies[-1] <= least or by_hessian[-41] - by_hessian[-1] <= 40.0 * least
