"""Scalars per vertex and triangle: laws of simple deformations."""

import numpy as np
import pytest
from meshes import box, rotation, soup, sphere

from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE

V, F = sphere(2)
MESH = Mesh(V, F)
LABELS = np.where(V[:, 2] < -0.5, BASE, np.where(V[:, 2] > 0.5, HANDLE, FREE))
MEMBER = (V[:, 0] > 0).astype(np.uint8)


def scalars(U, mesh=MESH):
    return shape_scalars(mesh, U, LABELS, MEMBER)


def test_shape_scalars_a_rigid_motion_change_nothing_but_places():
    U = V @ rotation([1.0, 2.0, 3.0], 1.0).T + [1.0, 0.0, 0.0]
    vertices, triangles = scalars(U)
    for name in ("area_change", "edge_strain", "bending"):
        assert np.abs(vertices[name]).max() < 1e-10, name
    np.testing.assert_allclose(vertices["displacement"], np.linalg.norm(U - V, axis=1), rtol=1e-12)
    assert np.abs(triangles["area_change"]).max() < 1e-12
    for name in ("largest_stretch", "smallest_stretch"):
        np.testing.assert_allclose(triangles[name], 1.0, rtol=1e-12)


def test_shape_scalars_a_scale_read_it_as_it_is():
    vertices, triangles = scalars(1.5 * V)
    np.testing.assert_allclose(vertices["area_change"], 1.25, rtol=1e-12)
    np.testing.assert_allclose(vertices["edge_strain"], 0.5, rtol=1e-12)
    np.testing.assert_allclose(triangles["area_change"], 1.25, rtol=1e-12)
    np.testing.assert_allclose(triangles["largest_stretch"], 1.5, rtol=1e-12)
    np.testing.assert_allclose(vertices["distance_to_rest"], 0.5, atol=0.02)


def test_shape_scalars_compares_with_a_target_shape():
    none = np.zeros(len(V), dtype=np.uint8)
    same = shape_scalars(MESH, 1.5 * V, none, none, TargetShape(Mesh(2.0 * V, F))).vertices
    np.testing.assert_allclose(same["target_displacement"], 0.5, rtol=1e-12)
    np.testing.assert_allclose(same["target_distance"], 0.5, atol=0.03)
    other = shape_scalars(MESH, V, none, none, TargetShape(Mesh(*box(2, 2, 2)))).vertices
    assert "target_distance" in other
    assert "target_displacement" not in other, "there are no corresponding vertices"


def test_scalars_have_stretches_that_are_singular_values_of_the_deformation_gradient():
    rng = np.random.default_rng(1)
    U = V + 0.05 * rng.normal(size=V.shape)
    _, triangles = scalars(U)
    for t in range(0, len(F), 17):
        before, after = (X[F[t, 1:]] - X[F[t, 0]] for X in (V, U))
        gradient = after.T @ np.linalg.pinv(before.T)
        largest, smallest, _ = np.linalg.svd(gradient)[1]
        assert triangles["largest_stretch"][t] == pytest.approx(largest, rel=1e-9)
        assert triangles["smallest_stretch"][t] == pytest.approx(smallest, rel=1e-9)
    product = triangles["largest_stretch"] * triangles["smallest_stretch"]
    np.testing.assert_allclose(product - 1.0, triangles["area_change"], atol=1e-12)


def test_scalars_label_triangles_as_all_their_corners():
    vertices, triangles = scalars(V)
    assert vertices["apd_label"] is LABELS
    for label in (BASE, HANDLE):
        whole = (LABELS[F] == label).all(axis=1)
        assert np.array_equal(triangles["apd_label"] == label, whole)
    assert np.array_equal(triangles["apd_region"] == 1, (MEMBER[F] == 1).all(axis=1))


def test_scalars_have_no_change_of_a_triangle_without_area():
    W = np.vstack([V, [[3.0, 0.0, 0.0]] * 3])
    mesh = Mesh(W, np.vstack([F, [len(V), len(V) + 1, len(V) + 2]]))
    none = np.zeros(len(W), dtype=np.uint8)
    vertices, triangles = shape_scalars(mesh, W, none, none)
    assert np.isnan(triangles["area_change"][-1])
    assert np.isnan(triangles["largest_stretch"][-1])
    assert np.isfinite(triangles["area_change"][:-1]).all()
    assert np.isnan(vertices["area_change"][-3:]).all()


def test_shape_scalars_repeated_vertices_are_the_same():
    W, G = soup(*box(1, 1, 2))
    mesh, none = Mesh(W, G), np.zeros(len(W), dtype=np.uint8)
    U = W * [1.0, 1.0, 1.3] + 0.1 * W[:, [1, 2, 0]]
    vertices, _ = shape_scalars(mesh, U, none, none)
    for name in ("area_change", "edge_strain", "bending"):
        np.testing.assert_array_equal(vertices[name], vertices[name][mesh.weld.first[mesh.weld.inverse]])
