"""Several handles and named regions, by mouse and keyboard, in a real window."""

import numpy as np
import pytest
from driving import Mouse, arrow_grip, document, drag, on_screen, stroke, work_off
from kept_window import widened
from PySide6.QtCore import Qt

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.presentation.palette import HANDLE_COLORS, REGION_COLORS, label_colors
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.ui.tools.tool_modes import Tool


def front(window, height):
    """A vertex in front of the bottle, free, at a height."""
    V = document(window).mesh.V
    found = np.flatnonzero((V[:, 2] > 0.5) & (abs(V[:, 0]) < 0.3))
    return found[np.argmin(abs(V[found, 1] - height))]


def region_at(qtbot, window, height, half_width=20):
    """Paint the active region by mouse."""
    window.actions_.tools[Tool.REGION].trigger()
    stroke(qtbot, window, on_screen(window, front(window, height)), half_width)


@pytest.fixture
def two(qtbot, bottle):
    """A bottle with a second handle, painted by mouse half way up."""
    bottle.actions_.pose.part_actions[0].trigger()
    assert bottle.canvas.tool is Tool.HANDLE
    stroke(qtbot, bottle, on_screen(bottle, front(bottle, 8.0)), half_width=10)
    bottle.tools.choose_tool(Tool.MOVE)
    work_off()
    return bottle


@pytest.mark.parametrize("kind", ["handles", "regions"])
def test_active_parts_stay_when_the_removal_of_a_locked_part_is_refused(bottle, kind):
    parts, session = bottle.parts, bottle.session
    for _ in range(2):
        getattr(parts, {"handles": "add_handle", "regions": "add_region"}[kind])()
    before = parts.handle, parts.region
    assert max(before) > 0
    session.parts.lock(PaintedPart(HANDLE) if kind == "handles" else PaintedPart(1, is_region=True), True)
    getattr(bottle.panel, kind).list.removed.emit(0)
    assert (parts.handle, parts.region) == before
    assert "is locked" in bottle.notice.text


# Regions


def test_region_section_gets_a_region_by_the_first_stroke_and_alt_erases_it(qtbot, bottle):
    assert bottle.panel.regions.isHidden()
    region_at(qtbot, bottle, 8.0)
    assert [region.name for region in document(bottle).regions] == ["Region 1"]
    painted = int((document(bottle).member == 1).sum())
    assert painted > 20
    assert bottle.panel.regions.isVisible()
    assert bottle.panel.regions.list.rows[0].reading.text() == "100.00 %"
    mouse, at = Mouse(bottle.canvas.viewport), on_screen(bottle, front(bottle, 8.0))
    mouse.move(at, Qt.KeyboardModifier.AltModifier)
    mouse.drag(at, at, modifiers=Qt.KeyboardModifier.AltModifier)
    assert 0 < (document(bottle).member == 1).sum() < painted
    bottle.actions_.undo.trigger()
    bottle.actions_.undo.trigger()
    assert document(bottle).regions == ()
    assert bottle.session.gestures.history.next_undo_name is None


def test_region_section_lets_two_regions_be_painted_each_in_turn(qtbot, bottle):
    region_at(qtbot, bottle, 8.0)
    bottle.actions_.pose.part_actions[2].trigger()
    assert bottle.parts.region == 1
    region_at(qtbot, bottle, 12.0)
    assert {0, 1, 2} == set(document(bottle).member)
    Mouse(bottle.panel.regions.list.rows[0]).press((60, 8))
    assert bottle.parts.region == 0
    region_at(qtbot, bottle, 5.0)
    assert (document(bottle).member == 2).any()


def test_label_colors_show_a_region_on_the_mesh_and_hide_no_paint(qtbot, bottle):
    labels = np.array([BASE, FREE, HANDLE, HANDLE + 1], dtype=np.uint8)
    plain, covered = label_colors(labels), label_colors(labels, np.ones(4, dtype=np.uint8))
    region = np.array([*REGION_COLORS[0], 255])
    away = np.abs(covered.astype(int) - region).sum(axis=1)
    kept = np.abs(covered.astype(int) - plain.astype(int)).sum(axis=1)
    assert (kept > 40).all(), "the region shows"
    assert away[1] < kept[1], "free vertices have the region's colour"
    assert (kept[[0, 2, 3]] < away[[0, 2, 3]]).all(), "paint stays what it is"
    region_at(qtbot, bottle, 8.0)
    mesh_colors = np.asarray(bottle.canvas.surface.arrays.rgba)
    assert np.array_equal(mesh_colors, label_colors(document(bottle).labels, document(bottle).member))


def test_selection_strokes_erase_paint_first_and_then_the_region(qtbot, bottle):
    region_at(qtbot, bottle, 8.0)
    bottle.tools.choose_tool(Tool.BASE)
    at = on_screen(bottle, front(bottle, 8.0))
    stroke(qtbot, bottle, at, half_width=5)
    middle = front(bottle, 8.0)
    assert document(bottle).labels[middle] == BASE
    assert document(bottle).member[middle] == 1
    bottle.tools.choose_tool(Tool.ERASE)
    stroke(qtbot, bottle, at, half_width=5)
    assert document(bottle).labels[middle] == FREE
    assert document(bottle).member[middle] == 1
    stroke(qtbot, bottle, at, half_width=5)
    assert document(bottle).member[middle] == 0


def test_region_target_field_holds_the_area_of_a_region(qtbot, bottle):
    region_at(qtbot, widened(qtbot, bottle), 8.0, half_width=25)
    details = bottle.panel.regions.list.rows[0].details
    details.box.click()
    assert document(bottle).regions[0].area == 100.0
    details.field.setValue(90.0)
    assert document(bottle).regions[0].area == 90.0
    reading = bottle.panel.regions.list.rows[0].reading
    qtbot.waitUntil(lambda: reading.text() == "90.00 %, kept")
    bottle.session.settings.change(method="paper")
    assert not details.box.isEnabled()
    assert not bottle.panel.regions.note.isHidden()
    bottle.session.settings.change(method="exact")
    details.box.click()
    assert document(bottle).regions[0].area is None


# Names


def test_named_row_lets_its_name_be_edited_in_place(qtbot, bottle):
    region_at(qtbot, bottle, 8.0)
    row = bottle.panel.regions.list.rows[0]
    Mouse(row).double_click((60, 8))
    qtbot.keyClicks(row.name, "Label")
    qtbot.keyClick(row.name, Qt.Key.Key_Return)
    assert document(bottle).regions[0].name == "Label"
    qtbot.keyClick(row, Qt.Key.Key_F2)
    qtbot.keyClicks(row.name, "nothing")
    qtbot.keyClick(row.name, Qt.Key.Key_Escape)
    assert document(bottle).regions[0].name == "Label"
    assert row.name.text() == "Label"
    assert bottle.session.gestures.history.next_undo_name == "Rename"
    bottle.actions_.undo.trigger()
    assert row.name.text() == "Region 1"


def test_named_row_whose_part_is_undone_while_it_is_renamed_enters_nothing(qtbot, bottle):
    bottle.parts.add_region()
    bottle.parts.add_region()
    row = bottle.panel.regions.list.rows[-1]
    row.name.begin_editing()
    qtbot.keyClicks(row.name, "Label")
    bottle.actions_.undo.trigger()
    work_off()
    assert [each.name for each in document(bottle).regions] == ["Region 1"]
    assert bottle.panel.regions.list.rows[0].name.text() == "Region 1"


def test_named_row_takes_a_number_that_is_typed_for_its_own_part(qtbot, bottle):
    """Also if the row is removed before the number is entered, and its fields are those of the next."""
    for k in range(2):
        bottle.parts.add_region()
        bottle.session.settings.set_region_area(k, 100.0)
    row = bottle.panel.regions.list.rows[0]
    field = row.details.field
    field.setFocus()
    field.selectAll()
    qtbot.keyClicks(field, "90")
    qtbot.mouseClick(row.remove, Qt.MouseButton.LeftButton)
    work_off()
    (left,) = document(bottle).regions
    assert (left.name, left.area) == ("Region 2", 100.0)
    row.setFocus()
    work_off()
    assert document(bottle).regions[0].area == 100.0


def test_named_row_leaves_the_focus_to_what_is_clicked(qtbot, bottle):
    region_at(qtbot, bottle, 8.0)
    row, field = bottle.panel.regions.list.rows[0], bottle.panel.area.target.field
    row.name.begin_editing()
    qtbot.keyClicks(row.name, "Label")
    field.setFocus(Qt.FocusReason.MouseFocusReason)
    assert field.hasFocus()
    assert document(bottle).regions[0].name == "Label"


# Handles


def test_gizmo_gives_each_of_two_handles_its_pose(qtbot, two):
    held = [document(two).labels == HANDLE + k for k in range(2)]
    assert held[1].sum() > 20
    assert two.parts.handle == 1
    drag(qtbot, two, arrow_grip(two, 0), (40, 0))
    first, second = (handle.pose for handle in document(two).handles)
    assert np.array_equal(first, np.eye(4))
    assert second[0, 3] > 0
    grip = document(two).initial_positions

    def there():
        U = two.session.store.state.frame.U
        return np.allclose(U[held[1]], grip[held[1]] + second[:3, 3])

    qtbot.waitUntil(there)
    assert np.allclose(two.session.store.state.frame.U[held[0]], grip[held[0]])


def test_pivots_make_the_other_handle_active_by_a_press_on_its_dot(qtbot, two):
    view = two.canvas.viewport
    dots = two.canvas.inactive_handles.pivots
    assert [pivot.name for pivot in dots] == ["Handle 1"]
    at = view.camera_controller.camera.project(dots[0].centre[None])[0]
    mouse = Mouse(view)
    empty = view.tool_layer.grab().toImage()
    mouse.move(at)
    assert view.cursor().shape() == Qt.CursorShape.PointingHandCursor
    assert view.tool_layer.grab().toImage() != empty, "the name is shown"
    mouse.drag(at, at)
    assert two.parts.handle == 0
    assert np.allclose(two.canvas.gizmo.frame.centre, dots[0].centre)
    assert two.panel.handles.list.rows[0].property("active")
    drag(qtbot, two, arrow_grip(two, 1), (0, -20))
    assert document(two).handles[0].pose[1, 3] > 0
    assert np.array_equal(document(two).handles[1].pose, np.eye(4))


def test_pivots_take_a_handle_by_a_press_on_its_paint_and_move_it_by_a_drag(qtbot, two):
    view, mouse = two.canvas.viewport, Mouse(two.canvas.viewport)
    labels, U = document(two).labels, two.session.store.state.frame.U
    cap = np.flatnonzero((labels == HANDLE) & (U[:, 2] > 0.5))
    points = view.camera_controller.camera.project(U[cap])
    dot = view.camera_controller.camera.project(two.canvas.inactive_handles.pivots[0].centre[None])[0]
    away = points[np.argmax(np.linalg.norm(points - dot, axis=1) * (np.abs(points[:, 0] - dot[0]) < 12))]
    before, steps = view.camera_controller.camera.key, two.session.gestures.history.undo_names
    mouse.drag(away, away, modifiers=Qt.KeyboardModifier.ShiftModifier)
    assert two.parts.handle == 1, "Shift pans"
    mouse.drag(away, away)
    assert two.parts.handle == 0
    assert two.session.gestures.history.undo_names == steps, "a click moves nothing"
    two.parts.choose_handle(1)
    mouse.drag(away, away + (10, 0), away + (30, 0))
    assert two.parts.handle == 0
    assert view.camera_controller.camera.key == before
    pose = document(two).handles[0].pose
    assert np.array_equal(pose[:3, :3], np.eye(3)), "moved, and not rotated by a ring that lies there"
    shift = (
        30
        * view.camera_controller.camera.world_per_pixel(U[cap].mean(axis=0))
        * view.camera_controller.camera.axes[0]
    )
    assert np.allclose(pose[:3, 3], shift, rtol=0.05, atol=0.05 * np.linalg.norm(shift))
    two.parts.choose_handle(1)
    dot = view.camera_controller.camera.project(two.canvas.inactive_handles.pivots[0].centre[None])[0]
    mouse.press(dot)
    mouse.move(dot + (30, 0))
    assert view.mouse.cancel()
    mouse.release(dot + (30, 0))
    assert np.array_equal(document(two).handles[0].pose, pose), "Esc puts it back"


def test_handle_section_adds_steps_through_and_removes_handles(qtbot, two):
    row = two.panel.handles.list.rows[1]
    two.actions_.pose.part_actions[1].trigger()
    assert two.parts.handle == 0
    two.panel.handles.list.rows[0].setFocus()
    qtbot.keyClick(two.panel.handles.list.rows[0], Qt.Key.Key_Down)
    assert two.parts.handle == 1
    row.remove.click()
    assert len(document(two).handles) == 1
    assert (document(two).labels <= HANDLE).all()
    assert two.parts.handle == 0
    assert two.panel.handles.list.rows[0].remove.isHidden()
    two.actions_.undo.trigger()
    assert len(document(two).handles) == 2
    assert len(two.panel.handles.list.rows) == 2


def test_add_handle_asks_for_the_new_handle_to_be_painted(bottle):
    bottle.actions_.pose.part_actions[0].trigger()
    assert "Handle 2" in bottle.invitation.text()
    assert bottle.canvas.brush.color.getRgb()[:3] == HANDLE_COLORS[1]
    assert not bottle.canvas.gizmo.visible


def test_gizmo_takes_the_drag_of_the_second_handle_back_on_escape(qtbot, two):
    before = document(two)
    mouse, at = Mouse(two.canvas.viewport), arrow_grip(two, 0)
    mouse.move(at)
    mouse.press(at)
    mouse.move(at + (30, 0))
    assert document(two) is not before
    qtbot.keyClick(two.canvas.viewport, Qt.Key.Key_Escape)
    mouse.release(at + (30, 0))
    assert document(two) is before
