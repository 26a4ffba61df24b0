"""Distance from a target shape, against closed forms, libigl and brute force."""

import igl
import numpy as np
import pytest
from meshes import box, sphere

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.analysis.surface_distance import surface_distance
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh

BALL = Mesh(*sphere(3))
SHIFT = np.array([0.3, 0.0, 0.0])


def shape(mesh):
    return TargetShape(mesh)


def test_target_shape_of_a_sphere_is_the_shift_away_at_each_vertex_and_less_by_surface():
    U = frozen(BALL.V + SHIFT)
    found = shape(BALL).target_distance(BALL, U)
    assert found.vertex == pytest.approx((0.3, 0.3, 0.3), abs=1e-12)
    # The point at (cos t, sin t) of a circle is | |p + shift| - 1 | away from it.
    away = np.abs(np.linalg.norm(U, axis=1) - 1.0)
    assert found.closest.largest == pytest.approx(away.max(), abs=0.01)
    assert found.closest.mean < found.closest.rms < found.closest.largest


def test_target_shape_of_a_scaled_sphere_is_the_difference_of_the_radii_away():
    found = shape(BALL).target_distance(BALL, frozen(1.2 * BALL.V))
    for summary in found:
        assert summary == pytest.approx((0.2, 0.2, 0.2), abs=0.006)
    assert shape(BALL).reverse_distance(BALL, 1.2 * BALL.V) == pytest.approx((0.2, 0.2, 0.2), abs=0.006)


def test_target_shape_is_not_away_at_all_from_the_same_shape():
    assert np.max(shape(BALL).target_distance(BALL, BALL.V)) < 1e-12


def test_target_shape_has_the_closest_points_of_brute_force():
    other = Mesh(*box(2, 3, 4))
    away = shape(other).distances(BALL.V)
    squared = igl.point_mesh_squared_distance(BALL.V, other.V, other.F)[0]
    np.testing.assert_allclose(away, np.sqrt(squared), rtol=0, atol=1e-12)
    corners = other.V[other.F]
    share = np.linspace(0.0, 1.0, 40)
    s, t = (x.ravel() for x in np.meshgrid(share, share))
    inside = s + t <= 1.0
    weights = np.column_stack([1.0 - s - t, s, t])[inside]
    points = np.einsum("ki,tij->tkj", weights, corners).reshape(-1, 3)
    for vertex in range(0, len(BALL.V), 101):
        sampled = np.linalg.norm(points - BALL.V[vertex], axis=1).min()
        assert sampled - 0.03 <= away[vertex] <= sampled + 1e-12


def test_target_shape_corresponds_only_by_the_same_triangles_in_the_same_order():
    turned = Mesh(BALL.V, np.roll(BALL.F, 1, axis=0))
    more = Mesh(np.vstack([BALL.V, [[0.0, 0.0, 0.0]]]), BALL.F)
    assert shape(Mesh(2.0 * BALL.V, BALL.F)).has_same_triangles(BALL)
    for other in (turned, more, Mesh(*box(2, 2, 2))):
        assert not shape(other).has_same_triangles(BALL)
        assert shape(other).target_distance(BALL, BALL.V).vertex is None


def test_target_shape_has_no_value_for_a_vertex_in_no_triangle_and_does_not_count_it():
    loose = Mesh(np.vstack([BALL.V, [[9.0, 9.0, 9.0]]]), BALL.F)
    target = shape(Mesh(loose.V.copy(), BALL.F))
    deviation = Deviation(loose.V, loose.joined_F, np.empty(0, dtype=int), target)
    for values in (deviation.target_distance(loose.V), deviation.target_displacement(loose.V)):
        assert np.isnan(values[-1])
        assert np.nanmax(values) < 1e-12
    assert np.max(target.target_distance(loose, loose.V)) < 1e-12
    # Nor is it a place of the target to be close to.
    assert shape(loose).distances(frozen(np.vstack([BALL.V, [[9.0, 9.0, 9.1]]])))[-1] > 10.0


def test_target_shape_has_one_measure_for_the_window_and_the_command_line():
    other = Mesh(*box(2, 2, 2))
    found = shape(other).target_distance(BALL, BALL.V).closest
    assert found == pytest.approx(surface_distance(BALL.V, BALL.F, other.V, other.F), abs=1e-12)


def test_target_shape_ends_measuring_when_nobody_wants_it_any_more():
    assert shape(BALL).distances(BALL.V, lambda: True) is None
    assert shape(BALL).target_distance(BALL, BALL.V, lambda: True) is None


@pytest.mark.parametrize(("factor", "suspect"), [(1.0, False), (5.0, False), (25.4, True), (1e-3, True)])
def test_target_shape_misfit_suspects_another_unit_by_the_size(factor, suspect):
    misfit = shape(Mesh(factor * BALL.V, BALL.F)).size_ratio(BALL)
    assert misfit == (pytest.approx(factor) if suspect else None)
