"""Obstacles in a window, with a real mouse: placed, taken, dragged, typed, undone and removed."""

from dataclasses import replace

import numpy as np
import pytest
from driving import Mouse, document, idle, settle
from meshes import sphere
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.tools.tool_modes import Tool

PLATE, SPHERE, CYLINDER = ObstacleKind


def there(window):
    return document(window).obstacles


def steps(window):
    return window.session.gestures.history.undo_names


def names(window):
    return [row.name.text() for row in window.panel.obstacles.list.rows]


def on_screen(window, point):
    return window.canvas.viewport.camera_controller.camera.project(np.asarray(point, float)[None])[0]


def middle(window):
    """A pixel at which the belly of the bottle is seen."""
    U = window.session.store.state.frame.U
    return on_screen(window, 0.5 * (U.min(axis=0) + U.max(axis=0)))


def click(window, at, modifiers=Qt.KeyboardModifier.NoModifier):
    mouse = Mouse(window.canvas.viewport)
    mouse.move(at, modifiers)
    mouse.press(at, modifiers=modifiers)
    mouse.release(at, modifiers=modifiers)


def drag(window, start, way):
    mouse = Mouse(window.canvas.viewport)
    mouse.move(start)
    mouse.drag(start, *(start + t * np.asarray(way, float) for t in np.linspace(0.2, 1.0, 5)))


def arrow(window):
    """Where the arrow of the gizmo along its third axis is taken, and the way there from its foot, pixels."""
    foot, tip = window.obstacles.gizmo.frame.arrow(2)[:2]
    return tip, (tip - foot) / np.linalg.norm(tip - foot)


def type_into(qtbot, field, text):
    field.setFocus()
    field.selectAll()
    QTest.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Return)


@pytest.fixture
def held(qtbot, bottle):
    """The bottle in an active window, seen askew."""
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    yield bottle
    idle(qtbot, bottle)


@pytest.fixture
def floored(held):
    """With a floor, in the hand."""
    held.actions_.simulate.obstacles.floor.trigger()
    return held


def test_obstacle_placer_places_what_was_asked_for_by_a_click(qtbot, held):
    window, section, view = held, held.panel.obstacles, held.canvas.viewport
    assert section.isHidden()
    window.actions_.simulate.obstacles.kinds[SPHERE].trigger()
    assert "Click the surface" in window.status.currentMessage()
    at = middle(window)
    Mouse(view).move(at)
    (preview,) = window.obstacles.scene.drawn_obstacles
    assert preview.obstacle.kind is SPHERE
    assert there(window) == ()
    Mouse(view).move((3, 3))  # beside the surface there is none
    assert window.obstacles.scene.drawn_obstacles == ()
    drag(window, np.array([5.0, 5.0]), (30, 0))  # and a drag turns the camera
    assert window.obstacles.placer.kind is SPHERE
    at = middle(window)
    click(window, at)
    (sphere,) = there(window)
    hit = window.canvas.surface.hit(QPointF(*at))
    away = sphere.place - hit.point
    assert np.linalg.norm(away) == pytest.approx(sphere.radius, rel=0.1)
    np.testing.assert_allclose(sphere.axis, -away / np.linalg.norm(away), atol=1e-6)
    assert document(window).settings.contact
    assert names(window) == ["Sphere 1"]
    assert window.parts.obstacle == 0
    assert window.obstacles.placer.kind is None
    assert window.status.currentMessage() == "" or "Click" not in window.status.currentMessage()
    click(window, at + [0, 60])  # one click places one
    assert len(there(window)) == 1
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert there(window) == ()
    assert names(window) == []
    assert section.isHidden()
    assert window.obstacles.scene.drawn_obstacles == ()
    assert not window.obstacles.gizmo.visible
    qtbot.keyClick(
        window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    )
    assert there(window) == (sphere,)


def test_obstacle_section_places_the_obstacle_of_another_entry_instead(qtbot, held):
    window, actions, view = held, held.actions_.simulate.obstacles, held.canvas.viewport
    for kind in (CYLINDER, SPHERE):
        actions.kinds[kind].trigger()
        assert window.obstacles.placer.kind is kind
        assert "Click the surface" in window.status.currentMessage()
    Mouse(view).move(middle(window))
    (preview,) = window.obstacles.scene.drawn_obstacles
    assert preview.obstacle.kind is SPHERE
    actions.floor.trigger()
    assert window.obstacles.placer.kind is None
    assert names(window) == ["Floor"]
    assert view.hasFocus()  # where the arrow keys nudge it


def test_obstacle_placer_gives_up_by_esc_and_with_another_tool(qtbot, held):
    window, view = held, held.canvas.viewport
    window.actions_.simulate.obstacles.kinds[CYLINDER].trigger()
    Mouse(view).move(middle(window))
    assert len(window.obstacles.scene.drawn_obstacles) == 1
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert window.obstacles.placer.kind is None
    assert window.obstacles.scene.drawn_obstacles == ()
    assert window.canvas.tool is Tool.MOVE
    window.actions_.simulate.obstacles.kinds[PLATE].trigger()
    qtbot.keyClick(window.shell, Qt.Key.Key_B)
    assert window.obstacles.placer.kind is None
    click(window, middle(window))
    assert there(window) == ()


def test_undo_takes_a_step_back_while_an_obstacle_waits_for_its_place(qtbot, floored):
    window = floored
    window.actions_.simulate.obstacles.kinds[SPHERE].trigger()
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.obstacles.placer.kind is None
    assert there(window) == ()


def test_obstacle_placer_snaps_a_plate_to_an_axis_with_ctrl(held):
    window = held
    window.actions_.simulate.obstacles.kinds[PLATE].trigger()
    click(window, middle(window) + [20, 0], Qt.KeyboardModifier.ControlModifier)
    (plate,) = there(window)
    np.testing.assert_array_equal(np.sort(np.abs(plate.axis)), [0, 0, 1])
    U = window.session.store.state.frame.U
    assert ((U - plate.place) @ plate.axis).min() > 0.0


def test_obstacle_actions_put_and_remove_floor_and_plates(held):
    window, actions = held, held.actions_.simulate.obstacles
    assert not actions.remove.isEnabled()
    actions.floor.trigger()
    actions.side_plates[0].trigger()
    assert names(window) == ["Floor", "Plate 1", "Plate 2"]
    assert window.parts.obstacle == 1
    assert steps(window)[-2:] == ["Add floor", "Put plates on both sides"]
    actions.remove.trigger()
    assert names(window) == ["Floor", "Plate 2"]
    assert window.parts.obstacle == 1
    window.panel.obstacles.list.rows[0].remove.click()
    assert names(window) == ["Plate 2"]
    assert window.parts.obstacle == 0  # the same one


def test_gizmo_drags_a_plate_along_its_normal(qtbot, floored):
    window = floored
    assert window.canvas.is_handle_inactive
    assert not window.canvas.gizmo.visible
    tip, way = arrow(window)
    before = document(window)
    drag(window, tip, -40 * way)
    (floor,) = there(window)
    pixel = window.canvas.viewport.camera_controller.camera.world_per_pixel(floor.place)
    assert floor.shift @ floor.axis < -20 * pixel
    assert np.linalg.norm(np.cross(floor.shift, floor.axis)) < 1e-12
    distance = f"{-floor.shift @ floor.axis:.4g}"
    assert steps(window)[-1] == f"Move Floor by −{distance}"
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert document(window) is before
    tip, way = arrow(window)
    mouse = Mouse(window.canvas.viewport)
    mouse.move(tip)
    mouse.press(tip)
    mouse.move(tip - 20 * way)
    assert there(window)[0].shift.any()
    qtbot.keyClick(window.canvas.viewport, Qt.Key.Key_Escape)
    assert document(window) is before
    mouse.release(tip - 20 * way)
    assert document(window) is before


def test_obstacle_picker_takes_a_plate_by_a_click_and_a_drag_on_it_turns_the_camera(qtbot, floored):
    window, view = floored, floored.canvas.viewport
    window.parts.choose_obstacle(None)
    assert window.canvas.gizmo.visible
    assert not window.obstacles.gizmo.visible
    shape = window.obstacles.scene.drawn_obstacles[0]
    U = window.session.store.state.frame.U
    corner = shape.obstacle.place + 0.95 * (np.ptp(U, axis=0) * [0.5, 0.0, 0.5]) * [1, 0, 1]
    at = on_screen(window, corner)
    assert window.canvas.surface.hit(QPointF(*at)) is None
    Mouse(view).move(at)
    assert window.obstacles.scene.drawn_obstacles[0].is_hovered
    eye = view.camera_controller.camera.key
    drag(window, at, (25, 10))
    assert view.camera_controller.camera.key != eye
    assert window.parts.obstacle is None
    click(window, on_screen(window, corner))
    assert window.parts.obstacle == 0
    assert window.obstacles.gizmo.visible
    assert not window.canvas.gizmo.visible
    # A press on the patch of the handle takes the handle again, and begins to drag it.
    patch = U[document(window).labels == 2].mean(axis=0)
    click(window, on_screen(window, patch))
    assert window.parts.obstacle is None
    assert window.canvas.gizmo.visible
    settle(qtbot, view)


def test_obstacle_picker_takes_and_moves_a_sphere_by_one_drag(held):
    window = held
    window.actions_.simulate.obstacles.kinds[SPHERE].trigger()
    at = middle(window)
    click(window, at)
    window.parts.choose_obstacle(None)
    place = there(window)[0].place
    seen = on_screen(window, place)
    drag(window, seen + [14, 0], (60, 0))
    assert window.parts.obstacle == 0
    (sphere,) = there(window)
    assert np.linalg.norm(on_screen(window, sphere.centre) - seen - [60, 0]) < 2.0
    np.testing.assert_array_equal(sphere.place, place)
    assert steps(window)[-1].startswith("Move Sphere 1 by ")


def test_obstacle_fields_place_an_obstacle_anew_by_typed_numbers(qtbot, floored):
    window, fields = floored, floored.panel.obstacles.fields
    window.choose_unit(Unit.CENTIMETRE)
    low = there(window)[0].place[1]
    assert fields.radius.isHidden()
    type_into(qtbot, fields.place, "0, -10mm, 0")
    np.testing.assert_allclose(there(window)[0].place, [0, -1, 0])
    assert steps(window)[-1] == "Place Floor"
    assert window.shell.focusWidget() is not fields.place  # the keys are the document's
    type_into(qtbot, fields.axis, "0, 1, 1/4")
    np.testing.assert_allclose(there(window)[0].axis, np.array([0, 4, 1]) / np.sqrt(17))
    type_into(qtbot, fields.axis, "0, 1, 0")
    type_into(qtbot, fields.place, "0, 0.5Y, 0")  # it would cut the shape
    assert there(window)[0].place[1] == pytest.approx(low, abs=1e-9)
    assert "moved back" in window.notice.text
    done = len(steps(window))
    for wrong, field in (("0, 1", fields.place), ("0, x, 0", fields.place), ("0, 0, 0", fields.axis)):
        before = document(window)
        type_into(qtbot, field, wrong)
        assert field.error.isVisible()
        assert field.text() == wrong
        assert document(window) is before
        qtbot.keyClick(field, Qt.Key.Key_Escape)
        assert field.text() != wrong
        assert not field.error.isVisible()
    fields.place.setFocus()
    fields.place.show_text("0, -2, 0")  # as while it moves
    QTest.keyClicks(fields.place, "1")
    qtbot.keyClick(fields.place, Qt.Key.Key_Escape)
    assert fields.place.text() == "0, -2, 0"
    assert len(steps(window)) == done


def test_obstacle_fields_say_the_unit_of_lengths_and_only_of_bare_numbers(qtbot, held):
    window, fields = held, held.panel.obstacles.fields
    window.actions_.simulate.obstacles.kinds[CYLINDER].trigger()
    click(window, middle(window))
    lengths = fields.place, fields.radius, fields.length
    for unit, symbol in ((Unit.NONE, ""), (Unit.CENTIMETRE, "cm"), (Unit.INCH.as_guess, "in?")):
        window.choose_unit(unit)
        assert [field.shown_unit for field in (*lengths, fields.axis)] == [symbol] * 3 + [""]
    fields.radius.setText("5mm")
    assert fields.radius.shown_unit == "", "the text has a unit of its own"
    window.choose_unit(Unit.CENTIMETRE)
    fields.radius.setText(fields.length.text())
    assert fields.radius.shown_unit == "cm"
    drawn = fields.radius.grab().toImage()
    fields.radius.show_unit("")
    assert fields.radius.grab().toImage() != drawn


def test_entered_field_tells_when_it_is_left_too_and_takes_a_wrong_text_back(qtbot, held):
    window, fields = held, held.panel.obstacles.fields
    window.actions_.simulate.obstacles.kinds[CYLINDER].trigger()
    click(window, middle(window))
    before = there(window)[0]
    fields.radius.setFocus()
    fields.radius.selectAll()
    QTest.keyClicks(fields.radius, "0.5")
    fields.length.setFocus()
    assert there(window)[0].radius == 0.5
    assert there(window)[0].length == before.length  # to the last digit
    np.testing.assert_array_equal(there(window)[0].axis, before.axis)
    fields.length.selectAll()
    QTest.keyClicks(fields.length, "-3")
    window.canvas.viewport.setFocus()
    assert there(window)[0].length == before.length
    assert fields.length.text() == f"{before.length:.5g}"


def test_obstacle_fields_move_an_obstacle_by_a_typed_distance(qtbot, floored):
    window, fields = floored, floored.panel.obstacles.fields
    assert not fields.reset.isEnabled()
    type_into(qtbot, fields.distance, "-0.25")
    np.testing.assert_allclose(there(window)[0].shift, [0, -0.25, 0])
    assert steps(window)[-1] == "Move Floor by −0.25"
    fields.along.setCurrentIndex(1)
    type_into(qtbot, fields.distance, "0.5")
    np.testing.assert_allclose(there(window)[0].shift, [0.5, -0.25, 0])
    type_into(qtbot, fields.distance, "half")
    assert fields.problem.isVisible()
    qtbot.keyClick(fields.distance, Qt.Key.Key_Escape)
    assert not fields.problem.isVisible()
    np.testing.assert_allclose(there(window)[0].shift, [0.5, -0.25, 0])
    fields.reset.click()
    assert not there(window)[0].shift.any()
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    np.testing.assert_allclose(there(window)[0].shift, [0.5, -0.25, 0])


def test_nudge_moves_the_obstacle_in_the_hand_by_arrow_keys(qtbot, floored):
    window, view = floored, floored.canvas.viewport
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Down)
    qtbot.keyClick(view, Qt.Key.Key_Down)
    (floor,) = there(window)
    assert floor.shift[1] < 0.0
    assert floor.shift[0] == floor.shift[2] == 0.0
    assert steps(window)[-1] == "Nudge Floor"
    assert steps(window)[-2] == "Add floor"
    np.testing.assert_array_equal(document(window).handles[0].pose, np.eye(4))
    qtbot.keyClick(view, Qt.Key.Key_Left)  # aside a plate changes nothing
    assert there(window)[0].shift[0] == 0.0


def test_handle_section_is_gone_while_an_obstacle_is_in_the_hand(qtbot, held):
    window, section = held, held.panel.handles
    assert section.isVisible()
    window.actions_.simulate.obstacles.kinds[SPHERE].trigger()
    click(window, middle(window))
    assert window.parts.obstacle == 0
    assert window.obstacles.gizmo.visible
    assert not section.isVisible()
    assert window.panel.obstacles.fields.isVisible()
    qtbot.keyClick(window.shell, Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
    assert window.panel.obstacles.fields.distance.hasFocus()
    window.parts.choose_handle(0)
    assert section.isVisible()
    assert section.motion.isVisible()
    window.parts.choose_obstacle(0)
    assert not section.isVisible()
    window.tools.choose_tool(Tool.HANDLE)
    assert section.isVisible()
    window.tools.choose_tool(Tool.MOVE)
    assert not section.isVisible()
    window.actions_.undo.trigger()
    assert there(window) == ()
    assert section.isVisible()
    assert window.panel.handles.list.rows[0].property("resting") is False


def test_handle_section_warns_of_crossings_while_an_obstacle_is_in_the_hand(floored):
    section = floored.panel.handles
    assert not section.isVisible()
    section.set_resting(True)
    state = floored.session.store.state
    section.crossing_signs.setText("Crossing")
    section.set_resting(True)
    assert section.isVisible()
    assert not section.motion.isVisible()
    section.show_check(state, None)
    assert not section.isVisible()


def test_tool_hint_names_the_obstacle_while_one_is_in_the_hand(floored):
    window = floored
    assert window.status.hint.text().startswith("Move obstacle:")
    window.parts.choose_obstacle(None)
    assert window.status.hint.text().startswith("Move handle:")


def test_obstacle_section_says_that_obstacles_push_nothing_without_contact(qtbot, floored):
    window, section = floored, floored.panel.obstacles
    assert section.note.isHidden()
    window.panel.method.contact.click()
    assert not document(window).settings.contact
    assert "Contact is off" in section.note.text()
    assert not section.note.isHidden()
    assert window.obstacles.scene.drawn_obstacles[0].is_idle
    section.contact.click()
    assert document(window).settings.contact
    assert section.note.isHidden()
    assert not window.obstacles.scene.drawn_obstacles[0].is_idle
    window.session.settings.change(method="paper")
    assert "Paper" in section.note.text()
    assert section.contact.isHidden()
    assert window.obstacles.scene.drawn_obstacles[0].is_idle
    window.actions_.simulate.obstacles.floor.trigger()
    assert len(there(window)) == 1
    assert "contact" in window.notice.text
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert section.note.isHidden()


def test_obstacle_controller_shows_none_with_another_mesh(qtbot, floored):
    window = floored
    window.obstacles.begin_placing(SPHERE)
    window.files.show_mesh(Mesh(*sphere(2)))
    idle(qtbot, window)
    assert window.obstacles.scene.drawn_obstacles == ()
    assert window.parts.obstacle is None
    assert window.obstacles.placer.kind is None
    assert names(window) == []
    assert not window.obstacles.gizmo.visible


def test_obstacle_section_takes_and_renames_an_obstacle_by_its_row_and_the_brush_rests(qtbot, floored):
    window, section = floored, floored.panel.obstacles
    window.actions_.simulate.obstacles.side_plates[2].trigger()
    qtbot.keyClick(window.shell, Qt.Key.Key_H)
    assert window.canvas.tool is Tool.HANDLE
    assert not window.obstacles.gizmo.visible
    QTest.mouseClick(section.list.rows[0], Qt.MouseButton.LeftButton)
    assert window.canvas.tool is Tool.MOVE
    assert window.parts.obstacle == 0
    assert window.obstacles.gizmo.visible
    section.list.rows[0].renamed.emit("Table")
    assert there(window)[0].name == "Table"
    qtbot.keyClick(window.shell, Qt.Key.Key_N)  # the next handle
    assert window.parts.obstacle is None


def test_obstacle_scene_outlines_where_an_obstacle_should_be_that_contact_stops(floored):
    window, section = floored, floored.panel.obstacles
    shown = window.obstacles.scene.drawn_obstacles
    assert shown[0].requested_shift is None
    window.session.obstacles.move(0, np.array([0.0, 2.0, 0.0]))
    store = window.session.store
    far, load = np.array([[0.0, 0.5, 0.0]]), np.array([[0.0, -1.2345, 0.0]])
    frame = replace(store.state.frame, shifts=far, loads=load, settled=True)
    store.set_state(replace(store.state, frame=frame))
    (shown,) = window.obstacles.scene.drawn_obstacles
    np.testing.assert_array_equal(shown.shift, far[0])
    np.testing.assert_array_equal(shown.requested_shift, [0, 2, 0])
    row = section.list.rows[0]
    assert row.reading.text() == "load 1.23 at stiffness 1"
    assert section.excess.isVisible()
    assert "loads mean little" in section.excess.text()
    window.session.settings.change(stiffness=0.01)
    store.set_state(replace(store.state, frame=frame))
    assert section.excess.text().startswith("Expected excess of loads ")
    assert row.details.text() == "asked for 2.000, stopped 1.500 short"
    place = there(window)[0].place + far[0]
    assert section.fields.place.text() == ", ".join(f"{x:.5g}" for x in place)
    # The gizmo stays where it was put, and what is typed is measured from where the obstacle is.
    assert window.obstacles.gizmo.frame.centre[1] == pytest.approx(there(window)[0].centre[1])
    frame = replace(frame, shifts=np.array([[0.0, 2.0, 0.0]]), loads=np.zeros((1, 3)))
    store.set_state(replace(store.state, frame=frame))
    assert window.obstacles.scene.drawn_obstacles[0].requested_shift is None
    assert row.reading.text() == ""
    assert not section.excess.isVisible()
    assert row.details.text() == "moved 2.000"
    for _ in range(2):  # or the solver would go on to where the bottle is crushed
        window.actions_.undo.trigger()


def test_next_step_hint_knows_that_obstacles_suffice(qtbot, kept_window):
    kept_window.files.show_mesh(Mesh(*sphere(2)))
    idle(qtbot, kept_window)
    for tool, word in ((Tool.HANDLE, "handle"), (Tool.REGION, "area"), (Tool.BASE, "base")):
        kept_window.tools.choose_tool(tool)
        others = {"handle", "area", "base"} - {word}
        assert word in (said := kept_window.invitation.text())
        assert not any(other in said for other in others), "it speaks of the tool in hand"
    kept_window.actions_.simulate.obstacles.floor.trigger()
    assert "turn the view" in kept_window.invitation.text(), "from above its arrow cannot be dragged"
    kept_window.parts.choose_obstacle(None)
    assert kept_window.invitation.text() == "Click an obstacle to move it"
    kept_window.tools.choose_tool(Tool.BASE)
    assert "base" in kept_window.invitation.text()


def test_obstacle_controller_dents_the_bottle_with_a_pushed_sphere_that_feels_a_load(qtbot, held):
    window, section = held, held.panel.obstacles
    window.actions_.simulate.obstacles.kinds[SPHERE].trigger()
    click(window, middle(window))
    sphere = there(window)[0]
    rest = window.session.store.state.frame.U
    fields = section.fields
    type_into(qtbot, fields.distance, "0.03L")
    idle(qtbot, window)
    state = window.session.store.state
    U, shift = state.frame.U, state.frame.shifts[0]
    assert shift @ sphere.axis > 0.0
    gap = np.linalg.norm(U - sphere.place - shift, axis=1).min() - sphere.radius
    assert gap > 0.0
    assert (
        np.linalg.norm(rest - sphere.place - shift, axis=1).min() < sphere.radius
    )  # the rest shape would cut it
    assert section.list.rows[0].reading.text().startswith("load ")
    window.actions_.undo.trigger()
    assert window.session.store.state.frame.U is rest
    assert section.list.rows[0].reading.text() == ""


def test_put_plates_presses_a_mesh_that_nothing_holds(qtbot, held):
    window = held
    window.files.show_mesh(Mesh(*sphere(2)))
    idle(qtbot, window)
    window.tools.choose_tool(Tool.MOVE)
    window.actions_.simulate.obstacles.side_plates[0].trigger()
    assert document(window).paint_problem is None
    before = np.ptp(window.session.store.state.frame.U[:, 0])
    tip, way = arrow(window)
    drag(window, tip, 25 * way)
    idle(qtbot, window)
    state = window.session.store.state
    assert np.ptp(state.frame.U[:, 0]) < before
    for obstacle, shift in zip(there(window), state.obstacle_shifts, strict=True):
        assert ((state.frame.U - obstacle.place - shift) @ obstacle.axis).min() > 0.0
    one, two = state.frame.loads[:, 0]
    assert one == pytest.approx(-two, rel=0.05)


def test_save_session_keeps_obstacles_and_opening_brings_them_back(qtbot, floored, tmp_path):
    window = floored
    window.session.obstacles.rename(0, "Table")
    window.session.obstacles.move(0, np.array([0.0, -0.5, 0.0]))
    idle(qtbot, window)
    saved = there(window)[0]
    path = tmp_path / "a.apd"
    save_session(path, window.session.store.state, View())
    window.files.show_mesh(Mesh(*sphere(2)))
    qtbot.waitUntil(lambda: not there(window), timeout=30_000)
    window.session.files.open(path)
    qtbot.waitUntil(lambda: bool(there(window)), timeout=30_000)
    (table,) = there(window)
    assert (table.name, table.kind) == ("Table", PLATE)
    np.testing.assert_array_equal(table.place, saved.place)
    np.testing.assert_array_equal(table.shift, saved.shift)
    assert names(window) == ["Table"]
    assert len(window.obstacles.scene.drawn_obstacles) == 1
