"""Named poses with a real mouse and real keys."""

import numpy as np
from driving import document, drag, idle, ring_grip
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.session.posing.motion import MOTIONS

LEFT = Qt.MouseButton.LeftButton


def names(window):
    return [row.name.text() for row in window.panel.poses.list.rows]


def active(window):
    return [row.property("active") for row in window.panel.poses.list.rows]


def test_pose_section_keeps_goes_to_updates_renames_and_removes_poses(qtbot, bottle):
    section, session, view = bottle.panel.poses, bottle.session, bottle.canvas.viewport
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    assert section.empty.isVisibleTo(section)
    view.setFocus()
    QTest.keyClick(view, Qt.Key.Key_K, Qt.KeyboardModifier.ControlModifier)
    assert names(bottle) == ["Pose 1"]
    assert active(bottle) == [True]
    assert section.empty.isHidden()

    drag(qtbot, bottle, ring_grip(bottle, 1), (40, 0), steps=3)
    turned = document(bottle).handles[0].pose
    assert active(bottle) == [False]
    QTest.mouseClick(section.add, LEFT)
    assert names(bottle) == ["Pose 1", "Pose 2"]
    assert active(bottle) == [False, True]

    steps = len(session.gestures.history.undo_names)
    QTest.mouseClick(section.list.rows[0], LEFT)
    np.testing.assert_array_equal(document(bottle).handles[0].pose, np.eye(4))
    assert active(bottle) == [True, False]
    assert session.gestures.history.undo_names[steps:] == ["Go to “Pose 1”"]
    view.setFocus()
    QTest.keyClick(view, Qt.Key.Key_Period)
    np.testing.assert_allclose(document(bottle).handles[0].pose, turned, atol=1e-12)
    QTest.keyClick(view, Qt.Key.Key_Comma)
    assert active(bottle) == [True, False]

    session.handles.move_by(MOTIONS["MOVE_Y"], "0.1L", 0)
    QTest.mouseClick(section.list.rows[1].update_pose, LEFT)
    assert active(bottle) == [False, True]
    bottle.actions_.undo.trigger()
    assert active(bottle) == [False, False]

    row = section.list.rows[1]
    row.setFocus()
    QTest.keyClick(row, Qt.Key.Key_F2)
    QTest.keyClicks(row.name, "Open")
    QTest.keyClick(row.name, Qt.Key.Key_Return)
    assert names(bottle) == ["Pose 1", "Open"]
    QTest.keyClick(row, Qt.Key.Key_Delete)
    assert names(bottle) == ["Pose 1"]
    bottle.actions_.undo.trigger()
    assert names(bottle) == ["Pose 1", "Open"]

    session.files.open_sample("duck")
    idle(qtbot, bottle)
    assert names(bottle) == []


def test_pose_controller_says_what_to_do_without_a_pose(qtbot, bottle):
    before = bottle.session.store.state
    bottle.actions_.pose.named_poses[1].trigger()
    assert bottle.session.store.state is before
    assert "keep one first" in bottle.notice.text
