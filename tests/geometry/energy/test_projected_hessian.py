"""The Hessian of "local" against differences of its gradient, and what clamping makes of it."""

import numpy as np
import pytest
import scipy.sparse as sp
from meshes import box, ends, rotation, sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.pose.constraints import SoftConstraints

MESHES = {"tube": tube(9, 8, height=3.0, shear=0.6), "box": box(2, 2, 4), "sphere": sphere(1)}
LOCAL = Material(0.1, 0.1, 20.0)


def dense(hessian, U, least=0.0):
    size = 3 * (len(hessian.start) - 1)
    blocks = hessian.blocks_at(U, least), hessian.column, hessian.start
    return sp.bsr_array(blocks, shape=(size, size)).toarray()


def crumpled(V, size=1.1):
    return V * size + 0.05 * np.random.default_rng(0).normal(size=V.shape)


def elastic_of(mesh, material=LOCAL, **options):
    V, F = MESHES[mesh]
    return ElasticSurface(SolveMesh(V, F), ends(V)[0], material, **options)


@pytest.mark.parametrize("size", [0.7, 1.0, 1.3])
@pytest.mark.parametrize(("shear", "area"), [(0.1, 20.0), (1.0, 0.0), (0.0, 3.0)])
@pytest.mark.parametrize("mesh", MESHES)
def test_projected_hessian_unclamped_is_the_derivative_of_the_gradient(mesh, shear, area, size):
    surface = elastic_of(mesh, Material(0.5, shear, area))
    V, free, membrane = surface.rest.V, surface.free, surface.membrane
    U, h = crumpled(V, size), 1e-6

    def gradient(U):
        membrane.local_step(U)
        return (membrane.K @ U - membrane.right_hand_side())[free].ravel()

    of_cells = np.kron((0.5 * surface.rest.L)[free][:, free].toarray(), np.eye(3))
    found = dense(surface.hessian, U, -np.inf) - of_cells
    for column in np.random.default_rng(1).choice(3 * len(free), 25, replace=False):
        step = np.zeros_like(V)
        step[free[column // 3], column % 3] = h
        expected = (gradient(U + step) - gradient(U - step)) / (2 * h)
        assert np.abs(found[:, column] - expected).max() <= 1e-6 * np.abs(found).max()


@pytest.mark.parametrize("mesh", MESHES)
def test_projected_hessian_clamped_is_positive_definite_and_no_smaller(mesh):
    surface = elastic_of(mesh)
    U = crumpled(surface.rest.V, 0.9)
    exact, clamped = dense(surface.hessian, U, -np.inf), dense(surface.hessian, U)
    assert np.linalg.eigvalsh(exact).min() < 0.0
    assert np.linalg.eigvalsh(clamped).min() > 0.0
    assert np.abs(clamped - clamped.T).max() <= 1e-12
    assert np.linalg.eigvalsh(clamped - exact).min() >= -1e-9


@pytest.mark.parametrize("mesh", MESHES)
def test_projected_hessian_at_rest_is_not_clamped_and_k_is_larger(mesh):
    surface = elastic_of(mesh)
    V = surface.rest.V
    hessian = dense(surface.hessian, V)
    assert np.abs(hessian - dense(surface.hessian, V, -np.inf)).max() <= 1e-9
    assert np.linalg.eigvalsh(np.kron(surface.K_ff.toarray(), np.eye(3)) - hessian).min() >= -1e-9


def test_projected_hessian_turns_with_the_shape():
    surface = elastic_of("box")
    U, R = crumpled(surface.rest.V), rotation([1, 2, 3], 1.1)
    turns = np.kron(np.eye(len(surface.free)), R)
    turned = turns @ dense(surface.hessian, U) @ turns.T
    assert np.abs(dense(surface.hessian, U @ R.T) - turned).max() <= 1e-10


def test_projected_hessian_has_the_constant_matrices_of_bending_and_springs():
    soft = SoftConstraints(np.array([10, 11]), np.zeros(2, dtype=int), np.ones(2), np.array([3.0, 0.5]))
    plain, full = elastic_of("tube"), elastic_of("tube", Material(0.1, 0.1, 20.0, 0.01), soft=soft)
    U = crumpled(plain.rest.V)
    difference = dense(full.hessian, U) - dense(plain.hessian, U)
    expected = np.kron((full.K_ff - plain.K_ff).toarray(), np.eye(3))
    assert np.abs(difference - expected).max() <= 1e-12 * np.abs(expected).max()


def test_projected_hessian_stays_positive_definite_with_collapsed_triangles():
    surface = elastic_of("sphere")
    V = surface.rest.V
    for U in (np.zeros_like(V), V * [1.0, 1.0, 0.0], V * [1.0, 0.0, 0.0], 2.0 * V):
        assert np.linalg.eigvalsh(dense(surface.hessian, U)).min() > 0.0


@pytest.mark.parametrize("mesh", MESHES)
def test_projected_hessian_factored_at_a_shape_solves(mesh):
    surface = elastic_of(mesh)
    U = crumpled(surface.rest.V)
    b = np.random.default_rng(2).normal(size=(len(surface.free), 3))
    x = surface.hessian.factor_at(U).solve(b)
    expected = np.linalg.solve(dense(surface.hessian, U), b.ravel()).reshape(-1, 3)
    assert np.abs(x - expected).max() <= 1e-5 * np.abs(expected).max()
