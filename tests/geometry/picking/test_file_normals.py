"""Normals of a file as they are drawn: kept at rest, and turned with the surface."""

import numpy as np
import pytest
from meshes import box, grid, rotation

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.normals import CornerNormals, rotated_normals
from apd_viewer.geometry.picking.surface_index import SurfaceIndex

RNG = np.random.default_rng(3)


def unit(X):
    return X / np.linalg.norm(X, axis=-1, keepdims=True)


def drawn(V, F, N, normal_of, U):
    """Points and normals at the corners of the triangles, (m, 3, 3) each."""
    skin = SurfaceIndex.from_triangles(F, len(V), V=V, normals=CornerNormals.from_normals(N, normal_of, V, F))
    rendered = skin.render_mesh(sharp=True, with_file_normals=True)
    points, normals = np.full((2, len(V) + len(rendered.repeated_vertices), 3), np.nan, dtype=np.float32)
    rendered.write_render_arrays(frozen(np.array(U, dtype=float)), np.zeros(3), points, normals)
    return points[rendered.F], normals[rendered.F]


@pytest.mark.parametrize("per_corner", [False, True])
def test_corner_normals_at_rest_are_those_of_the_file_and_they_turn_rigidly(per_corner):
    V, F = box()
    normal_of = np.arange(F.size).reshape(F.shape) if per_corner else F
    N = unit(RNG.standard_normal((normal_of.max() + 1, 3)))
    R = rotation((1.0, 2.0, 3.0), 0.8)
    for turn in (np.eye(3), R):
        points, normals = drawn(V, F, 3.0 * N, normal_of, V @ turn.T)
        np.testing.assert_allclose(points, (V @ turn.T)[F], atol=1e-6)
        np.testing.assert_allclose(normals, (N @ turn.T)[normal_of], atol=1e-5)


def test_corner_normals_shade_a_deformed_shape_as_its_export_would_be():
    V, F = box()
    N = unit(RNG.standard_normal((len(V), 3)))
    U = V + 0.1 * RNG.standard_normal(V.shape)
    expected = unit(rotated_normals(V, U, F, N, F))[F]
    np.testing.assert_allclose(drawn(V, F, N, F, U)[1], expected, atol=1e-4)


def test_corner_normals_that_are_missing_are_those_of_the_triangles():
    V, F = grid(2, 2)
    N, normal_of = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [np.nan, 0.0, 1.0]]), np.full(F.shape, -1)
    normal_of[0], normal_of[1], normal_of[2] = 0, 1, 2
    normals = drawn(V, F, N, normal_of, V)[1]
    np.testing.assert_allclose(normals[0], np.tile([1.0, 0.0, 0.0], (3, 1)), atol=1e-6)
    assert np.abs(np.abs(normals[1:, :, 2]) - 1.0).max() < 1e-6
    assert CornerNormals.from_normals(N[1:], np.zeros_like(F), V, F) is None
