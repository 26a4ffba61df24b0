"""Meshes of the cases: sound, facing one way, and as large as they should be."""

import numpy as np
import pytest

from apd_viewer.geometry.mesh.operators import area, volume
from apd_viewer.verification.case_meshes import (
    cube,
    disc,
    grid,
    lune,
    sewn_sheets,
    subdivided_triangles,
    tube,
)

TRIANGLE = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])


def flat(parameters, F):
    return np.insert(parameters, 2, 0.0, axis=1), F


MESHES = {  # with the number of edges of the boundary, and vertices less edges plus triangles
    "grid": (flat(*grid(4, 3)), 14, 1),
    "tube": (tube(12, 2.0), 24, 0),
    "cube": (cube(3), 0, 2),
    "disc": (flat(*disc(4)), 24, 1),
    "sewn sheets": (sewn_sheets(*disc(4), 0.1), 0, 2),
    "lune": (flat(*lune(4, 3)), 16, 1),
    "subdivided": (flat(*subdivided_triangles(TRIANGLE, 5)), 15, 1),
}


@pytest.mark.parametrize("name", MESHES)
def test_case_meshes_are_surfaces_that_face_one_way(name):
    (V, F), boundary, characteristic = MESHES[name]
    directed = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    assert len(np.unique(directed, axis=0)) == len(directed), "two triangles run along an edge the same way"
    edges, count = np.unique(np.sort(directed, axis=1), axis=0, return_counts=True)
    assert (count == 1).sum() == boundary
    assert len(V) - len(edges) + len(F) == characteristic
    assert np.array_equal(np.unique(F), np.arange(len(V)))


def test_cube_has_the_volume_one_and_its_area_six():
    V, F = cube(3)
    assert volume(V, F) == pytest.approx(1.0)
    assert area(V, F) == pytest.approx(6.0)


def test_sewn_sheets_enclose_their_gap_and_open_outwards():
    points, F = disc(40)
    V, faces = sewn_sheets(points, F, 0.01)
    assert area(V, faces) == pytest.approx(2.0 * np.pi, rel=0.005)
    # The gap closes within the outermost ring.
    assert volume(V, faces) == pytest.approx(0.01 * np.pi, rel=0.06)


def test_tube_is_round_and_as_high_as_asked():
    V, _ = tube(40, 1.5)
    assert np.hypot(V[:, 0], V[:, 2]) == pytest.approx(1.0)
    assert np.ptp(V[:, 1]) == pytest.approx(1.5)
