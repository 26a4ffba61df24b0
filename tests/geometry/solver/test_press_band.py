"""Dents in a wall, and the band of loads of a mesh pressed with others each time."""

from dataclasses import replace

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.solver.linear_buckling import classical_load, knock_down_factor, round_radius
from apd_viewer.geometry.solver.pressed_mesh import pressed_mesh

V, F = meshes.sphere(4)


def heights(shape):
    """Displacements outwards of a sphere's vertices."""
    return np.linalg.norm(shape, axis=1) - 1.0


def test_dented_shape_moves_along_the_normals_by_its_depth_at_most():
    dented = apd_viewer.dented_shape(V, F, 0.01, 0.2)
    assert np.abs(heights(dented)).max() == pytest.approx(0.01, rel=2e-3)
    across = dented - V - heights(dented)[:, None] * V
    assert np.linalg.norm(across, axis=1).max() < 2e-4
    assert heights(dented).min() < -0.002 < 0.002 < heights(dented).max()


def test_dented_shape_is_the_same_for_a_seed_and_another_for_each():
    first, again, other = (apd_viewer.dented_shape(V, F, 0.01, 0.2, seed) for seed in (0, 0, 1))
    assert np.array_equal(first, again)
    assert abs(np.corrcoef(heights(first), heights(other))[0, 1]) < 0.5


@pytest.mark.parametrize("levels", [3, 4, 5])
def test_dented_shape_is_as_smooth_on_any_mesh(levels):
    """A field of this spectrum has a mean square gradient of 1 / (2 length^2) times its mean square."""
    X, triangles = meshes.sphere(levels)
    i, j = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).T
    ratios = []
    for seed in range(12):
        z = heights(apd_viewer.dented_shape(X, triangles, 0.01, 0.3, seed))
        slopes = (z[i] - z[j]) / np.linalg.norm(X[i] - X[j], axis=1)
        ratios.append(2.0 * np.mean(slopes**2) / np.mean(z**2))
    assert np.mean(ratios) == pytest.approx(1.0 / (2.0 * 0.3**2), rel=0.15)


def test_dented_shape_keeps_the_sides_of_a_seam_together():
    X, triangles = V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3)
    dented = apd_viewer.dented_shape(X, triangles, 0.01, 0.2, weld=True)
    corners = dented[np.argsort(F.ravel(), kind="stable")]
    ends = np.flatnonzero(np.diff(np.sort(F.ravel())) == 0)
    assert np.array_equal(corners[ends], corners[ends + 1])


def test_dented_shape_of_a_mesh_far_away_is_the_same():
    away = np.array([1e6, 0.0, 0.0])
    near, far = (apd_viewer.dented_shape(V + at, F, 0.01, 0.2) for at in (0.0, away))
    assert np.allclose(far - away, near, atol=1e-8)


@pytest.mark.parametrize(("slenderness", "factor"), [(10.0, 0.838), (30.0, 0.739), (100.0, 0.581)])
def test_knock_down_factor_of_printed_cylinders(slenderness, factor):
    assert knock_down_factor(slenderness) == pytest.approx(factor, abs=5e-4)
    assert knock_down_factor(2000.0) is None


def test_classical_load_is_that_of_the_formula():
    thickness, poisson = 0.01, 0.3
    young = 4.0 / thickness  # of a material of stiffness 1
    load = 2.0 * np.pi * young * thickness**2 / np.sqrt(3.0 * (1.0 - poisson**2))
    assert classical_load(Material(thickness=thickness, poisson=poisson)) == pytest.approx(load, rel=1e-12)


def test_round_radius_is_of_round_bodies_alone():
    tube, _ = meshes.tube(60, 10)
    assert round_radius(tube @ np.diag([2.0, 2.0, 1.0]), np.array([0.0, 0.0, 1.0])) == pytest.approx(
        2.0, rel=2e-3
    )
    assert round_radius(tube @ np.diag([2.0, 1.5, 1.0]), np.array([0.0, 0.0, 1.0])) is None


@pytest.mark.parametrize("share", [0.2, 0.65])
def test_press_band_finds_the_first_buckle_at_its_height(share):
    """Lids that go with the plates, and even shortening of the wall between, are no dents."""
    X, triangles = meshes.can(48, 2.0)
    wall = {"method": "wall", "wall_thickness": 0.05}
    pressed = apd_viewer.press(X, triangles, (0, 0, 1), 1.999, 1, iterations=1, **wall)
    low, height = X[:, 2].min(), np.ptp(X[:, 2])
    steps = []
    for gone, dent, load in ((0.0, 0.0, 0.0), (0.1, 0.0, 2.0), (0.2, 0.03, 1.0)):
        U = X * [1.0, 1.0, 1.0 - gone / height]
        near = np.exp(-(((X[:, 2] - low) / height - share) ** 2) / 0.01) * (X[:, 0] > 0.5)
        U[:, 0] -= dent * near
        steps.append(replace(pressed.steps[0], U=U, deflection=gone, load_low=load, load_high=load))
    band = apd_viewer.PressBand((pressed_mesh(steps, (), False, 0.0), pressed))
    found = band.buckle_heights(triangles, np.array([0.0, 0.0, 2.0]))
    assert found[0] == pytest.approx(share, abs=0.05)
    assert np.isnan(found[1])


@pytest.mark.night
def test_press_band_of_a_can_yields_below_the_classical_load():
    """Its rims are free to slide, and it has dents: it carries half of that, and no more than all of it."""
    n, thickness, poisson = 48, 0.1, 0.3
    X, triangles = meshes.can(n, 2.0)
    wall = Material(thickness=thickness, poisson=poisson)
    shortening = 2.0 * thickness / np.sqrt(3.0 * (1.0 - poisson**2))
    presses = []
    for seed in range(3):
        dented = apd_viewer.dented_shape(X, triangles, 0.1 * thickness, 0.25, seed)
        height = float(np.ptp(dented[:, 2]))
        presses.append(
            apd_viewer.press(
                *(dented, triangles, (0, 0, 1), height - 1.3 * shortening, 13),
                method="wall",
                wall_thickness=thickness,
                poisson=poisson,
            )
        )
    band = apd_viewer.PressBand(tuple(presses))
    deflections, loads = band.yields.T
    assert np.all(loads / classical_load(wall) < 1.0)
    assert np.all(loads / classical_load(wall) > 0.5)
    assert len(set(loads)) == 3
    assert np.allclose([band.loads(x)[k, 0] for k, x in enumerate(deflections[:, None])], loads, rtol=1e-12)
    assert np.isnan(band.loads(np.array([height]))).all()
