"""Sharp edges: normals differ across them, and nowhere else."""

import numpy as np
import pytest
from meshes import box, grid, rotation, soup, sphere

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.render_mesh import SHARP
from apd_viewer.geometry.picking.surface_index import SurfaceIndex


def skin_of(V, F):
    mesh = Mesh(V, F)
    return mesh, SurfaceIndex.from_triangles(mesh.F, len(mesh.V), mesh.joined_F, mesh.V)


def corners(mesh, rendered, U):
    """Points and normals at the corners of the triangles, (m, 3, 3) each."""
    count = len(mesh.V) + len(rendered.repeated_vertices)
    points, normals = np.full((2, count, 3), np.nan, dtype=np.float32)
    rendered.write_render_arrays(frozen(np.array(U, dtype=float)), np.zeros(3), points, normals)
    return points[rendered.F], normals[rendered.F]


def face_normals(U, F):
    a, b, c = U[F].transpose(1, 0, 2)
    N = np.cross(b - a, c - a)
    return N / np.linalg.norm(N, axis=1, keepdims=True)


def folded(angle):
    """A strip with one fold of an angle in its middle."""
    V, F = grid(4, 4)
    middle = np.median(V[:, 0])
    right = V[:, 0] > middle
    V[right] = (V[right] - [middle, 0, 0]) @ rotation((0, 1, 0), angle).T + [middle, 0, 0]
    return V, F


@pytest.mark.parametrize("torn", [False, True])
def test_render_mesh_of_a_box_has_the_normals_of_its_sides(torn):
    mesh, skin = skin_of(*(soup(*box()) if torn else box()))
    R = rotation((1.0, 2.0, 3.0), 0.8)
    for U in (mesh.V, mesh.V @ R.T):
        points, normals = corners(mesh, skin.sharp, U)
        np.testing.assert_allclose(points, U[mesh.F], atol=1e-6)
        expected = face_normals(U, mesh.F)
        np.testing.assert_allclose(normals, np.repeat(expected[:, None], 3, axis=1), atol=1e-6)


@pytest.mark.parametrize("torn", [False, True])
def test_render_mesh_repeats_nothing_without_sharp_edges(torn):
    _, skin = skin_of(*(soup(*sphere(3)) if torn else sphere(3)))
    assert skin.sharp is skin.smooth
    assert skin.render_mesh(sharp=True) is skin.sharp


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("degrees", [-29.0, 29.0, 31.0, -31.0, 170.0])
def test_render_mesh_takes_an_edge_for_sharp_above_thirty_degrees(degrees, flip):
    V, F = folded(np.deg2rad(degrees))
    if flip:  # one side is oriented against the other
        right = V[F].mean(axis=1)[:, 0] > np.median(V[:, 0])
        F = np.where(right[:, None], F[:, ::-1], F)
    mesh, skin = skin_of(V, F)
    along = np.isclose(mesh.V[:, 0], np.median(mesh.V[:, 0])).sum()
    assert len(skin.sharp.repeated_vertices) == (along if abs(np.deg2rad(degrees)) > SHARP else 0)


def test_render_mesh_has_the_sharp_edges_of_the_rest_shape():
    mesh, skin = skin_of(*folded(0.0))
    U, _ = folded(1.0)
    smooth, sharp = corners(mesh, skin.smooth, U)[1], corners(mesh, skin.sharp, U)[1]
    np.testing.assert_array_equal(smooth, sharp)


def test_render_mesh_gives_a_vertex_of_two_fans_a_normal_for_each():
    V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, 1, 1]], dtype=float)
    F = np.array([[0, 1, 2], [0, 3, 4], [0, 2, 4], [1, 5, 2]])  # the edge 0-2 and 1-2 fold
    mesh, skin = skin_of(V, F)
    points, normals = corners(mesh, skin.sharp, V)
    np.testing.assert_array_equal(points, V[F].astype(np.float32))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1.0, atol=1e-6)
    assert skin.sharp.F.max() < len(V) + len(skin.sharp.repeated_vertices)
    np.testing.assert_array_equal(np.append(np.arange(len(V)), skin.sharp.repeated_vertices)[skin.sharp.F], F)
