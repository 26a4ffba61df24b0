"""Decimation: clusters of vertices that lead a large mesh to its coarse one."""

import numpy as np
import pytest
from meshes import sphere, tube

from apd_viewer.geometry.mesh.decimation import clustered_mesh, decimated_mesh
from apd_viewer.geometry.mesh.operators import face_areas


def edges_per_count(F):
    """How many edges belong to one, two, three ... triangles."""
    edges = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    return np.bincount(np.unique(edges, axis=0, return_counts=True)[1])[1:]


def volume(V, F):
    a, b, c = V[F].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("count", [600, 1500])
def test_clustered_mesh_has_about_as_many_vertices_and_the_shape_of_the_surface(count):
    V, F = sphere(5)
    vertices, T = clustered_mesh(V, F, count)
    assert 0.7 * count < len(vertices) < 1.4 * count
    assert (np.diff(vertices) > 0).all()
    assert np.array_equal(np.unique(T), np.arange(len(vertices)))
    assert face_areas(V[vertices], T).sum() == pytest.approx(4.0 * np.pi, rel=0.05)
    assert volume(V[vertices], T) == pytest.approx(4.0 * np.pi / 3.0, rel=0.03)


def test_clustered_mesh_keeps_two_walls_in_a_cell_apart():
    V, F = tube(60, 80)
    n = len(V)
    both, faces = np.vstack([V, V * [0.999, 0.999, 1.0]]), np.vstack([F, F[:, ::-1] + n])
    vertices, T = clustered_mesh(both, faces, 800)
    is_inner = (vertices >= n)[T]
    assert (is_inner.all(axis=1) == is_inner.any(axis=1)).all()
    assert is_inner.all(axis=1).sum() == pytest.approx(len(T) / 2, rel=0.05)


def test_decimated_mesh_of_a_closed_surface_is_closed_also_from_clusters():
    V, F = sphere(6)  # 80 vertices for one of the coarse mesh: clusters come first
    vertices, T = decimated_mesh(V, F, 500)
    assert len(vertices) == pytest.approx(500, rel=0.05)
    once, twice, *more = edges_per_count(T)
    assert (once, twice, sum(more)) == (0, 3 * len(T) / 2, 0)
    assert volume(V[vertices], T) == pytest.approx(4.0 * np.pi / 3.0, rel=0.03)


def test_decimated_mesh_from_clusters_takes_vertices_of_the_surface_only():
    V, F = sphere(6)
    unused = np.vstack([V[:1] * 50.0, V])
    vertices, T = decimated_mesh(unused, F + 1, 500)
    assert vertices.min() >= 1
    assert face_areas(unused[vertices], T).sum() == pytest.approx(4.0 * np.pi, rel=0.03)


def test_decimated_mesh_keeps_a_small_part_beside_a_large_triangle():
    """Cells for the area of the triangle would each hold a large piece of the part."""
    V, F = sphere(6)
    ground = 1000.0 * np.array([[-1.0, -1.0, -0.002], [1.0, -1.0, -0.002], [0.0, 1.0, -0.002]])
    both, faces = np.vstack([V, ground]), np.vstack([F, [np.arange(3) + len(V)]])
    assert len(clustered_mesh(both, faces, 4000)[1]) < 500
    vertices, T = decimated_mesh(both, faces, 500)
    ball = T[(vertices[T] < len(V)).all(axis=1)]
    assert len(ball) == pytest.approx(1000, rel=0.05)
    assert face_areas(both[vertices], ball).sum() == pytest.approx(4.0 * np.pi, rel=0.03)
