"""Sizes, points and lines that are typed or clicked, with real keys and a real mouse."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.tool_modes import Tool


def entered(qtbot, card, text):
    card.text.setText("")
    QTest.keyClicks(card.text, text)
    qtbot.keyClick(card.text, Qt.Key.Key_Return)


def on_screen(window, point):
    return QPointF(*window.canvas.viewport.camera_controller.camera.project(np.asarray(point)[None])[0])


def test_text_entries_takes_the_size_of_a_brush_in_pixels_or_as_a_length(qtbot, bottle):
    brush, typed = bottle.canvas.brush.size, bottle.edits.text_entries.brush
    bottle.actions_.select.sizes[2].trigger()
    assert bottle.canvas.tool is Tool.HANDLE
    entered(qtbot, typed, "31 px")
    assert (brush.radius, brush.mesh_radius, typed.isHidden()) == (31.0, None, True)
    bottle.actions_.select.sizes[2].trigger()
    assert typed.text.text() == typed.text.selectedText() == "31px", "the present size, to be typed over"
    entered(qtbot, typed, "0.05L")
    assert brush.mesh_radius == pytest.approx(0.05 * max(bottle.session.store.state.inspection.size))
    assert "Brush" in bottle.status.currentMessage()
    bottle.choose_unit(Unit.MILLIMETRE)
    bottle.actions_.select.sizes[2].trigger()
    assert typed.text.text() == f"{brush.mesh_radius:.4g}mm"
    qtbot.keyClick(typed.text, Qt.Key.Key_Escape)
    bottle.actions_.select.sizes[0].trigger()
    assert brush.mesh_radius == pytest.approx(1.25 * 0.05 * max(bottle.session.store.state.inspection.size))


@pytest.mark.parametrize("text", ["0", "-3px", "large px", "3 apples", "60deg"])
def test_text_entries_refuses_a_brush_of_no_size_in_a_sentence(qtbot, bottle, text):
    brush, typed = bottle.canvas.brush.size, bottle.edits.text_entries.brush
    before = brush.radius, brush.mesh_radius
    bottle.actions_.select.sizes[2].trigger()
    entered(qtbot, typed, text)
    assert (brush.radius, brush.mesh_radius) == before
    assert not typed.isHidden()
    assert typed.message_label.text().endswith(".")
    assert typed.message_label.text() != typed.help


def test_type_pivot_shows_the_point_while_it_is_typed_and_is_a_step_of_undo(qtbot, bottle):
    session, typed = bottle.session, bottle.edits.text_entries.pivot
    before = session.store.state
    bottle.tools.choose_tool(Tool.BASE)
    bottle.actions_.pose.pivots[1].trigger()
    assert bottle.canvas.tool is Tool.MOVE, "the gizmo shows the pivot"
    QTest.keyClicks(typed.text, "1, 0.5Y, -2")
    point = np.array([1.0, 0.5 * session.store.state.inspection.size[1], -2.0])
    np.testing.assert_allclose(bottle.canvas.picker.marked_points, point[None])
    qtbot.keyClick(typed.text, Qt.Key.Key_Return)
    assert typed.isHidden()
    assert len(bottle.canvas.picker.marked_points) == 0
    np.testing.assert_allclose(session.store.state.document.pivot(0), point)
    session.handles.move_by(MOTIONS["TURN_Z"], "30deg", 0)
    np.testing.assert_allclose(transform(session.store.state.document.handles[0].pose, point[None])[0], point)
    session.gestures.undo()
    session.gestures.undo()
    assert session.store.state is before


@pytest.mark.parametrize("text", ["1, 2", "1, 2, 3, 4", "a, b, c"])
def test_type_pivot_refuses_what_is_no_point_in_a_sentence(qtbot, bottle, text):
    before, typed = bottle.session.store.state, bottle.edits.text_entries.pivot
    bottle.actions_.pose.pivots[1].trigger()
    entered(qtbot, typed, text)
    assert bottle.session.store.state is before
    assert typed.message_label.text() != typed.help


def test_text_entries_shows_one_card_at_a_time(bottle):
    bottle.actions_.pose.pivots[1].trigger()
    bottle.actions_.select.by_expression.trigger()
    assert bottle.edits.text_entries.pivot.isHidden()
    assert not bottle.edits.text_entries.vertices.isHidden()


def test_pick_line_takes_the_line_of_a_bend_by_two_clicks(qtbot, bottle, mouse):
    session, motion = bottle.session, bottle.panel.handles.motion
    motion.choice.setCurrentIndex(motion.choice.findData("BEND_LINE"))
    motion.amount.setText("20deg")
    qtbot.keyClick(motion.amount, Qt.Key.Key_Return)
    assert "two clicks" in motion.problem.text()
    V = session.store.state.document.mesh.V
    front = V[:, 2] > 0.5 * V[:, 2].max()
    ends = [
        V[np.flatnonzero(front)[np.argmin(np.abs(V[front] - at).sum(axis=1))]]
        for at in ((-1.0, 6.0, 3.0), (1.5, 9.0, 3.0))
    ]
    motion.pick.click()
    assert bottle.status.currentMessage().startswith("Click two points")
    hand = mouse(bottle.canvas.viewport)
    expected = []
    for end in ends:
        at = on_screen(bottle, end)
        expected.append(bottle.canvas.surface.hit(at).point)
        hand.move(at)
        hand.drag(at, at)
    np.testing.assert_allclose(bottle.canvas.picker.marked_points, expected)
    assert bottle.status.currentMessage() == ""
    qtbot.keyClick(motion.amount, Qt.Key.Key_Return)
    pose = session.store.state.document.handles[0].pose
    np.testing.assert_allclose(transform(pose, np.array(expected)), expected, atol=1e-9)
    assert np.trace(pose[:3, :3]) == pytest.approx(1 + 2 * np.cos(np.pi / 9))
    assert session.gestures.history.next_undo_name == "Bend about a line +20° (Handle 1)"
    motion.choice.setCurrentIndex(0)
    assert len(bottle.canvas.picker.marked_points) == 0


def test_pick_line_is_called_off_by_escape_after_its_first_click(bottle, mouse):
    view = bottle.canvas.viewport
    bottle.edits.pick_line()
    at = on_screen(bottle, bottle.session.store.state.document.mesh.V.mean(axis=0))
    mouse(view).drag(at, at)
    QTest.keyClick(view, Qt.Key.Key_Escape)
    assert bottle.status.currentMessage() == ""
    mouse(view).drag(at, at)
    assert bottle.canvas.bend_line is None


def test_text_entries_name_the_part_that_they_paint(qtbot, bottle):
    """Also with a tool that paints nothing: the active handle is painted then."""
    bottle.tools.choose_tool(Tool.MEASURE)
    bottle.actions_.select.by_expression.trigger()
    entered(qtbot, bottle.edits.text_entries.vertices, "0-9")
    assert bottle.session.gestures.history.next_undo_name == Tool.HANDLE.traits.title
