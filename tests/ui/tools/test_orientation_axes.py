"""The axes in the corner of the view, with a real mouse."""

import numpy as np
import pytest
from driving import Mouse, document, settle, work_off
from PySide6.QtCore import QPointF, QSize, Qt

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.scene.scene_picture import scene_picture
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.gizmo_drawing import AXIS_COLOURS
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench


def end_of(window, axis, sign):
    """Place of an end of an axis, by the way it is seen."""
    direction = sign * np.eye(3)[axis]
    (found,) = (end for end in window.canvas.orientation.ends if np.allclose(end.direction, direction))
    return found.place


def eye(window):
    return window.canvas.viewport.camera_controller.camera


def click(window, at):
    Mouse(window.canvas.viewport).drag(at)


@pytest.mark.parametrize("up_axis", [UpAxis.PLUS_Y, UpAxis.PLUS_Z, UpAxis.MINUS_X])
def test_orientation_axes_look_along_the_end_that_is_clicked(bottle, up_axis):
    bottle.canvas.set_up_axis(up_axis)
    for axis in range(3):
        for sign in (1, -1):
            bottle.canvas.viewport.camera_controller.look_from_home()
            click(bottle, end_of(bottle, axis, sign))
            right, up, forward = eye(bottle).axes
            np.testing.assert_allclose(forward, -sign * np.eye(3)[axis], atol=1e-9)
            if axis != up_axis.index:
                np.testing.assert_allclose(up, up_axis.direction, atol=1e-9)
            assert abs(right @ up_axis.direction) < 1e-9, "level"


def test_orientation_axes_stand_as_the_mesh_is_seen(bottle):
    """The oracle is the projection of the axes by the camera of the view."""
    look = bottle.canvas.viewport.camera_controller
    look.camera = look.camera.orbited(130.0, -40.0)
    origin = eye(bottle).focal
    for axis in range(3):
        ends = np.array([origin, origin + 1e-3 * np.eye(3)[axis]])
        seen = np.subtract(*eye(bottle).project(ends)[::-1])
        drawn = end_of(bottle, axis, 1) - end_of(bottle, axis, -1)
        across = seen[0] * drawn.y() - seen[1] * drawn.x()
        assert abs(across) <= 1e-3 * np.hypot(*seen) * np.hypot(drawn.x(), drawn.y())
        assert seen @ [drawn.x(), drawn.y()] > 0.0


def test_orientation_axes_look_from_behind_by_a_second_click(bottle):
    click(bottle, end_of(bottle, 2, 1))
    at = end_of(bottle, 2, 1)
    click(bottle, at)
    np.testing.assert_allclose(eye(bottle).axes[2], [0.0, 0.0, 1.0], atol=1e-9)
    click(bottle, at)
    np.testing.assert_allclose(eye(bottle).axes[2], [0.0, 0.0, -1.0], atol=1e-9)


def test_orientation_axes_orbit_by_a_drag(bottle):
    before, at = eye(bottle), end_of(bottle, 0, 1)
    Mouse(bottle.canvas.viewport).drag(at, at + QPointF(-30, 0), at + QPointF(-60, 10))
    np.testing.assert_allclose(eye(bottle).axes, before.orbited(-30, 0).orbited(-30, 10).axes, atol=1e-9)


def test_orientation_axes_leave_strokes_beside_them_and_across_them_to_the_brush(qtbot, bottle):
    view, look = bottle.canvas.viewport, bottle.canvas.viewport.camera_controller
    bottle.tools.choose_tool(Tool.REGION)
    look.camera = look.camera.zoomed(eye(bottle).focal, 12.0)  # the mesh fills the view
    settle(qtbot, view)
    at = end_of(bottle, 0, 1)
    beside = at + QPointF(0, 24)
    assert bottle.canvas.surface.hit(beside) is not None
    stand = eye(bottle).position.copy()
    Mouse(view).drag(beside, at, at - QPointF(20, 0))
    assert (document(bottle).member == 1).any()
    np.testing.assert_array_equal(eye(bottle).position, stand)


def test_orientation_axes_are_lit_under_the_cursor_and_cost_no_draw(qtbot, bottle):
    view, at = bottle.canvas.viewport, end_of(bottle, 1, -1)

    def drawn():
        return view.tool_layer.grab().toImage().pixelColor((at - QPointF(5.0, 0.0)).toPoint()).name()

    settle(qtbot, view)
    count, plain = view.draw_count, drawn()
    Mouse(view).move(at)
    assert view.cursor().shape() is Qt.CursorShape.PointingHandCursor
    assert drawn() != plain
    Mouse(view).move((4, view.height() - 4))
    assert drawn() == plain
    work_off()
    assert view.draw_count == count


@pytest.mark.parametrize("scheme", [Qt.ColorScheme.Light, Qt.ColorScheme.Dark])
def test_orientation_axes_have_the_colors_of_the_theme(qtbot, bottle, scheme):
    bottle.actions_.view.schemes[scheme].trigger()
    work_off()
    drawn = bottle.canvas.viewport.tool_layer.grab().toImage()
    for axis, color in enumerate(AXIS_COLOURS[scheme is Qt.ColorScheme.Dark]):
        at = end_of(bottle, axis, 1) + QPointF(-6.0, 0.0)  # beside the letter
        assert drawn.pixelColor(at.toPoint()).name() == color
    bottle.actions_.view.schemes[Qt.ColorScheme.Unknown].trigger()


def test_orientation_axes_are_in_no_picture(qtbot, bottle):
    view = bottle.canvas.viewport
    settle(qtbot, view)
    shown = scene_picture(view, QSize(200, 150))
    bottle.actions_.display.switches["orientation"].trigger()
    assert bottle.canvas.orientation.ends == []
    assert scene_picture(view, QSize(200, 150)) == shown


def test_orientation_axes_stay_hidden(qtbot, bottle, settings):
    bottle.actions_.display.switches["orientation"].trigger()
    other = Workbench(Shell(settings))
    qtbot.addWidget(other.shell)
    assert not other.canvas.orientation.visible
    other.shell.close()


def test_orientation_axes_shrink_with_the_view(bottle):
    bottle.shell.resize(1280, 900)
    work_off()
    wide = end_of(bottle, 1, 1) - end_of(bottle, 1, -1)
    bottle.docks["plots"].show()
    bottle.shell.resize(800, 640)
    work_off()
    narrow = end_of(bottle, 1, 1) - end_of(bottle, 1, -1)
    assert np.hypot(narrow.x(), narrow.y()) < 0.9 * np.hypot(wide.x(), wide.y())
