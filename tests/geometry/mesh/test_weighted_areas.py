"""Areas and volume with their gradients: closed forms, finite differences, invariances."""

import numpy as np
import pytest
import trimesh
from meshes import box, grid, moved, rotation, soup, sphere, tube

from apd_viewer.geometry.mesh.operators import area, cotangents, element_laplacian, face_areas, volume
from apd_viewer.geometry.mesh.weighted_areas import (
    Patch,
    WeightedAreas,
    edge_lengths,
    shape_readings,
    total_area,
)


def wild(V, seed=0):
    """The mesh pushed about, so that no symmetry hides a mistake."""
    rng = np.random.default_rng(seed)
    return V @ np.diag([1.0, 2.0, 3.0]) + 0.05 * rng.normal(size=V.shape)


MESHES = {"sphere": sphere(2), "box": box(2, 3, 4), "tube": tube(9, 7), "soup": soup(*sphere(1))}
CLOSED = {name: MESHES[name] for name in ("sphere", "box")}


def area_and_gradient(U, F, g):
    areas = WeightedAreas(Patch(F, len(U)), np.ones((len(F), 1), dtype=np.float32))
    return areas.values_and_gradients(U, g[None])[0]


def volume_and_gradient(U, F, g):
    return Patch(F, len(U)).volume_and_gradient(U, g)


def difference(measure, U, F, direction, h):
    scratch = np.empty_like(U)
    return (measure(U + h * direction, F, scratch) - measure(U - h * direction, F, scratch)) / (2 * h)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("mesh", MESHES)
def test_weighted_areas_gradient_is_the_difference_quotient(mesh, seed):
    V, F = MESHES[mesh]
    U, g = wild(V, seed), np.full(V.shape, np.nan)
    assert area_and_gradient(U, F, g) == pytest.approx(area(U, F), rel=1e-13)
    assert total_area(U, F) == pytest.approx(area(U, F), rel=1e-13)
    direction = np.random.default_rng(seed + 10).normal(size=V.shape)
    slope = (g * direction).sum()
    assert difference(area_and_gradient, U, F, direction, 1e-5) == pytest.approx(slope, rel=1e-6)


def test_weighted_areas_of_several_sums_are_those_of_each_alone():
    V, F = MESHES["tube"]
    U, weight = wild(V), np.random.default_rng(5).random((len(F), 3)).astype(np.float32)
    areas, g = WeightedAreas(Patch(F, len(U)), weight), np.empty((3, *V.shape))
    values = areas.values_and_gradients(U, g)
    np.testing.assert_allclose(values, face_areas(U, F) @ weight, rtol=1e-13)
    np.testing.assert_allclose(areas.values(U), values, rtol=1e-13)
    for k in range(3):
        alone = np.empty((1, *V.shape))
        WeightedAreas(Patch(F, len(U)), weight[:, [k]]).values_and_gradients(U, alone)
        np.testing.assert_allclose(g[k], alone[0], rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("mesh", CLOSED)
def test_volume_and_gradient_agree_with_the_difference_quotient(mesh, seed):
    V, F = CLOSED[mesh]
    U, g = wild(V, seed), np.full(V.shape, np.nan)
    assert volume_and_gradient(U, F, g) == pytest.approx(volume(U, F), rel=1e-13)
    direction = np.random.default_rng(seed + 10).normal(size=V.shape)
    slope = (g * direction).sum()
    assert difference(volume_and_gradient, U, F, direction, 1e-5) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("mesh", MESHES)
def test_weighted_areas_gradient_is_the_cotangent_laplacian_of_the_positions(mesh):
    """[Pinkall & Polthier 1993]: another way to the same vectors."""
    V, F = MESHES[mesh]
    U, g = wild(V), np.empty(V.shape)
    area_and_gradient(U, F, g)
    assert np.abs(g - element_laplacian(cotangents(U, F), F, len(U)) @ U).max() <= 1e-11


@pytest.mark.parametrize("mesh", CLOSED)
def test_weighted_areas_grow_by_a_scale_as_the_theorem_of_euler_says(mesh):
    """Euler's theorem: x . grad f is the degree of f times f."""
    V, F = CLOSED[mesh]
    U, g = wild(V), np.empty(V.shape)
    total = area_and_gradient(U, F, g)
    assert (U * g).sum() == pytest.approx(2 * total, rel=1e-12)
    inside = volume_and_gradient(U, F, g)
    assert (U * g).sum() == pytest.approx(3 * inside, rel=1e-12)


@pytest.mark.parametrize("measure", [area_and_gradient, volume_and_gradient])
def test_weighted_areas_do_not_change_under_shifts_and_rotations(measure):
    V, F = CLOSED["sphere"]
    U, g, there = wild(V), np.empty(V.shape), np.empty(V.shape)
    value = measure(U, F, g)
    R = rotation([1, 2, 3], 1.1)
    assert measure(U @ R.T + [1e3, -2e3, 5e2], F, there) == pytest.approx(value, rel=1e-10)
    assert np.abs(there - g @ R.T).max() <= 1e-9
    assert np.abs(g.sum(axis=0)).max() <= 1e-12


@pytest.mark.parametrize("mesh", MESHES)
def test_shape_readings_have_area_volume_and_the_largest_change(mesh):
    V, F = MESHES[mesh]
    U, rest, lengths = wild(V), face_areas(V, F), edge_lengths(V, F)
    change = np.abs(face_areas(U, F) / rest - 1)
    assert shape_readings(U, F, rest, lengths, 0.0)[:3] == pytest.approx(
        (area(U, F), volume(U, F), change.max()), rel=1e-12
    )
    least = np.sort(rest[np.argsort(change)][-3:])[-1]
    assert shape_readings(U, F, rest, lengths, least)[2] == pytest.approx(
        change[rest > least].max(initial=0.0), rel=1e-12
    )


def strains(U, V, F):
    """Largest and mean strain of the edges at ``U``."""
    rest = face_areas(V, F)
    *_, largest, summed = shape_readings(U, F, rest, edge_lengths(V, F), 0.0)
    return largest, summed / rest.sum()


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("s", [0.25, 0.9, 1.7])
def test_shape_readings_of_a_scaled_mesh_strain_every_edge_alike(mesh, s):
    V, F = MESHES[mesh]
    assert strains(moved(s * V, rotation([1, 2, 3], 1.1), (5, -2, 1)), V, F) == pytest.approx(
        (s - 1, abs(s - 1)), rel=1e-12
    )


@pytest.mark.parametrize("mesh", MESHES)
def test_shape_readings_have_no_strain_by_a_rigid_motion(mesh):
    V, F = MESHES[mesh]
    U = moved(V, rotation([1, 2, 3], 1.1), (5, -2, 1))
    assert strains(U, V, F) == pytest.approx((0.0, 0.0), abs=1e-13)


@pytest.mark.parametrize("degrees", [-40, -5, 1, 30, 60])
def test_shape_readings_of_a_simple_shear_keep_areas_and_strain_edges_by_the_closed_form(degrees):
    """A sheet of squares: each triangle has an edge along x, one along y and a diagonal along (1, 1)."""
    V, F = grid(5, 4)
    g, U = np.tan(np.radians(degrees)), V.copy()
    U[:, 0] += g * V[:, 1]
    along_y, diagonal = np.hypot(g, 1) - 1, np.hypot(1 + g, 1) / np.sqrt(2) - 1
    assert face_areas(U, F) == pytest.approx(face_areas(V, F), rel=1e-13)
    assert strains(U, V, F) == pytest.approx(
        (max(along_y, diagonal, key=abs), (along_y + abs(diagonal)) / 3), rel=1e-12
    )


@pytest.mark.parametrize("mesh", MESHES)
def test_shape_readings_weight_an_edge_by_the_rest_area_at_it(mesh):
    V, F = MESHES[mesh]
    U, areas = wild(V), face_areas(V, F)
    found = trimesh.Trimesh(V, F, process=False)
    a, b = found.edges_unique.T
    strain = np.linalg.norm(U[a] - U[b], axis=1) / np.linalg.norm(V[a] - V[b], axis=1) - 1
    weight = np.bincount(found.faces_unique_edges.ravel(), np.repeat(areas, 3), len(strain))
    assert strains(U, V, F) == pytest.approx(
        (max(strain, key=abs), np.average(np.abs(strain), weights=weight)), rel=1e-12
    )


def test_shape_readings_leave_out_edges_without_length_at_rest():
    V, F = sphere(2)
    lone = len(V) + np.arange(2)
    V, F = np.vstack([V, V[:1], V[:1]]), np.vstack([F, [0, *lone], [0, 0, 1]])
    U = 1.1 * V
    U[lone] += 7.0
    assert strains(U, V, F) == pytest.approx((0.1, 0.1), rel=1e-12)


@pytest.mark.parametrize("mesh", MESHES)
def test_patch_knows_the_corners_at_every_vertex(mesh):
    V, F = MESHES[mesh]
    patch = Patch(F[::2], len(V))
    owner = np.repeat(np.arange(len(V)), np.diff(patch.start))
    assert np.array_equal(F[::2].ravel()[patch.corner], owner)
    assert np.array_equal(np.sort(patch.corner), np.arange(3 * len(F[::2])))


def test_weighted_areas_have_no_gradient_for_triangles_without_area():
    U = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]])
    g = np.empty(U.shape)
    assert area_and_gradient(U, np.array([[0, 1, 2], [1, 1, 2]]), g) == 0.0
    assert np.array_equal(g, np.zeros(U.shape))
    assert area_and_gradient(U, np.array([[0, 1, 2], [0, 1, 3]]), g) == 0.5
    assert np.isfinite(g).all()
