"""Symmetric posing with a real mouse and real keys."""

import numpy as np
import pytest
from driving import arrow_grip, document, drag, idle
from meshes import sphere
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.session.posing.mirror_partner import mirror_plane
from apd_viewer.ui.tools.tool_modes import Tool


def stroke(session, ids, label):
    session.gestures.begin()
    session.painting.paint(np.flatnonzero(ids), label)
    session.painting.end_stroke("Paint")


@pytest.fixture
def winged(qtbot, kept_window):
    """A drawn-out sphere with its base below and a handle at the right, the viewport with the keys."""
    V, F = sphere(3)
    V = V * [2.0, 1.0, 1.0]
    kept_window.session.files.open_mesh(Mesh(V, F))
    idle(qtbot, kept_window)
    stroke(kept_window.session, V[:, 1] < -0.7, BASE)
    stroke(kept_window.session, V[:, 0] > 1.4, HANDLE)
    kept_window.tools.choose_tool(Tool.MOVE)
    kept_window.canvas.viewport.camera_controller.show_standard_view("front")
    kept_window.canvas.frame_mesh()
    kept_window.shell.activateWindow()
    qtbot.waitUntil(kept_window.shell.isActiveWindow)
    kept_window.canvas.viewport.setFocus()
    return kept_window


def test_symmetry_controller_paints_the_partner_which_follows_the_mouse(qtbot, winged):
    row, session = winged.panel.handles.symmetry, winged.session
    QTest.keyClick(winged.canvas.viewport, Qt.Key.Key_S, Qt.KeyboardModifier.ShiftModifier)
    assert document(winged).mirror_axis == 0
    assert row.box.isChecked()
    assert "No handle" in row.partner.text()
    row.paint.click()
    assert "“Handle 2” moves along" in row.partner.text()
    assert row.paint.isHidden()

    steps = len(session.gestures.history.undo_names)
    drag(qtbot, winged, arrow_grip(winged, 1), (0, -40), steps=3)
    right, left = document(winged).handles
    assert right.pose[1, 3] > 0.1
    plane = mirror_plane(document(winged).mesh, 0)
    np.testing.assert_allclose(left.pose, plane.mirrored_pose(right.pose), atol=1e-12)
    assert len(session.gestures.history.undo_names) == steps + 1
    winged.actions_.undo.trigger()
    assert not document(winged).is_posed

    dot = winged.canvas.viewport.camera_controller.camera.project(document(winged).centre(1)[None])[0]
    drag(qtbot, winged, QPointF(*dot).toTuple(), (-30, -30), steps=3)
    right, left = document(winged).handles
    assert winged.parts.handle == 1, "its dot was pressed"
    assert left.pose[0, 3] < -0.05
    assert right.pose[0, 3] == pytest.approx(-left.pose[0, 3])

    row.box.click()
    assert document(winged).mirror_axis is None
    assert not winged.actions_.pose.symmetric.isChecked()
    assert row.partner.isHidden()
    drag(qtbot, winged, arrow_grip(winged, 1), (0, -40), steps=3)
    assert document(winged).handles[0] is right


def test_symmetry_row_says_by_the_axis_what_is_a_mirror_image(qtbot, winged):
    row = winged.panel.handles.symmetry
    row.box.click()
    row.axis.setCurrentIndex(2)
    assert document(winged).mirror_axis == 2
    assert "its own mirror image" in row.partner.text()
    assert row.paint.isHidden()
    winged.actions_.undo.trigger()
    assert document(winged).mirror_axis == 0
    assert row.axis.currentIndex() == 0
    assert winged.actions_.pose.symmetric.isChecked()
    winged.actions_.undo.trigger()
    assert not row.box.isChecked()


def test_motion_ghost_shows_both_handles_of_a_symmetric_motion(qtbot, winged):
    winged.session.handles.set_mirror_axis(0)
    winged.session.handles.paint_partner(0)
    winged.actions_.pose.enter_motion.trigger()
    field = winged.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData("MOVE_Y"))
    winged.actions_.pose.enter_motion.trigger()
    QTest.keyClicks(field.amount, "0.2")
    assert len(winged.motion_preview.ghost.traces) == 2
    assert len(winged.motion_preview.ghost.patches.vertices) == (document(winged).labels >= HANDLE).sum()
