"""The row of a moved handle while the mesh is painted on, by mouse and keyboard in a real window."""

import numpy as np
import pytest
from driving import Mouse, document, drag, idle, on_screen, stroke, work_off
from page_parts import PageParts
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.presentation import readings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session


def front(window, height):
    """A free vertex in front of the bottle, at a height."""
    V = document(window).mesh.V
    found = np.flatnonzero((V[:, 2] > 0.5) & (abs(V[:, 0]) < 0.3))
    return found[np.argmin(abs(V[found, 1] - height))]


def press(window, key, modifiers=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(window.canvas.viewport, key, modifiers)


def choose(qtbot, window, k):
    """Click the row of a handle."""
    Mouse(window.panel.handles.list.rows[k]).press((60, 8))
    work_off()


def row(window, k=0):
    return window.panel.handles.list.rows[k].details.text()


@pytest.fixture
def twisted(qtbot, bottle):
    """The bottle, twisted by 20 degrees as it is typed."""
    bottle.shell.resize(1280, 1000)
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.canvas.viewport.setFocus()
    press(bottle, Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
    field = bottle.panel.handles.motion.amount
    field.selectAll()
    QTest.keyClicks(field, "20deg")
    QTest.keyClick(field, Qt.Key.Key_Return)
    idle(qtbot, bottle)
    assert row(bottle) == "twisted +20.0°"
    return bottle


@pytest.mark.night
def test_handle_section_keeps_the_motion_of_the_first_handle_beside_a_new_one(qtbot, twisted, tmp_path):
    window, rest, shape = twisted, document(twisted).mesh.V, twisted.session.store.state.frame.U
    press(window, Qt.Key.Key_H, Qt.KeyboardModifier.ShiftModifier)
    stroke(qtbot, window, on_screen(window, front(window, 8.0)), half_width=12)
    idle(qtbot, window)
    assert row(window, 1) == "not moved since it was painted"
    assert window.session.store.state.frame.U is shape
    choose(qtbot, window, 0)
    assert row(window) == "twisted +20.0°"
    assert window.panel.handles.reset_handle.isEnabled()

    report = tmp_path / "report.html"
    window.reports.write_report(report)
    idle(qtbot, window)
    said = PageParts(report.read_text(encoding="utf-8")).rows["Handles"]
    assert said["Handle 1"].startswith("twisted +20.0°\n")
    assert said["Handle 2"].startswith("not moved since it was painted")
    window.session.files.save(tmp_path / "bottle.apd", window.view())
    idle(qtbot, window)
    assert readings.motion(open_session(tmp_path / "bottle.apd")[0], 0, Unit.NONE) == "twisted +20.0°"
    window.actions_.simulate.sweep.trigger()
    assert window.runs.dialogs["sweep"].motion.currentText() == "current motion of the handles"
    window.runs.close_all()

    window.panel.handles.reset_handle.click()
    idle(qtbot, window)
    assert row(window) == "at rest"
    assert not window.panel.handles.reset_handle.isEnabled()
    np.testing.assert_allclose(window.session.store.state.frame.U, rest, atol=1e-4)
    window.actions_.undo.trigger()
    assert row(window) == "twisted +20.0°"


def test_handle_section_keeps_the_total_motion_through_a_stroke_of_the_base(qtbot, twisted):
    press(twisted, Qt.Key.Key_B)
    stroke(qtbot, twisted, on_screen(twisted, front(twisted, 6.0)), half_width=15)
    idle(qtbot, twisted)
    assert row(twisted) == "twisted +20.0°"
    assert twisted.session.gestures.history.next_undo_name == "Paint base"
    twisted.actions_.undo.trigger()
    assert row(twisted) == "twisted +20.0°"


def test_handle_section_counts_on_for_a_handle_dragged_after_a_stroke(qtbot, twisted):
    press(twisted, Qt.Key.Key_B)
    stroke(qtbot, twisted, on_screen(twisted, front(twisted, 6.0)), half_width=15)
    press(twisted, Qt.Key.Key_M)
    idle(qtbot, twisted)
    before = document(twisted).relative_to_rest.handles[0].pose
    top = on_screen(twisted, np.flatnonzero(document(twisted).labels >= 2)[0])
    drag(qtbot, twisted, top, (25, 0))
    idle(qtbot, twisted)
    after = document(twisted).relative_to_rest.handles[0].pose
    assert not np.array_equal(before, after)
    np.testing.assert_allclose(before[:3, :3], after[:3, :3], atol=1e-9)
    assert row(twisted).startswith("moved ")
    assert row(twisted).endswith("twisted +20.0°") or row(twisted).endswith("rotated +20.0°")
