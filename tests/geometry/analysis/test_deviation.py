"""What a shape differs by from its rest shape, against closed forms and other people's computations."""

import igl
import numpy as np
import pytest
import trimesh
from meshes import box, rotation, sphere
from scipy.spatial import Delaunay

from apd_viewer.geometry.analysis.deviation import Deviation, extreme_vertices, tightest_bend, write_shades
from apd_viewer.geometry.picking.surface_index import SurfaceIndex

NO_SEAM = np.empty(0, dtype=np.int32)


def change(V, F):
    return Deviation(V, F.astype(np.int32), NO_SEAM)


def sheet(n=12, wide=3.0, tall=2.0):
    """A flat sheet of n x n quads, cut in two, in the plane z = 0."""
    x, y = np.meshgrid(np.linspace(0, wide, n + 1), np.linspace(0, tall, n + 1))
    V = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    F = np.vstack([np.column_stack([i, i + 1, i + n + 2]), np.column_stack([i, i + n + 2, i + n + 1])])
    return V, F


def rolled(V, radius):
    """The sheet around a cylinder along y, its front outside."""
    angle = V[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), V[:, 1], radius * np.cos(angle)])


def inner(V):
    """The vertices that are not at the border of the sheet."""
    low, high = V.min(axis=0), V.max(axis=0)
    return (V[:, :2] > low[:2] + 1e-9).all(axis=1) & (V[:, :2] < high[:2] - 1e-9).all(axis=1)


@pytest.fixture(params=["ball", "box", "sheet"])
def shape(request):
    return {"ball": lambda: sphere(3), "box": lambda: box(4), "sheet": sheet}[request.param]()


MEASURES = ["area_change", "edge_strain", "wrinkling", "displacement", "bending", "rest_distance"]


@pytest.mark.parametrize("measure", MEASURES)
def test_deviation_is_none_at_rest(shape, measure):
    V, F = shape
    np.testing.assert_array_equal(getattr(change(V, F), measure)(V), 0.0)


@pytest.mark.parametrize("measure", ["area_change", "edge_strain", "wrinkling", "bending"])
def test_deviation_of_areas_lengths_and_bends_is_none_by_a_motion(shape, measure):
    V, F = shape
    U = V @ rotation([1, 2, 3], 1.1).T + [5.0, -2.0, 1.0]
    np.testing.assert_allclose(getattr(change(V, F), measure)(U), 0.0, atol=1e-9)


@pytest.mark.parametrize("s", [0.5, 0.9, 1.0, 2.0])
def test_deviation_of_a_scaled_sphere_has_closed_forms(s):
    V, F = sphere(4)
    found = change(V, F)
    np.testing.assert_allclose(found.area_change(s * V), 2 * np.log(s), atol=1e-12)
    np.testing.assert_allclose(found.edge_strain(s * V), np.log(s), atol=1e-12)
    np.testing.assert_allclose(found.displacement(s * V), abs(s - 1), atol=1e-12)
    # But for the normals of the facets, which are not quite those of the sphere.
    np.testing.assert_allclose(found.bending(s * V), 1 / s - 1, rtol=1e-3, atol=1e-12)


def test_deviation_of_larger_and_smaller_is_equally_far_from_nothing():
    V, F = sphere(2)
    found = change(V, F)
    for measure in (found.area_change, found.edge_strain):
        np.testing.assert_allclose(measure(1.25 * V), -measure(V / 1.25), atol=1e-12)


def test_deviation_of_a_stretched_sheet_has_closed_forms():
    V, F = sheet()
    U = V * [1.5, 1.0, 1.0]
    found = change(V, F)
    np.testing.assert_allclose(found.area_change(U), np.log(1.5), atol=1e-12)
    # Every vertex has an edge along x, which is stretched more than the diagonals are.
    np.testing.assert_allclose(found.edge_strain(U), np.log(1.5), atol=1e-12)
    np.testing.assert_allclose(found.displacement(U), 0.5 * V[:, 0], atol=1e-12)
    np.testing.assert_allclose(found.rest_distance(U), np.maximum(U[:, 0] - 3.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(found.bending(U), 0.0, atol=1e-12)
    shrunk = found.edge_strain(V * [0.5, 1.0, 1.0])
    np.testing.assert_allclose(shrunk, -np.log(2.0), atol=1e-12)


@pytest.mark.parametrize(
    ("x", "y", "shear"), [(1.5, 0.8, 0.0), (0.7, 0.9, 0.3), (1.2, 1.1, 0.0), (0.0, 1.0, 0.0)]
)
def test_deviation_wrinkling_is_one_less_the_smallest_singular_value(x, y, shear):
    V, F = sheet()
    A = np.array([[x, shear, 0.0], [0.0, y, 0.0], [0.0, 0.0, 1.0]])
    U = V @ A.T @ rotation([1, 2, 3], 0.4).T
    smallest = np.linalg.svd(A[:2, :2], compute_uv=False)[-1]
    np.testing.assert_allclose(change(V, F).wrinkling(U), max(1.0 - smallest, 0.0), atol=1e-12)


def test_deviation_by_shear_moves_edges_and_keeps_areas():
    V, F = sheet()
    U = V.copy()
    U[:, 0] += 0.7 * V[:, 1]
    found = change(V, F)
    np.testing.assert_allclose(found.area_change(U), 0.0, atol=1e-12)
    assert (np.abs(found.edge_strain(U)) > 0.05).all()


@pytest.mark.parametrize("radius", [1.0, 2.5])
@pytest.mark.parametrize("side", [1, -1])
def test_deviation_bending_of_a_rolled_sheet_is_half_the_curvature_of_its_radius(radius, side):
    V, F = sheet(48)
    U = rolled(V, radius) * [1.0, 1.0, side]  # in the mirror its front is inside
    found = change(V, F)
    within = inner(V)
    np.testing.assert_allclose(found.bending(U)[within], side * 0.5 / radius, rtol=2e-3)
    # Bent without being stretched, but for the chords of the arcs.
    np.testing.assert_allclose(found.area_change(U), 0.0, atol=1e-3)


@pytest.mark.parametrize("radius", [1.0, 2.5])
def test_tightest_bend_of_a_rolled_sheet_is_its_radius(radius):
    V, F = sheet(48)
    assert tightest_bend(V, F, rolled(V, radius)) == pytest.approx(radius, 2e-3)


def test_tightest_bend_of_a_sheet_rolled_on_irregular_triangles_is_little_less():
    chance = np.random.default_rng(0)
    V = sheet(40)[0]
    V[:, :2] += inner(V)[:, None] * chance.uniform(-0.3, 0.3, (len(V), 2)) * V[:, :2].max(axis=0) / 40
    F = Delaunay(V[:, :2]).simplices
    assert 0.85 < tightest_bend(V, F, rolled(V, 2.5)) / 2.5 < 1.0


def test_tightest_bend_of_a_tube_squeezed_into_an_ellipse_is_at_its_ends():
    V, F = sheet(128, wide=2.0 * np.pi, tall=0.4)
    angle = np.linspace(0.0, 2.0 * np.pi, 4001)
    ellipse = np.column_stack([1.3 * np.cos(angle), 0.65 * np.sin(angle)])
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(ellipse, axis=0), axis=1)))
    at = V[:, 0] / (2.0 * np.pi) * length[-1]
    circle = np.column_stack([np.cos(V[:, 0]), np.sin(V[:, 0])]) * length[-1] / (2.0 * np.pi)
    squeezed = np.column_stack([np.interp(at, length, axis) for axis in ellipse.T])
    rest, U = (np.column_stack([xy, V[:, 1]]) for xy in (circle, squeezed))
    change = 1.3 / 0.65**2 - 2.0 * np.pi / length[-1]
    assert tightest_bend(rest, F[:, ::-1], U) == pytest.approx(1.0 / change, 0.03)


def test_tightest_bend_is_none_without_a_bend():
    V, F = sphere(2)
    assert tightest_bend(V, F, 2.0 + V @ rotation([1.0, 2.0, 0.5], 0.7).T) is None


def test_deviation_bending_has_the_curvature_of_libigl():
    V, F = sphere(3)
    U = V * [1.0, 1.4, 0.8] + 0.02 * np.random.default_rng(5).standard_normal(V.shape)

    def curvature(X):
        mass = igl.massmatrix(X, F, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
        normals = igl.per_vertex_normals(X, F, igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_AREA)
        return -0.5 * ((igl.cotmatrix(X, F) @ X) * normals).sum(axis=1) / mass

    np.testing.assert_allclose(change(V, F).bending(U), curvature(U) - curvature(V), atol=1e-9)


def test_deviation_strain_and_area_are_those_of_a_loop_over_all():
    V, F = box(3)
    U = V + 0.3 * np.random.default_rng(2).standard_normal(V.shape)
    mesh, rest = (trimesh.Trimesh(X, F, process=False) for X in (U, V))
    ratio = {v: [] for v in range(len(V))}
    for a, b in mesh.edges_unique:
        for v in (a, b):
            ratio[v].append(np.linalg.norm(U[a] - U[b]) / np.linalg.norm(V[a] - V[b]))
    strain = [np.log(max(ratios, key=lambda r: abs(r - 1))) for ratios in ratio.values()]
    ratios = mesh.area_faces / rest.area_faces
    areas = [np.log(max(ratios[(v == F).any(axis=1)], key=lambda r: abs(r - 1))) for v in range(len(V))]
    np.testing.assert_allclose(change(V, F).edge_strain(U), strain, atol=1e-12)
    np.testing.assert_allclose(change(V, F).area_change(U), areas, atol=1e-12)


def test_deviation_distance_is_that_of_libigl():
    for V, F in (sphere(3), box(4), sheet()):
        U = V @ rotation([1, 1, 0], 0.8).T + 0.3 * np.random.default_rng(1).standard_normal(V.shape)
        expected = np.sqrt(igl.point_mesh_squared_distance(U, V, F)[0])
        np.testing.assert_allclose(change(V, F).rest_distance(U), expected, atol=1e-12)


def test_deviation_distance_that_nobody_wants_any_more_is_given_up():
    V, F = sphere(2)
    assert change(V, F).rest_distance(V, lambda: True) is None


def test_deviation_takes_a_seam_for_no_border():
    """Vertices that are there twice have the values of the place, as if they were there once."""
    V, F = sphere(3)
    soup = np.arange(3 * len(F)).reshape(-1, 3)
    W = V[F].reshape(-1, 3)
    joined = np.unique(W, axis=0, return_index=True, return_inverse=True)
    skin = SurfaceIndex.from_triangles(soup, len(W), joined[1][joined[2].ravel()][soup])
    U = V * [1.0, 1.3, 0.9]
    for measure in MEASURES:
        whole = getattr(change(V, F), measure)(U)
        cut = getattr(Deviation(W, skin.joined, skin.source), measure)(U[F].reshape(-1, 3))
        np.testing.assert_allclose(cut, whole[F.ravel()], atol=1e-12)


def test_deviation_has_no_value_where_there_is_nothing_to_compare():
    V, F = sphere(2)
    V, F = np.vstack([V, [[3, 0, 0], [4, 0, 0]]]), np.vstack([F, [[0, 0, len(V) + 1]]])
    U = 1.2 * V
    for measure in MEASURES:
        assert np.isnan(getattr(change(V, F), measure)(U)[-2]), "nobody sees a vertex of no triangle"
    found = change(V, F)
    assert np.isnan(found.area_change(U)[-1]), "its only triangle has no area"
    assert np.isfinite(found.area_change(U)[:-2]).all()
    flat = V.copy()
    flat[:-2] = V[0]
    for measure in (found.area_change, found.edge_strain):
        assert (measure(flat)[:-2] == -np.inf).all(), "shrunk to nothing is less than all"


def test_write_shades_puts_the_zero_in_the_middle_and_is_symmetric():
    shades = np.zeros((7, 4), dtype=np.uint8)[:, 3]
    values = np.array([-np.inf, -0.2, -0.101, 0.0, 0.101, np.inf, np.nan])
    write_shades(values, True, 0.2, shades)
    assert shades.tolist() == [1, 1, 64, 128, 192, 255, 0]
    write_shades(np.array([0.0, 0.0499, 0.1, 0.2, 0.3, np.inf, np.nan]), False, 0.2, shades)
    assert shades.tolist() == [1, 64, 128, 255, 255, 255, 0]
    both = np.zeros((200, 4), dtype=np.uint8)[:, 3]
    values = np.linspace(-0.3, 0.3, 200)
    write_shades(values, True, 0.2, both)
    assert (both.astype(int) - 128 == -(both[::-1].astype(int) - 128)).all()


def test_extreme_vertices_places_are_apart_and_in_order():
    x = np.linspace(0, 10, 1001)
    U = np.column_stack([x, 0 * x, 0 * x])
    values = np.exp(-((x - 2) ** 2)) - 1.5 * np.exp(-((x - 7) ** 2))
    values[0] = np.nan
    found = extreme_vertices(values, U, 3.0, 2)
    np.testing.assert_allclose(x[found], [7.0, 2.0], atol=1e-3)
    assert len(extreme_vertices(np.zeros(1001), U, 1.0, 5)) == 0
    assert len(extreme_vertices(values, U, 1.0, 30)) <= 11
