"""The proposal to stand a mesh upright, with a real mouse."""

import meshes
import numpy as np
import pytest
import trimesh
from driving import idle, work_off
from PySide6.QtCore import Qt

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.up_axis import UpAxis

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def cone(tmp_path):
    """File of a cone that stands with +Z up."""
    body = trimesh.creation.cone(1.0, 2.0)
    mesh = Mesh(np.array(body.vertices, dtype=float), np.array(body.faces))
    save_mesh(mesh, mesh.V, tmp_path / "cone.stl")
    return tmp_path / "cone.stl"


def opened(qtbot, window, path):
    window.files.open_path(path)
    idle(qtbot, window)
    work_off()
    return window.proposal


def up_axis(window):
    return window.canvas.viewport.camera_controller.camera.up_axis


def test_workbench_stands_a_mesh_upright_and_leaves_its_coordinates(qtbot, kept_window, cone):
    notice = opened(qtbot, kept_window, cone)
    assert "+Z up" in notice.text
    assert up_axis(kept_window) is UpAxis.PLUS_Y
    before = kept_window.session.store.state.document.mesh.V.copy()
    qtbot.mouseClick(notice.accept, LEFT)
    assert up_axis(kept_window) is UpAxis.PLUS_Z
    assert kept_window.actions_.view.camera.up_axes[UpAxis.PLUS_Z].isChecked()
    assert notice.text == ""
    np.testing.assert_array_equal(kept_window.session.store.state.document.mesh.V, before)
    assert opened(qtbot, kept_window, cone).text == "", "it is remembered for the file"
    assert up_axis(kept_window) is UpAxis.PLUS_Z


def test_workbench_proposes_no_axis_where_none_is_likely_or_one_was_chosen(
    qtbot, kept_window, cone, tmp_path
):
    ball = Mesh(*meshes.sphere(2))
    save_mesh(ball, ball.V, tmp_path / "ball.obj")
    assert opened(qtbot, kept_window, tmp_path / "ball.obj").text == ""
    opened(qtbot, kept_window, cone)
    kept_window.actions_.view.camera.up_axes[UpAxis.PLUS_X].trigger()
    kept_window.proposal.hide()
    assert opened(qtbot, kept_window, cone).text == ""
    assert up_axis(kept_window) is UpAxis.PLUS_X
