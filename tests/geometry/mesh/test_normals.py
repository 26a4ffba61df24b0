import igl
import numpy as np
import pytest
from meshes import sphere

from apd_viewer.geometry.mesh.normals import vertex_normals


def test_vertex_normals_are_those_of_libigl_and_zero_without_area():
    V, F = sphere(2)
    normals = vertex_normals(V, F)
    expected = igl.per_vertex_normals(V, F, igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_AREA)
    assert normals == pytest.approx(expected, abs=1e-12)
    assert np.array_equal(vertex_normals(V, F[:1])[-1], np.zeros(3))


def test_vertex_normals_are_zero_without_triangles():
    """As around a handle of a single vertex, whose motion is previewed."""
    V, F = sphere(0)
    assert np.array_equal(vertex_normals(V, F[:0]), np.zeros_like(V))
