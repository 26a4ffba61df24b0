"""Moving handles by hand, by keys and by typing, with the real window."""

import re

import numpy as np
import pytest
from driving import idle
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.api import deform
from apd_viewer.files.samples import resource_path
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.pose.constraints import HANDLE, transform
from apd_viewer.presentation import readings
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.gizmo_drag import ARROWS, RING_RADIUS, RINGS, GizmoOrientation
from apd_viewer.ui.tools.tool_modes import Tool

CONTROL = Qt.KeyboardModifier.ControlModifier


def pose(window):
    return window.session.store.state.document.handles[0].pose


def typed(qtbot, window, motion, text):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData(motion))
    field.amount.clear()
    QTest.keyClicks(field.amount, text)
    qtbot.keyClick(field.amount, Qt.Key.Key_Return)


def on_ring(window, i, turn):
    frame = window.canvas.gizmo.frame
    a, b = frame.axes[(i + 1) % 3], frame.axes[(i + 2) % 3]
    place = frame.centre + RING_RADIUS * frame.pixel_length * (np.cos(turn) * a + np.sin(turn) * b)
    return QPointF(*frame.camera.project(place[None])[0])


def test_motion_field_twist_is_the_same_as_the_ring_dragged_and_the_matrix(qtbot, bottle, mouse):
    by_matrix = read_transform(resource_path("bottle-twist-60.def"))
    held, mesh = bottle.session.store.state.document.constraints(), bottle.session.store.state.document.mesh
    targets = mesh.V[held.fixed].copy()
    moved = bottle.session.store.state.document.labels[held.fixed] >= HANDLE
    targets[moved] = transform(by_matrix, targets[moved])
    result = deform(mesh.V, mesh.F, held.fixed, targets, iterations=3)
    np.testing.assert_allclose(result.U[held.fixed], targets, rtol=0, atol=1e-9)

    def arrives():
        U = bottle.session.store.state.frame.U[held.fixed]
        return np.abs(U - targets).max() <= 1e-9

    typed(qtbot, bottle, "TWIST", "60deg")
    by_typing = pose(bottle)
    assert bottle.session.gestures.history.next_undo_name == "Twist +60° (Handle 1)"
    qtbot.waitUntil(arrives)
    bottle.session.gestures.undo()
    assert not arrives()
    frame = bottle.canvas.gizmo.frame
    near = np.arctan2(*frame.view_cosines[[0, 2]])
    at = [on_ring(bottle, 1, near + a) for a in np.linspace(-1.2, 0.2, 60)]
    begin = next(k for k, p in enumerate(at) if frame.handle_at(p.x(), p.y()) == "ry")
    start = near - 1.2 + 1.4 * begin / 59
    way = [on_ring(bottle, 1, start + a) for a in np.linspace(0.0, np.pi / 3, 12)]
    mouse(bottle.canvas.viewport).drag(*way, modifiers=CONTROL)
    by_hand = pose(bottle)
    np.testing.assert_allclose(by_typing, by_hand, rtol=0, atol=1e-9)
    np.testing.assert_allclose(by_typing, by_matrix, rtol=0, atol=1e-9)
    qtbot.waitUntil(arrives)


@pytest.mark.parametrize("axis", ["front", "side", "top", "-front", "-side", "-top"])
def test_gizmo_arrows_and_rings_move_the_way_the_cursor_goes(bottle, mouse, axis):
    view = bottle.canvas.viewport
    view.camera_controller.show_standard_view(axis)
    bottle.canvas.frame_mesh()
    # Not straight along an axis, or one arrow could not be seen.
    view.camera_controller.camera = view.camera_controller.camera.orbited(60.0, 23.0)
    hand = mouse(view)
    usable = [i for i in range(3) if bottle.canvas.gizmo.frame.is_usable(ARROWS[i])]
    assert len(usable) >= 2
    for i in usable:
        frame = bottle.canvas.gizmo.frame
        start, tip = frame.arrow(i)[1], frame.arrow(i)[2]
        end = start + 0.6 * (tip - frame.screen_centre)
        hand.drag(QPointF(*start), QPointF(*(start + end) / 2), QPointF(*end))
        went = bottle.canvas.gizmo.frame.screen_centre - frame.screen_centre
        assert went @ (end - start) > 0.8 * np.linalg.norm(went) * np.linalg.norm(end - start), f"arrow {i}"
        bottle.session.gestures.undo()
    for i in range(3):
        frame = bottle.canvas.gizmo.frame
        points, near = frame.ring(i)
        k = int(np.flatnonzero(near)[len(np.flatnonzero(near)) // 2])
        ahead = points[(k + 3) % 72]
        taken = frame.handle_at(*points[k])
        if taken != RINGS[i]:
            continue  # another handle lies over this place of the ring
        grabbed = points_of_the_body(frame, i, points[k])
        hand.drag(QPointF(*points[k]), QPointF(*(points[k] + ahead) / 2), QPointF(*ahead))
        motion = pose(bottle)
        went = frame.camera.project(transform(motion, grabbed[None]))[0] - points[k]
        assert went @ (ahead - points[k]) > 0, f"ring {i}"
        bottle.session.gestures.undo()


def points_of_the_body(frame, i, at):
    """The point of the ring's circle in space that is seen at a place."""
    turn = np.linspace(0.0, 2 * np.pi, 721)
    a, b = frame.axes[(i + 1) % 3], frame.axes[(i + 2) % 3]
    circle = frame.centre + RING_RADIUS * frame.pixel_length * (
        np.outer(np.cos(turn), a) + np.outer(np.sin(turn), b)
    )
    near = (
        frame.camera.depth(circle)
        <= frame.camera.depth(frame.centre) + 0.2 * RING_RADIUS * frame.pixel_length
    )
    apart = np.linalg.norm(frame.camera.project(circle) - at, axis=1) + np.where(near, 0.0, 1e6)
    return circle[np.argmin(apart)]


@pytest.mark.parametrize(("text", "words"), [("5 parsec", "parsec"), ("", "."), ("3mm", "length")])
def test_motion_field_says_beneath_what_is_wrong_with_what_was_typed(qtbot, bottle, text, words):
    before = bottle.session.store.state
    typed(qtbot, bottle, "TWIST", text)
    field = bottle.panel.handles.motion
    assert field.problem.isVisibleTo(field)
    assert words in field.problem.text()
    assert bottle.session.store.state is before
    typed(qtbot, bottle, "TWIST", "10")
    assert not field.problem.isVisibleTo(field)
    assert bottle.session.store.state is not before


def test_motion_field_gets_the_focus_by_ctrl_m(qtbot, bottle):
    bottle.panel.handles.is_folded = True
    bottle.actions_.pose.enter_motion.trigger()
    field = bottle.panel.handles.motion.amount
    qtbot.waitUntil(lambda: bottle.shell.focusWidget() is field)
    qtbot.keyClick(field, Qt.Key.Key_Escape)
    assert bottle.shell.focusWidget() is not field


def painted_at(window, place):
    """Label of the triangle that is seen at a place; None where there is nothing."""
    hit, surface = window.canvas.surface.hit(place), window.canvas.surface
    return (
        None
        if hit is None
        else window.session.store.state.document.labels[surface.surface_index.F[hit.face]].max()
    )


def test_gizmo_is_dragged_by_the_painted_patch_in_the_plane_of_the_picture(qtbot, bottle, mouse):
    view, canvas = bottle.canvas.viewport, bottle.canvas
    eye = view.camera_controller.camera
    document = bottle.session.store.state.document
    places = view.camera_controller.camera.project(document.mesh.V[document.labels == HANDLE])
    free = [
        QPointF(*place)
        for place in places[::37]
        if canvas.gizmo.frame.handle_at(*place) is None and painted_at(bottle, QPointF(*place)) == HANDLE
    ]
    at = free[0]
    mouse(view).drag(at, at + QPointF(20, -10), at + QPointF(40, -25))
    assert view.camera_controller.camera.key == eye.key, "the camera stays"
    moved = pose(bottle)[:3, 3]
    assert abs(moved @ eye.axes[2]) < 1e-9
    went = (
        view.camera_controller.camera.project(document.centre(0)[None] + moved)[0]
        - view.camera_controller.camera.project(document.centre(0)[None])[0]
    )
    np.testing.assert_allclose(went, [40, -25], atol=1e-6)
    title = bottle.session.gestures.history.next_undo_name
    assert re.fullmatch(r"Move [\d.]+ \(Handle 1\)", title), title


def test_canvas_lets_a_press_beside_the_patch_move_the_camera(bottle, mouse):
    view = bottle.canvas.viewport
    before, eye = bottle.session.store.state, view.camera_controller.camera
    at = view.camera_controller.camera.project(
        before.document.mesh.V[before.document.labels == 1].mean(axis=0)[None]
    )[0]
    mouse(view).drag(QPointF(*at), QPointF(*at) + QPointF(30, 5))
    assert bottle.session.store.state is before
    assert view.camera_controller.camera.key != eye.key


def test_gizmo_scales_about_the_center_by_its_corner(bottle, mouse):
    gizmo = bottle.canvas.gizmo
    frame = gizmo.frame
    corner, middle = frame.scale_corner, frame.screen_centre
    mouse(bottle.canvas.viewport).drag(QPointF(*corner), QPointF(*(middle + 1.5 * (corner - middle))))
    np.testing.assert_allclose(pose(bottle)[:3, :3], 1.5 * np.eye(3), rtol=0.02)
    np.testing.assert_allclose(gizmo.frame.centre, frame.centre, atol=1e-9)
    mouse(bottle.canvas.viewport).drag(QPointF(*corner), QPointF(*middle), modifiers=CONTROL)
    assert pose(bottle)[0, 0] == pytest.approx(0.15, rel=0.02), "no handle is scaled to nothing"


def test_nudge_moves_in_the_picture_by_arrow_keys_and_nowhere_else(qtbot, bottle):
    view = bottle.canvas.viewport
    bottle.shell.activateWindow()
    view.setFocus()
    steps = len(bottle.session.gestures.history.undo_names)
    for nudge in bottle.actions_.pose.nudges:
        assert nudge.shortcutContext() is Qt.ShortcutContext.WidgetShortcut
        before = bottle.canvas.gizmo.frame.screen_centre
        nudge.trigger()
        went = bottle.canvas.gizmo.frame.screen_centre - before
        if "left" in nudge.text():
            assert went[0] < -2
            assert abs(went[1]) < 0.5
        if "up" in nudge.text():
            assert went[1] < -2
    assert len(bottle.session.gestures.history.undo_names) == steps + 1, (
        "presses that follow each other are one step"
    )
    np.testing.assert_allclose(pose(bottle), np.eye(4), atol=1e-12)


def test_gizmo_axes_are_those_that_were_chosen(bottle):
    gizmo, along = bottle.canvas.gizmo, bottle.actions_.pose.orientations
    bottle.session.handles.move_by(MOTIONS["TURN_X"], "30", 0)
    along[GizmoOrientation.HANDLE].trigger()
    np.testing.assert_allclose(gizmo.frame.axes, pose(bottle)[:3, :3].T, atol=1e-12)
    along[GizmoOrientation.VIEW].trigger()
    axes = gizmo.frame.axes
    np.testing.assert_allclose(axes[:2], bottle.canvas.viewport.camera_controller.camera.axes[:2])
    assert np.linalg.det(axes) == pytest.approx(1.0)
    along[GizmoOrientation.WORLD].trigger()
    np.testing.assert_array_equal(gizmo.frame.axes, np.eye(3))
    assert [action.isChecked() for action in along.values()] == [True, False, False]


def test_handle_section_puts_a_handle_back_by_its_button(qtbot, bottle):
    back = bottle.panel.handles.reset_handle
    assert not back.isEnabled()
    bottle.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    assert back.isEnabled()
    qtbot.mouseClick(back, Qt.MouseButton.LeftButton)
    assert not bottle.session.store.state.document.is_posed
    assert not back.isEnabled()


def test_history_list_goes_to_the_step_that_is_clicked(qtbot, bottle):
    states = [bottle.session.store.state]
    for angle in ("10", "20"):
        bottle.session.handles.move_by(MOTIONS["TWIST"], angle, 0)
        idle(qtbot, bottle)
        states.append(bottle.session.store.state)
    bottle.tools.choose_tool(Tool.ORBIT)
    bottle.docks["history"].show()
    steps = bottle.shell.history
    names = ["Open bottle.obj", "Twist +10° (Handle 1)", "Twist +20° (Handle 1)"]
    assert [steps.item(k).text() for k in range(steps.count())] == names
    for k in (1, 0, 2, 1):
        at = steps.visualItemRect(steps.item(k)).center()
        qtbot.mouseClick(steps.viewport(), Qt.MouseButton.LeftButton, pos=at)
        assert bottle.session.store.state is states[k]
        assert steps.currentRow() == k
        assert steps.item(k).font().bold()


def test_pick_pivot_makes_rings_turn_about_the_point_and_is_a_step_of_undo(bottle, mouse):
    view, session = bottle.canvas.viewport, bottle.session
    before = session.store.state
    at = view.camera_controller.camera.project(
        before.document.mesh.V[before.document.labels == 1].mean(axis=0)[None]
    )[0]
    point = bottle.canvas.surface.hit(QPointF(*at)).point
    bottle.actions_.pose.pivots[0].trigger()
    hand, eye = mouse(view), view.camera_controller.camera
    hand.move(QPointF(*at))
    hand.drag(QPointF(*at), QPointF(*at))
    assert view.camera_controller.camera.key == eye.key
    np.testing.assert_allclose(bottle.canvas.gizmo.frame.centre, point, atol=1e-9)
    assert session.gestures.history.next_undo_name == "Move pivot"
    session.handles.move_by(MOTIONS["TURN_Z"], "30deg", 0)
    np.testing.assert_allclose(transform(pose(bottle), point[None])[0], point, atol=1e-9)
    session.handles.move_by(MOTIONS["MOVE_X"], "1", 0)
    np.testing.assert_allclose(bottle.canvas.gizmo.frame.centre, point + [1, 0, 0], atol=1e-9)
    bottle.actions_.pose.pivots[2].trigger()
    centre = transform(pose(bottle), session.store.state.document.centre(0)[None])[0]
    np.testing.assert_allclose(bottle.canvas.gizmo.frame.centre, centre, atol=1e-9)
    for _ in range(4):
        session.gestures.undo()
    assert session.store.state is before


def test_pick_pivot_is_called_off_by_escape(bottle, mouse):
    view = bottle.canvas.viewport
    before = bottle.session.store.state
    bottle.actions_.pose.pivots[0].trigger()
    QTest.keyClick(view, Qt.Key.Key_Escape)
    at = view.camera_controller.camera.project(
        before.document.mesh.V[before.document.labels == 1].mean(axis=0)[None]
    )[0]
    mouse(view).drag(QPointF(*at), QPointF(*at))
    assert bottle.session.store.state is before


def test_bake_moves_neither_camera_nor_tool_and_nothing_has_changed_since(qtbot, bottle):
    session, view = bottle.session, bottle.canvas.viewport
    bottle.tools.choose_tool(Tool.BASE)
    session.handles.move_by(MOTIONS["BEND_Z"], "20deg", 0)
    assert session.wait_idle(20.0)
    before, eye, title = session.store.state, view.camera_controller.camera.key, bottle.shell.windowTitle()
    bottle.actions_.bake.trigger()
    qtbot.waitUntil(lambda: session.store.state.document.mesh is not before.document.mesh)
    assert (view.camera_controller.camera.key, bottle.shell.windowTitle(), bottle.canvas.tool) == (
        eye,
        title,
        Tool.BASE,
    )
    assert bottle.panel.area.percent.text() == "100.000 %"
    assert not bottle.actions_.bake.isEnabled()
    np.testing.assert_array_equal(bottle.canvas.surface.U, before.frame.U)
    assert np.abs(bottle.display_options.overlay.mesh.V - before.frame.U).max() == 0.0
    bottle.actions_.undo.trigger()
    assert session.store.state is before
    assert view.camera_controller.camera.key == eye
    assert bottle.display_options.overlay.mesh is before.document.mesh


@pytest.mark.night
def test_gizmo_remembers_a_ring_dragged_round_more_than_once_as_one_step(qtbot, bottle, mouse):
    bottle.session.settings.set_contact(False)
    at_rest = bottle.session.store.state
    frame = bottle.canvas.gizmo.frame
    near = np.arctan2(*frame.view_cosines[[0, 2]])
    at = [on_ring(bottle, 1, near + a) for a in np.linspace(-1.2, 0.2, 60)]
    begin = next(k for k, p in enumerate(at) if frame.handle_at(p.x(), p.y()) == "ry")
    start = near - 1.2 + 1.4 * begin / 59
    way = [on_ring(bottle, 1, start + a) for a in np.linspace(0.0, np.deg2rad(400), 81)]
    mouse(bottle.canvas.viewport).drag(*way)
    document = bottle.session.store.state.document
    assert np.rad2deg(np.linalg.norm(document.handles[0].rotation)) == pytest.approx(400, abs=1.0)
    said = readings.motion(bottle.session.store.state, 0, Unit.NONE)
    assert re.search(r"twisted \+(399|400|401)\.\d°", said)
    qtbot.waitUntil(lambda: bottle.session.store.state.frame.settled, timeout=60_000)
    held = document.constraints()
    np.testing.assert_allclose(bottle.session.store.state.frame.U[held.fixed], held.targets, atol=1e-9)
    bottle.session.gestures.undo()
    assert bottle.session.store.state is at_rest
