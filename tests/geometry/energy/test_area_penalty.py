"""What keeps triangles apart that would collapse: a naive sum, its gradient, and where it is silent."""

import numpy as np
import oracle
import pytest
from meshes import sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import AreaPenalty, SolveMesh
from apd_viewer.geometry.solver.deformation_result import deform

V, F = sphere(2)


def crumpled(amount):
    """The sphere with its vertices displaced at random: triangles of all areas down to next to none."""
    return V + amount * np.random.default_rng(0).normal(size=V.shape)


def test_area_penalty_energy_is_the_sum_over_triangles_below_three_tenths_of_their_area():
    U, before = crumpled(0.1), oracle.areas(V, F)
    share = oracle.areas(U, F) / before
    assert (share < 0.3).sum() > 10
    expected = 2 * before.sum() * sum((1 - s / 0.3) ** 2 for s in share if s < 0.3)
    assert AreaPenalty(V, F).energy(U) == pytest.approx(expected, rel=1e-12)


def test_area_penalty_gradient_is_that_of_finite_differences():
    penalty, U, h = AreaPenalty(V, F), crumpled(0.1), 1e-7
    share = oracle.areas(U, F) / oracle.areas(V, F)
    assert share.min() > 1e-3  # below, a normal is rounding
    gradient, expected = penalty.gradient(U), np.zeros_like(U)
    for i, axis in np.ndindex(*U.shape):
        step = np.zeros_like(U)
        step[i, axis] = h
        expected[i, axis] = (penalty.energy(U + step) - penalty.energy(U - step)) / (2 * h)
    np.testing.assert_allclose(gradient, expected, atol=1e-6 * np.abs(expected).max())
    assert np.abs(gradient.sum(axis=0)).max() <= 1e-9


def test_area_penalty_gradient_begins_without_a_jump():
    """At three tenths of the area, from either side."""
    penalty, scale = AreaPenalty(V, F), np.sqrt(0.3)
    assert np.abs(penalty.gradient(scale * (1 + 1e-9) * V)).max() == 0.0
    assert penalty.energy(scale * (1 + 1e-9) * V) == 0.0
    assert 0.0 < np.abs(penalty.gradient(scale * (1 - 1e-9) * V)).max() <= 1e-5


def test_area_penalty_stays_finite_with_slivers_and_flat_triangles():
    X = np.vstack([V, V[0] + 1e-12])
    penalty = AreaPenalty(X, np.vstack([F, [0, 1, len(V)]]))
    for U in (X, 0.0 * X, np.outer(X[:, 0], [1.0, 0, 0])):
        assert np.isfinite(penalty.energy(U))
        assert np.isfinite(penalty.gradient(U)).all()
    assert penalty.energy(X) == 0.0


@pytest.mark.parametrize("bending", [1e-3, 1e-2])
def test_elastic_surface_iterate_reduces_the_energy_without_the_area_penalty(bending):
    """Half of a crumpled sphere is held: on the way back nothing sends the other half to and fro."""
    rng = np.random.default_rng(0)
    held, U = np.flatnonzero(rng.random(len(V)) < 0.5), crumpled(0.25)
    surface, penalty = ElasticSurface(SolveMesh(V, F), held, Material(bending=bending)), AreaPenalty(V, F)
    surface.local_step(U)
    energies = []
    for _ in range(20):
        surface.local_step(surface.global_step(U[held]))
        energies.append(surface.energy - bending * penalty.energy(surface.U))
    assert penalty.energy(surface.U) > 0.0
    assert (np.diff(energies) <= 1e-12 * energies[0]).all()


@pytest.mark.night
def test_deform_lets_no_triangle_collapse_where_sharp_folds_meet():
    """Without the penalty 30 triangles fell below a fifth of their area."""
    V, F = tube(48, 100, height=10.0)
    base, handle = np.flatnonzero(V[:, 2] < 0.8), np.flatnonzero(V[:, 2] > 9.2)
    fixed, targets = np.concatenate([base, handle]), np.vstack([V[base], V[handle] - [0.0, 0.0, 3.0]])
    U = deform(V, F, fixed, targets, "exact", stiffness=1e-3, handle=handle).U
    assert (oracle.areas(U, F) > 0.2 * oracle.areas(V, F)).all()
