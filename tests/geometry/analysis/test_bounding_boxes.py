"""Boxes and compactness: closed forms, any orientation, and what cannot be."""

import meshes
import numpy as np
import pytest

from apd_viewer.geometry.analysis.hull_readings import box_volume, compactness, hull_readings
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.mesh.operators import area, volume

TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
# The smallest box: of a box itself; of a tetrahedron the cube whose faces have one edge each.
KNOWN = {"long": (meshes.box(1, 3, 40)[0], 120.0), "cube": (meshes.box(3, 3, 3)[0], 27.0)}
KNOWN |= {"tetrahedron": (TETRAHEDRON, 8.0), "plate": (meshes.box(1, 20, 20)[0], 400.0)}


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("name", KNOWN)
def test_hull_readings_find_the_smallest_box_however_the_shape_lies(name, turn):
    points, smallest = KNOWN[name]
    rng = np.random.default_rng(turn)
    R = meshes.rotation(rng.normal(size=3), rng.uniform(0, np.pi))
    placed = 1e-3 * points @ R.T + [50, 0, -7]
    assert hull_readings(placed).box == pytest.approx(1e-9 * smallest, rel=1e-6)
    assert box_volume(points @ R.T) == pytest.approx(np.prod(np.ptp(points @ R.T, axis=0)))


@pytest.mark.parametrize("seed", range(3))
def test_hull_readings_have_no_larger_box_than_any_of_many_orientations(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(60, 3)) * [4, 2, 1]
    packed = hull_readings(points).box
    turns = [meshes.rotation(rng.normal(size=3), rng.uniform(0, np.pi)) for _ in range(4000)]
    tried = min(box_volume(points @ R.T) for R in turns)
    assert packed <= min(tried, box_volume(points))
    assert packed > 0.8 * tried


def test_hull_readings_and_check_shape_give_what_is_flat_no_room():
    V, F = meshes.grid(4, 3)
    assert hull_readings(V @ meshes.rotation([1, 2, 3], 0.8).T).box == 0.0
    found = check_shape(V, F)
    assert found.packed_box == 0.0
    assert len(found.crossing) == 0


def test_check_shape_gives_a_vertex_without_a_face_no_room():
    V, F = meshes.box(1, 2, 3)
    assert check_shape(np.vstack([V, [[90, 90, 90]]]), F).packed_box == pytest.approx(6.0, rel=1e-9)


def test_compactness_is_greatest_of_a_ball():
    assert compactness(1.0, 6.0) == pytest.approx(np.pi / 6)
    V, F = meshes.sphere(4)
    assert 0.99 < compactness(volume(V, F), area(V, F)) < 1.0
    assert compactness(4 / 3 * np.pi * 7**3, 4 * np.pi * 7**2) == pytest.approx(1.0)


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize(
    ("points", "sides"),
    [
        ([[0, 0, 0], [4, 0, 0], [0, 3, 0]], (0, 12 / 5, 5)),
        ([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1.9, 0.1, 0]], (0, 2, 2)),
        ([[0, 0, 0], [1, 0, 0], [3, 0, 0]], (0, 0, 3)),
        ([[0, 0, 0], [3, 0, 0]], (0, 0, 3)),
        ([[1, 1, 1], [1, 1, 1], [1, 1, 1]], (0, 0, 0)),
    ],
    ids=["triangle", "square", "line", "two points", "one place"],
)
def test_hull_readings_find_the_smallest_rectangle_around_a_flat_shape(points, sides, turn):
    rng = np.random.default_rng(turn)
    R = meshes.rotation(rng.normal(size=3), rng.uniform(0, np.pi))
    found = hull_readings(np.array(points, dtype=float) @ R.T + [50, 0, -7])
    assert found.sides == pytest.approx(sides, abs=1e-12)
    assert found.volume == found.width == 0.0
