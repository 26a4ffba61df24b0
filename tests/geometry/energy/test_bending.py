"""Bending and smooth rotations: closed forms, laws of scale and resolution, and a naive SR-ARAP."""

import numpy as np
import oracle
import pytest
from meshes import box, ends, grid, moved, rotation, sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.solver.deformation_result import deform

MESHES = {"tube": tube(9, 8, height=3.0, shear=0.6), "box": box(2, 2, 4), "sphere": sphere(2)}


def bent(rest, U):
    """The bending energy of ``U`` with the rotations that are optimal for its cells."""
    surface = ElasticSurface(rest, np.array([0]), Material(bending=1.0))
    surface.restart(U)
    return rest.bending.energy(U, surface.q)


def equilateral(n):
    """Rhombus of equilateral triangles."""
    V, F = grid(n, n, 1.0, 0.75**0.5)
    return V - np.outer(V[:, 1], [3**-0.5, 0.0, 0.0]), F


def rolled(V, direction, radius):
    """The plane z = 0, rolled to a cylinder in a direction."""
    c, s = np.cos(direction), np.sin(direction)
    along, across = V[:, 0] * c + V[:, 1] * s, V[:, 1] * c - V[:, 0] * s
    return np.column_stack([radius * np.sin(along / radius), across, radius * np.cos(along / radius)])


@pytest.mark.parametrize("direction", [0.0, 0.7, 1.5, 2.6])
def test_bending_energy_of_a_sheet_rolled_to_a_cylinder_is_the_square_of_its_curvature(direction):
    """The integral of the squared curvature, times the area; the border of the sheet counts too."""
    V, F = equilateral(40)
    area = 40 * 40 * 0.75**0.5
    for radius in (12.0, 40.0):
        cost = bent(SolveMesh(V, F), rolled(V, direction, radius))
        assert cost == pytest.approx(area**2 / radius**2, rel=0.06)


@pytest.mark.parametrize("angle", [0.5, 2.0, 3.1])
def test_bending_energy_of_a_strip_is_the_square_of_its_angle_over_the_length_of_the_bend(angle):
    """A bend between two flat halves; the area times the integral of the squared curvature."""
    V, F = equilateral(40)
    length = 16.0
    at = V[:, 1]
    middle = at.mean()
    t = np.clip((at - middle) / length + 0.5, 0.0, 1.0)
    turn, radius = angle * t, length / angle
    before, after = np.minimum(at - middle + length / 2, 0.0), np.maximum(at - middle - length / 2, 0.0)
    y = before + radius * np.sin(turn) + after * np.cos(angle)
    z = radius * (1.0 - np.cos(turn)) + after * np.sin(angle)
    cost = bent(SolveMesh(V, F), np.column_stack([V[:, 0], y, z]))
    width, area = 40.0, 40 * 40 * 0.75**0.5
    assert cost == pytest.approx(area * width * angle**2 / length, rel=0.06)


def test_bending_energy_of_a_crease_is_that_of_its_inversion_and_rises_with_sharpness():
    """Of a sheet folded along a row of edges, up to half a turn."""
    V, F = equilateral(20)
    at, costs = V[:, 1] - V[F].mean(axis=(0, 1))[1], []
    crease = at[np.argmin(np.abs(at))]
    for angle in (-3.1, -2.0, -1.0, 0.0, 1.0, 2.0, 3.1):
        beyond = np.maximum(at - crease, 0.0)
        y = np.minimum(at - crease, 0.0) + beyond * np.cos(angle)
        costs.append(bent(SolveMesh(V, F), np.column_stack([V[:, 0], y, beyond * np.sin(angle)])))
    np.testing.assert_allclose(costs, costs[::-1], rtol=1e-9, atol=1e-9)
    assert (np.diff(costs[3:]) > 0.1 * costs[4]).all()


def test_bending_weights_give_the_integral_in_the_mean_of_all_quadratic_functions():
    """Naively, at each vertex of a rough sheet: three functions that are orthonormal in their Hessian."""
    V, F = grid(6, 5)
    V = V + np.random.default_rng(3).uniform(-0.3, 0.3, V.shape) * [1, 1, 0]
    weight, areas = SolveMesh(V, F).bending.weight, oracle.areas(V, F)
    for i in range(len(V)):
        x, y = (V - V[i])[:, :2].T
        ring, corner = np.nonzero(i == F)
        if len(ring) == 1:
            continue
        total = 0.0
        for u in (x * x / 2, y * y / 2, x * y / 2**0.5):
            slopes = np.array([np.linalg.solve(np.diff(V[F[t], :2], axis=0), np.diff(u[F[t]])) for t in ring])
            w = weight[ring, corner]
            total += w @ ((slopes - w @ slopes / w.sum()) ** 2).sum(axis=1)
        assert total == pytest.approx(3.0 * areas.sum() * areas[ring].sum() / 3.0, rel=1e-9)


@pytest.mark.parametrize("stiffness", [pytest.param(1e-3, marks=pytest.mark.night), 1e-2])
def test_deform_lets_a_stiff_tube_that_is_pushed_not_collapse(stiffness):
    """By 30 % of its length: no triangle loses half of its area."""
    V, F = tube(60, 50, height=12.0, shear=-0.5)
    base, handle = np.flatnonzero(V[:, 2] < 0.9), np.flatnonzero(V[:, 2] > 11.1)
    targets = np.vstack([V[base], V[handle] - [0.0, 0.0, 3.6]])
    U = deform(V, F, np.concatenate([base, handle]), targets, "exact", stiffness=stiffness, handle=handle).U
    assert (oracle.areas(U, F) > 0.5 * oracle.areas(V, F)).all()


def test_bending_energy_of_a_flat_sheet_stretched_in_its_plane_is_zero():
    V, F = grid(9, 7)
    V = V + np.random.default_rng(0).uniform(-0.3, 0.3, V.shape) * [1, 1, 0]
    assert bent(SolveMesh(V, F), V @ np.diag([1.7, 0.6, 1.0])) <= 1e-20


@pytest.mark.parametrize("mesh", MESHES)
def test_bending_energy_is_zero_for_a_turn_and_grows_with_the_square_of_the_unit(mesh):
    V, F = MESHES[mesh]
    rest = SolveMesh(V, F)
    U = V + 0.1 * np.random.default_rng(1).normal(size=V.shape)
    assert bent(rest, V @ rotation([1, 2, 3], 2.5).T - 3.0) <= 1e-18
    assert bent(SolveMesh(1e3 * V, F), 1e3 * U) == pytest.approx(1e6 * bent(rest, U), rel=1e-9)


@pytest.mark.parametrize("method", ["exact", "local"])
def test_deform_by_the_same_stiffness_is_the_same_in_millimeters_and_in_meters(method):
    V, F = MESHES["tube"]
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 1, 0], 0.7), [0.5, 0, 0])])
    metres = deform(V, F, fixed, targets, method, 50, stiffness=0.01)
    millimetres = deform(1e3 * V, F, fixed, 1e3 * targets, method, 50, stiffness=0.01)
    assert np.abs(millimetres.U / 1e3 - metres.U).max() <= 1e-9


def test_deform_shapes_a_stiff_sheet_alike_however_finely_it_is_divided():
    """A sheet that is bent over a free middle: without stiffness the two differ, as nothing bends them."""

    def profile(n, stiffness):
        V, F = grid(2 * n, n)
        V = V / n
        base, handle = np.flatnonzero(V[:, 0] <= 0.25 + 1e-9), np.flatnonzero(V[:, 0] >= 1.75 - 1e-9)
        targets = np.vstack([V[base], moved(V[handle], rotation([0, 1, 0], -1.2), [-0.3, 0, 0.2])])
        result = deform(
            V, F, np.concatenate([base, handle]), targets, "arap", 1500, stiffness=stiffness, handle=handle
        )
        middle = np.flatnonzero(np.abs(V[:, 1] - 0.5) <= 1e-9)
        return result.U[middle][np.isclose(V[middle, 0] * 8, np.rint(V[middle, 0] * 8))]

    coarse, fine = profile(8, 0.01), profile(24, 0.01)
    assert coarse.shape == fine.shape == (17, 3)
    assert np.abs(coarse - fine).max() <= 0.02


@pytest.mark.parametrize("stiffness", [1e-3, 0.1])
@pytest.mark.parametrize("mesh", MESHES)
def test_elastic_surface_with_bending_never_raises_the_energy_and_its_slope_is_the_force(mesh, stiffness):
    V, F = MESHES[mesh]
    base, handle = ends(V)
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], 1.5), [0.3, 0, 0.2])])
    surface = ElasticSurface(SolveMesh(V, F), np.concatenate([base, handle]), Material(bending=stiffness))
    energies = []
    for _ in range(50):
        surface.local_step(surface.global_step(targets))
        energies.append(surface.energy)
    assert (np.diff(energies) <= 1e-12 * energies[0]).all()
    assert energies[-1] < energies[0]

    direction = np.zeros_like(V)
    direction[surface.free] = np.random.default_rng(0).normal(size=(len(surface.free), 3))
    U, slope = surface.U, 4 * (surface.residual(targets) * direction[surface.free]).sum()
    values = []
    for h in (1e-6, -1e-6):
        surface.local_step(U + h * direction)
        values.append(surface.energy)
    assert (values[0] - values[1]) / 2e-6 == pytest.approx(slope, rel=1e-5, abs=1e-6 * energies[-1])


def test_deform_by_more_stiffness_bends_less():
    V, F = tube(16, 20)
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], 1.5))])
    rest = SolveMesh(V, F)
    bends = [
        bent(rest, deform(V, F, fixed, targets, "arap", 300, stiffness=stiffness).U)
        for stiffness in (0.0, 1e-4, 1e-3, 1e-2, 1e-1)
    ]
    assert bends == sorted(bends, reverse=True)


def test_bending_stays_finite_with_isolated_vertices_and_needles():
    V, F = grid(4, 4)
    V = np.vstack([V, [[9.0, 9, 9]]])
    V[12] = V[7] + [1e-9, 1e-12, 0]
    bending = SolveMesh(V, F).bending
    assert np.isfinite(bending.weight).all()
    assert np.isfinite(bending.K.toarray()).all()
    assert (bending.weight[(F == 12).any(axis=1)] >= 0.0).all()
    assert not bending.K[[len(V) - 1]].count_nonzero()


def naive_sr_arap(V, F, fixed, targets, alpha, iterations):
    """[Levi & Gotsman 2015]: rotations one after another, each with its neighbours' newest."""
    w, area = oracle.edges_of(V, F), oracle.areas(V, F).sum()
    neighbours = {i: [j for (k, j) in w if k == i] for i in range(len(V))}
    R = np.tile(np.eye(3), (len(V), 1, 1))
    for _ in range(iterations):
        U = oracle.solve_held(*oracle.normal_equations(V, w, R), fixed, targets)
        for i, ring in neighbours.items():
            S = sum(w[i, j] * np.outer(U[i] - U[j], V[i] - V[j]) for j in ring)
            S = S + alpha * area / len(ring) * sum(R[j] for j in ring)
            A, _, Bt = np.linalg.svd(S)
            A[:, 2] *= np.sign(np.linalg.det(A @ Bt))
            R[i] = A @ Bt
    return U


def test_deform_by_sr_arap_equals_the_naive_one():
    V, F = MESHES["tube"]
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 1, 0], 1.0), [0.5, 0, -0.4])])
    expected = naive_sr_arap(V, F, fixed, targets, 0.02, 20)
    result = deform(V, F, fixed, targets, "sr-arap", 20, stiffness=0.02)
    assert np.abs(result.U - expected).max() <= 1e-11 * np.ptp(V)
    assert np.abs(result.U - deform(V, F, fixed, targets, "arap", 20).U).max() > 1e-3
    plain = deform(V, F, fixed, targets, "sr-arap", 20, stiffness=0.0)
    assert np.array_equal(plain.U, deform(V, F, fixed, targets, "arap", 20).U)
