"""Convex hulls and their minimum width: closed forms, and an oracle that tries every pair of edges."""

import meshes
import numpy as np
import pytest
from scipy.spatial import ConvexHull as Qhull

from apd_viewer.geometry.analysis.hull_readings import convex_hull, hull_readings, minimum_width

TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)])
EDGE = 2 * np.sqrt(2)  # of the tetrahedron
# A tetrahedron is narrowest between opposite edges, an octahedron between opposite faces.
KNOWN = {
    "tetrahedron": (TETRAHEDRON, EDGE / np.sqrt(2), EDGE**3 / (6 * np.sqrt(2))),
    "octahedron": (OCTAHEDRON, 2 / np.sqrt(3), 4 / 3),
    "cube": (meshes.box(3, 3, 3)[0], 3.0, 27.0),
    "box": (meshes.box(2, 3, 40)[0], 2.0, 240.0),
    "plate": (meshes.box(20, 1, 20)[0], 1.0, 400.0),
}


def width_of(points):
    return minimum_width(convex_hull(points))


def tried(points):
    """Least extent along the normals of all faces, and of all pairs of edges."""
    faces = Qhull(points)
    ends = np.unique(np.sort(faces.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
    along = points[ends[:, 1]] - points[ends[:, 0]]
    i, j = np.triu_indices(len(along), 1)
    normals = np.vstack([faces.equations[:, :3], np.cross(along[i], along[j])])
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 1e-9] / lengths[lengths > 1e-9, None]
    return np.ptp(points @ normals.T, axis=0).min()


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("name", KNOWN)
def test_convex_hull_and_minimum_width_have_closed_forms_however_the_shape_lies(name, turn):
    points, width, volume = KNOWN[name]
    rng = np.random.default_rng(turn)
    placed = 1e-3 * points @ meshes.rotation(rng.normal(size=3), rng.uniform(0, np.pi)).T + [50, 0, -7]
    assert width_of(placed) == pytest.approx(1e-3 * width, rel=1e-9)
    assert convex_hull(placed).volume == pytest.approx(1e-9 * volume, rel=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_minimum_width_is_no_more_than_between_any_pair_of_edges(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(rng.integers(4, 40), 3)) * rng.uniform(0.2, 3.0, size=3)
    if seed % 2:  # every point is a corner
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    assert width_of(points) == pytest.approx(tried(points), rel=1e-12)


def test_minimum_width_needs_only_a_part_of_very_many_corners():
    V, _ = meshes.sphere(5)
    assert len(convex_hull(V).corners) == len(V) > 4000
    assert 2 * (1 - 1e-3) < width_of(V) <= 2.0
    stretched = V * [1.0, 1.3, 5.0]
    assert width_of(stretched) == pytest.approx(2.0, rel=1e-3)


def test_hull_readings_have_no_side_of_the_smallest_box_below_the_width():
    rng = np.random.default_rng(3)
    for _ in range(4):
        found = hull_readings(rng.normal(size=(30, 3)) * [1, 2, 5])
        assert found.width <= found.sides[0] * (1 + 1e-9)
        assert list(found.sides) == sorted(found.sides)
        assert found.volume <= found.box


def test_hull_readings_of_what_is_flat_have_sides_and_nothing_else():
    V, _ = meshes.grid(4, 3)
    found = hull_readings(V @ meshes.rotation([1, 2, 3], 0.8).T)
    assert (found.volume, found.width, found.box, found.bulk()) == (0.0, 0.0, 0.0, 0.0)
    assert found.sides[0] == 0.0
    assert found.sides[2] >= 4.0
    assert found.count_in(45.0) == 0
