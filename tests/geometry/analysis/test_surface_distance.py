"""Distance between surfaces, against libigl and closed forms."""

import igl
import numpy as np
import pytest
from meshes import box, sphere

from apd_viewer.geometry.analysis.surface_distance import nearest_triangles, surface_distance


def test_nearest_triangles_are_those_of_libigl():
    V, F = box(2, 3, 4)
    points = np.random.default_rng(0).uniform(-2.0, 6.0, (500, 3))
    away, corners = nearest_triangles(points, V, F)
    squared = igl.point_mesh_squared_distance(points, V, F)[0]
    np.testing.assert_allclose(away, np.sqrt(squared), rtol=0, atol=1e-12)
    for point, distance, triangle in zip(points[::50], away[::50], corners[::50], strict=True):
        alone = igl.point_mesh_squared_distance(point[None], V, triangle[None])[0]
        assert np.sqrt(np.ravel(alone)[0]) == pytest.approx(distance, abs=1e-12)


def test_surface_distance_of_a_surface_from_itself_is_none():
    V, F = sphere(2)
    assert max(surface_distance(V, F, V, F)) < 1e-12


def test_surface_distance_of_spheres_in_spheres_is_the_difference_of_their_radii():
    V, F = sphere(4)
    there, back = surface_distance(1.2 * V, F, V, F), surface_distance(V, F, 1.2 * V, F)
    for found in (*there, *back):
        assert found == pytest.approx(0.2, abs=0.005)


def test_surface_distance_of_a_shifted_box_is_as_far_as_it_was_shifted():
    V, F = box(2, 2, 2)
    found = surface_distance(V + [0.0, 0.0, 0.5], F, V, F)
    assert found.largest == pytest.approx(0.5, abs=1e-12)
    assert 0.0 < found.rms < 0.5


def test_surface_distance_does_not_count_a_loose_vertex():
    V, F = sphere(2)
    assert surface_distance(np.vstack([V, [[9.0, 9.0, 9.0]]]), F, V, F).largest < 1e-12


def test_surface_distance_takes_a_line_for_a_target():
    V, F = box(1, 1, 1)
    line = np.array([[0, 0, 3], [0.5, 0, 3], [1, 0, 3.0]])
    found = surface_distance(line, np.array([[0, 1, 2]]), V, F)
    assert found == pytest.approx((2, 2, 2))
