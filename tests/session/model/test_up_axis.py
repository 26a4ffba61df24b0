"""Meshes that stand on a flat foot, and meshes that do not."""

import numpy as np
import pytest
import trimesh

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.up_axis import UpAxis, mesh_up_axis, standing_axis

TO_Y = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])  # what was +Z is +Y
CREATE = trimesh.creation


def as_mesh(body, *turns):
    body = body.copy()
    for turn in turns:
        body.apply_transform(turn)
    return Mesh(np.array(body.vertices, dtype=float), np.array(body.faces))


def cup():
    """A bottom, a wall and an open top."""
    wall = CREATE.cylinder(1.0, 2.0)
    keep = wall.triangles_center[:, 2] < 0.99
    wall.update_faces(keep)
    return wall


@pytest.mark.parametrize("body", [CREATE.cone(1.0, 2.0), cup(), CREATE.cone(3.0, 0.5)])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e5])
def test_standing_axis_is_that_of_the_foot_wherever_the_mesh_is(body, scale):
    mesh = as_mesh(body)
    moved = Mesh(scale * mesh.V + 7.0 * scale, mesh.F)
    assert standing_axis(moved) is UpAxis.PLUS_Z
    assert standing_axis(as_mesh(body, TO_Y)) is UpAxis.PLUS_Y
    inside_out = Mesh(mesh.V, mesh.F[:, ::-1])
    assert standing_axis(inside_out) is UpAxis.PLUS_Z


@pytest.mark.parametrize(
    "body", [CREATE.box(), CREATE.cylinder(1.0, 2.0), CREATE.icosphere(), CREATE.torus(2, 1)]
)
def test_standing_axis_is_left_open_where_both_ends_are_alike(body):
    assert standing_axis(as_mesh(body)) is None
    assert standing_axis(as_mesh(body, TO_Y)) is None


def test_standing_axis_is_left_open_for_a_foot_on_the_head():
    """A mesh upside down may be meant so: neither -Z nor -Y is proposed."""
    assert standing_axis(as_mesh(CREATE.cone(1.0, 2.0), TO_Y, TO_Y)) is None


def test_mesh_up_axis_is_the_chosen_one_then_that_of_the_format_and_of_the_foot(tmp_path):
    cone = as_mesh(CREATE.cone(1.0, 2.0))
    assert mesh_up_axis(cone, UpAxis.MINUS_X) is UpAxis.MINUS_X
    assert mesh_up_axis(cone) is UpAxis.PLUS_Z
    save_mesh(cone, cone.V, tmp_path / "cone.glb")
    assert mesh_up_axis(open_mesh(tmp_path / "cone.glb")) is UpAxis.PLUS_Y
    assert mesh_up_axis(as_mesh(CREATE.box())) is UpAxis.PLUS_Y


def test_mesh_up_axis_of_a_format_that_prescribes_one_is_that(tmp_path):
    """Also of 3MF, which is read and never written again."""
    ball = as_mesh(CREATE.icosphere())
    for suffix, axis in ((".3mf", UpAxis.PLUS_Z), (".glb", UpAxis.PLUS_Y)):
        assert mesh_up_axis(Mesh(ball.V, ball.F, tmp_path / f"a{suffix}")) is axis
