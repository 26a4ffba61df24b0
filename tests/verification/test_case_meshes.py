"""Meshes of the cases: sound, facing one way, and as large as they should be."""

import numpy as np
import pytest

from apd_viewer.geometry.mesh.operators import area, volume
from apd_viewer.verification.case_meshes import (
    cube,
    disc,
    grid,
    lune,
    platonic_solid,
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
    "tetrahedron": (platonic_solid(4, 3), 0, 2),
    "dodecahedron": (platonic_solid(12, 8), 0, 2),
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


# Volume over an edge cubed, and area over its square [Coxeter, Regular polytopes]; edges 1 mean radius 1.
PHI = 0.5 * (1.0 + np.sqrt(5.0))
SOLIDS = {
    4: (8.0 * np.sqrt(3.0) / 27.0, 8.0 / np.sqrt(3.0)),
    6: (8.0 / (3.0 * np.sqrt(3.0)), 8.0),
    8: (4.0 / 3.0, 4.0 * np.sqrt(3.0)),
    12: ((15.0 + 7.0 * np.sqrt(5.0)) / 4.0, 3.0 * np.sqrt(25.0 + 10.0 * np.sqrt(5.0))),
    20: ((15.0 + 5.0 * np.sqrt(5.0)) / 12.0, 5.0 * np.sqrt(3.0)),
}
EDGES = {12: 2.0 / (np.sqrt(3.0) * PHI), 20: 2.0 / np.sqrt(2.0 + PHI)}


@pytest.mark.parametrize("faces", SOLIDS)
@pytest.mark.parametrize("cells", [1, 4])
def test_platonic_solid_is_regular_and_within_the_unit_sphere(faces, cells):
    V, F = platonic_solid(faces, cells)
    edge, (solid, surface) = EDGES.get(faces, 1.0), SOLIDS[faces]
    assert volume(V, F) == pytest.approx(solid * edge**3, rel=1e-8)
    assert area(V, F) == pytest.approx(surface * edge**2, rel=1e-8)
    assert np.linalg.norm(V, axis=1).max() == pytest.approx(1.0, abs=1e-8)
    corners = (np.bincount(F.ravel()) > 0) & (np.linalg.norm(V, axis=1) > 1.0 - 1e-8)
    assert corners.sum() == {4: 4, 6: 8, 8: 6, 12: 20, 20: 12}[faces]
