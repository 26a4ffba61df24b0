"""Clearance of obstacles: by samples, exact at edges and triangles, negative inside."""

import numpy as np
import pytest
from meshes import grid, sphere

from apd_viewer.geometry.contact.contact_obstacles import capsule, plate, sphere as ball
from apd_viewer.geometry.contact.obstacle_pairs import clearance

X, Y, Z = np.eye(3)
ONE = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]]), np.array([[0, 1, 2]])


def test_clearance_of_a_plate_is_to_the_lowest_vertex_and_stops_what_is_behind():
    V, F = grid(4, 4)
    below = plate([0.0, 0.0, -0.5], Z, 10.0)
    assert clearance(below, 0.0 * Z, V, F) == pytest.approx(0.5)
    assert clearance(below, 0.2 * Z + 3.0 * X, V, F) == pytest.approx(0.3)
    assert clearance(below, 0.7 * Z, V, F) == pytest.approx(-0.2)
    assert clearance(below, 5.0 * Z, V, F) < 0.0


def test_clearance_of_a_sphere_over_the_middle_of_a_triangle_is_small_though_no_vertex_is_near():
    assert clearance(ball([2.0, 2.0, 1.5], 1.0), 0.0 * Z, *ONE) == pytest.approx(0.5)
    assert clearance(ball([2.0, 2.0, 1.5], 1.0), -1.0 * Z, *ONE) == pytest.approx(-0.5)


def test_clearance_of_a_cylinder_across_an_edge_is_small_though_ends_and_vertices_are_far():
    across = capsule([3.0, -4.0, 1.5], [3.0, 4.0, 1.5], 1.0)
    assert clearance(across, 0.0 * Z, *ONE) == pytest.approx(0.5)
    beside = capsule([5.0, -2.0, -6.0], [5.0, -2.0, 6.0], 0.5)
    assert clearance(beside, 0.0 * Z, *ONE) == pytest.approx(1.5)


def test_clearance_of_a_thin_cylinder_through_a_triangle_is_negative():
    through = capsule([2.0, 2.0, -5.0], [2.0, 2.0, 5.0], 0.1)
    assert clearance(through, 0.0 * Z, *ONE) < 0.0
    assert clearance(through, 6.0 * Z, *ONE) == pytest.approx(0.9)


@pytest.mark.parametrize("made", [ball([0.3, 0.1, -0.2], 0.2), capsule([0.2, 0, 0], [-0.3, 0.1, 0.2], 0.15)])
def test_clearance_takes_an_obstacle_inside_a_closed_surface_for_clear(made):
    V, F = sphere(3)
    assert 0.3 < clearance(made, 0.0 * Z, V, F) < 0.8
    assert clearance(made, 0.7 * X, V, F) < 0.0
    assert clearance(made, 5.0 * X, V, F) > 3.0
    assert clearance(made, 0.0 * Z, 0.01 * V + made.points[0], F) < 0.0, "swallowed"


def test_clearance_skips_nothing_that_is_nearer():
    """Random triangles: the same as one after another."""
    rng = np.random.default_rng(0)
    V = rng.normal(size=(90, 3)) * [1.0, 1.0, 0.3]
    F = np.arange(90).reshape(-1, 3)
    for made in (ball([0.0, 0.0, 3.0], 0.5), capsule([-1.0, 0.0, 3.0], [1.0, 1.0, 2.5], 0.4)):
        for shift in rng.normal(size=(20, 3)) * 0.5:
            each = min(clearance(made, shift, V, F[k : k + 1]) for k in range(len(F)))
            assert clearance(made, shift, V, F) == pytest.approx(each, abs=1e-12)
