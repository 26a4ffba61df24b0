"""What is drawn of obstacles is where they are, and pressed where it is seen."""

from dataclasses import replace

import numpy as np
import pytest

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.ui.obstacles.obstacle_picker import ray_distance
from apd_viewer.ui.obstacles.obstacle_shapes import ShapeExtent, axes_along, drawing_anchor, obstacle_shape

EXTENT = ShapeExtent(np.array([1.0, 2.0, 3.0]), np.array([0.5, 2.0, 1.0]))
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
PLACE = np.array([1.4, 0.3, 2.0])
SHIFT = np.array([0.2, 0.1, -0.3])


def obstacle(kind):
    size = {"radius": 0.4, "length": 1.5} if kind is ObstacleKind.CYLINDER else {"radius": 0.4}
    return NamedObstacle("", kind, frozen(PLACE.copy()), frozen(AXIS.copy()), **size)


def distances(kind, points):
    """Signed distances of points (k, 3) from the surface of an obstacle at its shifted place."""
    away = points - PLACE - SHIFT
    if kind is ObstacleKind.PLATE:
        return away @ AXIS
    half = 0.75 if kind is ObstacleKind.CYLINDER else 0.0
    return np.linalg.norm(away - np.clip(away @ AXIS, -half, half)[:, None] * AXIS, axis=1) - 0.4


@pytest.mark.parametrize("kind", ObstacleKind)
def test_obstacle_shape_shape_lies_on_the_obstacle(kind):
    shape = obstacle_shape(obstacle(kind), EXTENT)
    at = drawing_anchor(obstacle(kind), SHIFT, EXTENT)
    np.testing.assert_allclose(distances(kind, shape.V + at), 0.0, atol=1e-12)
    lines = shape.outline.reshape(-1, 3) + at
    assert (distances(kind, lines) > -1e-12).all()
    a, b, c = shape.V[shape.F].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normals, shape.normals[shape.F].sum(axis=1)) > -1e-15).all()
    step = shape.V + at + 1e-6 * shape.normals
    np.testing.assert_allclose(distances(kind, step), 1e-6, rtol=1e-6, atol=1e-12)
    assert len(shape.dashes) == pytest.approx(0.5 * len(shape.outline), abs=1)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), AXIS])
def test_ray_distance_meets_a_plate_throughout_the_shadow_of_the_mesh(axis):
    plate = replace(obstacle(ObstacleKind.PLATE), axis=frozen(np.array(axis)))
    axes = axes_along(plate.axis)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(axes[2], plate.axis, atol=1e-15)
    corners = EXTENT.middle + EXTENT.half * (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1)
    for corner in corners:
        for side in (1.0, -1.0):  # from far off along the normal it is met at the plate
            origin = corner + side * 50.0 * plate.axis
            t = ray_distance(plate, SHIFT, EXTENT, origin, -side * plate.axis)
            assert (origin - side * t * plate.axis - PLACE - SHIFT) @ plate.axis == pytest.approx(
                0.0, abs=1e-9
            )


@pytest.mark.parametrize("kind", ObstacleKind)
def test_ray_distance_meets_what_is_drawn_where_the_ray_meets_its_triangles(kind):
    shape, at = obstacle_shape(obstacle(kind), EXTENT), drawing_anchor(obstacle(kind), SHIFT, EXTENT)
    T = shape.V[shape.F] + at
    random = np.random.default_rng(4)
    met = 0
    for _ in range(200):
        origin = at + 6.0 * (v := random.normal(size=3)) / np.linalg.norm(v)
        way = at + random.normal(size=3) * 0.8 - origin
        way /= np.linalg.norm(way)
        found, expected = ray_distance(obstacle(kind), SHIFT, EXTENT, origin, way), nearest(T, origin, way)
        if np.isfinite(expected):
            met += 1
            assert found <= expected + 1e-9  # the triangles are within a round shape
            assert distances(kind, (origin + found * way)[None])[0] == pytest.approx(0.0, abs=1e-9)
    assert met > 15
    assert ray_distance(obstacle(kind), SHIFT, EXTENT, origin, -way) == np.inf


def nearest(T, origin, way):
    """Distance along a ray to triangles (m, 3, 3) [Moller & Trumbore 1997]."""
    e1, e2, s = T[:, 1] - T[:, 0], T[:, 2] - T[:, 0], origin - T[:, 0]
    p = np.cross(way, e2)
    det = np.einsum("ij,ij->i", e1, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", s, p) / det
        q = np.cross(s, e1)
        v, t = q @ way / det, np.einsum("ij,ij->i", e2, q) / det
    t, u, v = (x[det != 0.0] for x in (t, u, v))
    return t[(u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)].min(initial=np.inf)
