"""Descent in contact: its energy, and what else may be asked of it."""

from functools import cache

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import ends, moved, rotation, tube

from apd_viewer.geometry.pose.constraints import SoftConstraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.touching_surface import TouchingElasticSurface

Z = np.eye(3)[2]
TWIST = rotation(Z, np.radians(150.0))


def twisted(R=TWIST):
    """A tube, its held ends, the upper one, and targets with that one turned."""
    V, F = tube(24, 24)
    low, high = ends(V)
    U = V.copy()
    U[high] = moved(V[high], R)
    fixed = np.concatenate([low, high])
    return V, F, fixed, high, U[fixed]


@cache
def in_contact():
    """What the twist comes to."""
    V, F, fixed, high, targets = twisted()
    return deform(V, F, fixed, targets, handle=high, contact=True)


def test_deform_without_contact_lets_the_twist_cross():
    V, F, fixed, high, targets = twisted()
    assert CrossingCheck(V, F).crosses(deform(V, F, fixed, targets, handle=high, contact=False).U)


@pytest.mark.parametrize("method", ["exact", "arap"])
def test_touching_descent_never_raises_the_energy_of_shape_and_gaps_while_handles_rest(method):
    V, F, fixed, high, targets = twisted()
    solver = Deformation(V, F, fixed, method=method, handle=high, contact=True)
    solver.aim(targets)
    inside, energies, judged, tolerances = solver.contact, [], 0, []
    for _ in range(250):
        if solver.settled:
            break
        before = inside.progress.U
        solver.iterate()
        if inside.progress.U is before:  # its stability is looked at
            continue
        if inside.is_on_its_way or not inside.contact.touching_pairs:
            energies = []
            continue
        energies.append(inside.energy + inside.contact.energy_at(inside.progress.U))
        if len(energies) > 1:
            assert energies[-1] <= energies[-2] * (1.0 + 1e-9)
            judged += 1
        if len(energies) > 10 and inside.progress.convergence_ratio:
            tolerances.append(
                (energies[-11] - energies[-1]) / (energies[-1] * inside.progress.convergence_ratio)
            )
    assert judged >= 20
    assert tolerances == pytest.approx([tolerances[0]] * len(tolerances), rel=1e-6), "ten steps and no fewer"


def test_touching_descent_has_few_shapes_refused_in_a_drag(monkeypatch):
    """Steps begin as long as those after the last part of the path; a quarter of all iterations are parts."""
    tried, energy = [], TouchingElasticSurface.energy_after_local_step
    monkeypatch.setattr(
        TouchingElasticSurface,
        "energy_after_local_step",
        lambda self, U: tried.append(None) or energy(self, U),
    )
    V, F, fixed, high, targets = twisted()
    solver = Deformation(V, F, fixed, handle=high, contact=True)
    solver.aim(targets)
    while not solver.settled:
        solver.iterate()
    tried.clear()
    for degrees in range(152, 202, 2):
        targets[-len(high) :] = moved(V[high], rotation(Z, np.radians(float(degrees))))
        solver.aim(targets)
        for _ in range(4):
            solver.iterate()
    assert 60 <= len(tried) <= 100


def test_touching_descent_lets_no_vertices_drawn_softly_cross():
    V, F, fixed, high, targets = twisted()
    near = np.setdiff1d(np.flatnonzero(V[:, 2] > np.quantile(V[:, 2], 0.7)), fixed)
    soft = SoftConstraints(near, np.ones(len(near)), np.full(len(near), 10.0), np.zeros(len(near), np.int64))
    drawn = moved(V[near], TWIST)
    solver, check = Deformation(V, F, fixed, handle=high, soft=soft, contact=True), CrossingCheck(V, F)
    solver.aim(targets, soft_targets=drawn)
    for _ in range(120):
        frame = solver.step()
        assert not check.crosses(frame.U)
        assert abs(frame.area_error) <= 1e-9
    assert np.array_equal(frame.U[fixed], targets)


def test_touching_descent_goes_on_from_a_shape_in_contact_without_crossing():
    """Another solver of the same rest shape takes over where one has ended."""
    V, F, fixed, high, targets = twisted()
    first = in_contact()
    assert first.pairs_in_contact > 0
    solver, check = Deformation(V, F, fixed, handle=high, contact=True), CrossingCheck(V, F)
    solver.aim(targets, first.U)
    for _ in range(30):
        frame = solver.step()
        assert not check.crosses(frame.U)
    assert frame.energy == pytest.approx(first.energy, rel=1e-2)
    assert np.array_equal(frame.U[fixed], targets)


@pytest.mark.night
@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_touching_descent_twists_the_same_in_another_unit(unit):
    V, F, fixed, high, targets = twisted()
    one, other = in_contact(), deform(unit * V, F, fixed, unit * targets, handle=high, contact=True)
    assert not CrossingCheck(V, F).crosses(other.U / unit)
    assert other.energy / unit**2 == pytest.approx(one.energy, rel=1e-2)
    assert other.pairs_in_contact > 0


@pytest.mark.parametrize("short", [pytest.param(1e-3, marks=pytest.mark.night), 1e-5])
def test_touching_descent_moves_needles_and_slivers_along_and_they_do_not_cross(short):
    """Edges that much shorter than their neighbours, and triangles nearly without area."""
    V, F, fixed, high, targets = twisted()
    rng, middle = np.random.default_rng(2), np.setdiff1d(np.arange(len(V)), fixed)
    for v in rng.choice(middle, 40, replace=False):
        near = F[(v == F).any(axis=1)].ravel()
        V[v] += (1.0 - short) * (V[rng.choice(near[near != v])] - V[v])
    corners = V[F]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert (edges.max(axis=1) / edges.min(axis=1)).max() > 0.5 / short
    solver = Deformation(V, F, fixed, handle=high, contact=True)
    check = CrossingCheck(V, F, solver.contact.contact.exempt_vertices)
    solver.aim(targets)
    for count in range(250):
        frame = solver.step()
        assert count % 3 or not check.crosses(frame.U)
        assert abs(frame.area_error) <= 1e-9
    assert frame.share_reached == 1.0


def test_touching_descent_leaves_a_self_touching_rest_shape_as_it_is_without_crossing():
    """A shape that was pressed together becomes the rest shape: nothing pushes, until it is moved."""
    _, F, fixed, high, _ = twisted()
    V = in_contact().U
    solver, check = Deformation(V, F, fixed, handle=high, contact=True), CrossingCheck(V, F)
    solver.aim(V[fixed])
    assert np.abs(solver.step().U - V).max() <= 1e-9
    for further in (moved(V[high], TWIST), moved(V[high], TWIST.T)):
        U = V.copy()
        U[high] = further
        solver.aim(U[fixed])
        for count in range(60):
            frame = solver.step()
            assert count % 3 or not check.crosses(frame.U)
            assert abs(frame.area_error) <= 1e-9
