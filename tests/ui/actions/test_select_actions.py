"""The actions around choosing vertices: keys, buttons, and changes of a part as a whole."""

from collections import Counter

import numpy as np
import pytest
from choosing import Gesture, Sight
from driving import Mouse, idle, work_off
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QToolBar

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
GROW, SHRINK, SMOOTH, INVERT = range(4)


@pytest.fixture
def keyboard(qtbot, scene):
    """Presses keys in the window."""
    scene.window.shell.activateWindow()
    qtbot.waitUntil(scene.window.shell.isActiveWindow)
    scene.view.setFocus()
    return lambda key, modifiers=Qt.KeyboardModifier.NoModifier: qtbot.keyClick(scene.view, key, modifiers)


def changes(scene):
    select = scene.window.actions_.select
    return [*select.changes, *select.mirrors]


def leaves(menu):
    for action in menu.actions():
        if action.menu():
            yield from leaves(action.menu())
        elif not action.isSeparator():
            yield action


def in_menus(window):
    return [action for top in window.shell.menuBar().actions() for action in leaves(top.menu())]


# What every action is


def test_actions_in_the_menus_are_all_dressed(scene):
    found = in_menus(scene.window)
    assert len(found) > 50
    for action in found:
        assert action.text().strip("&"), action
        assert action.toolTip(), action.text()
        assert action.statusTip(), action.text()
        assert not action.icon().isNull(), action.text()
        assert not action.icon().pixmap(20, 20).isNull(), action.text()


def test_actions_of_a_tool_bar_are_all_in_a_menu(scene):
    found = in_menus(scene.window)
    bars = scene.window.shell.findChildren(QToolBar)
    assert {"tools", "ways"} <= {bar.objectName() for bar in bars}
    for bar in bars:
        for action in bar.actions():
            assert action.isSeparator() or action in found, action.text()


def test_actions_share_no_shortcut(scene):
    scene.paint(np.ones(len(scene.document.labels), dtype=bool), BASE)
    found = {*in_menus(scene.window), *scene.window.shell.actions()}
    for tool in Tool:
        scene.take(tool, SelectionMode.BRUSH)
        keys = Counter(key.toString() for action in found if action.isEnabled() for key in action.shortcuts())
        assert [key for key, count in keys.items() if count > 1] == []
    assert all(action.shortcut().toString() for action in scene.window.actions_.select.modes.values())


# Ways


@pytest.mark.parametrize("tool", [Tool.ORBIT, Tool.MOVE, Tool.BASE, Tool.REGION])
def test_select_actions_take_a_way_and_a_tool_that_paints_by_a_key(scene, keyboard, tool):
    for way in reversed(SelectionMode):
        scene.take(tool, SelectionMode.BRUSH)
        keyboard(getattr(Qt.Key, f"Key_{way.traits.key}"))
        assert scene.canvas.selection_mode is way
        assert scene.canvas.tool is (tool if tool.traits.is_brush else Tool.HANDLE)
        ways = scene.window.actions_.select.modes
        assert [other for other in SelectionMode if ways[other].isChecked()] == [way]
        assert scene.window.actions_.tools[scene.canvas.tool].isChecked()
        assert [other for other in SelectionMode if scene.canvas.selectors[other].enabled] == [way]
        assert way.traits.hint in scene.window.status.hint.text()


def test_selection_mode_bar_is_there_for_the_tools_that_paint_and_its_buttons_work(qtbot, scene):
    bar = scene.window.mode_bar
    for tool in Tool:
        scene.take(tool, SelectionMode.BRUSH)
        assert bar.isVisible() == tool.traits.is_brush
    scene.take(Tool.BASE, SelectionMode.BRUSH)
    for way, action in scene.window.actions_.select.modes.items():
        qtbot.mouseClick(bar.widgetForAction(action), Qt.MouseButton.LeftButton)
        assert (scene.canvas.selection_mode, scene.canvas.tool) == (way, Tool.BASE)
        assert bar.widgetForAction(action).isChecked()


def test_selection_mode_bar_has_room_for_all_of_it_in_the_smallest_window(qtbot, scene):
    scene.take(Tool.BASE, SelectionMode.BRUSH)
    size = scene.window.shell.size()
    scene.window.shell.resize(scene.window.shell.minimumSize())
    work_off()
    bar = scene.window.mode_bar
    assert scene.view.rect().contains(bar.geometry())
    for action in bar.actions():
        assert bar.rect().contains(bar.widgetForAction(action).geometry()), action.text()
    scene.window.shell.resize(size)
    work_off()


def test_select_actions_switch_through_and_size_the_brush_by_keys(scene, keyboard):
    through = scene.window.actions_.select.select_hidden
    for on in (True, False):
        keyboard(Qt.Key.Key_T)
        assert through.isChecked() is on
        assert scene.canvas.selectors[SelectionMode.BOX].selects_hidden_vertices is on
        assert scene.canvas.selectors[SelectionMode.LASSO].selects_hidden_vertices is on
        assert scene.canvas.selectors[SelectionMode.POLYGON].selects_hidden_vertices is on
    radius = scene.canvas.brush.size.radius
    keyboard(Qt.Key.Key_BracketRight)
    assert scene.canvas.brush.size.radius > radius
    keyboard(Qt.Key.Key_BracketLeft)
    assert scene.canvas.brush.size.radius == pytest.approx(radius)


# Changes of a part


def part_of(scene, tool):
    """The codes that a tool paints into, its own code, and that of nothing."""
    document = scene.document
    if tool is Tool.REGION:
        return document.member, 1, 0
    return document.labels, BASE if tool is Tool.BASE else HANDLE, FREE


def expected(scene, tool, change):
    """Oracle: the part after a change, from sets."""
    codes, code, nothing = part_of(scene, tool)
    sight = Sight(scene.window)
    of_place = dict(zip(sight.place.tolist(), codes.tolist(), strict=True))
    member = {v for v, c in of_place.items() if c == code}
    free = {v for v, c in of_place.items() if c == nothing}
    if change == GROW:
        wanted = member | {w for v in member for w in sight.ring[v] if w in free}
    elif change == SHRINK:
        wanted = {v for v in member if sight.ring[v] <= member}
    else:
        assert change == INVERT
        wanted = free
    return sight.vertices(wanted)


@pytest.mark.parametrize("tool", [Tool.HANDLE, Tool.BASE, Tool.REGION, Tool.MOVE])
@pytest.mark.parametrize("change", [GROW, SHRINK, INVERT])
@pytest.mark.parametrize("name", ["rabbit", "seams", "pieces", pytest.param("bent", marks=pytest.mark.night)])
def test_edit_part_makes_a_part_what_sets_say_in_one_step_of_undo(qtbot, theatre, name, change, tool):
    scene = theatre.scene(qtbot, name)
    scene.take(tool, SelectionMode.BRUSH)
    before, steps, action = scene.document, scene.steps, changes(scene)[change]
    wanted = expected(scene, tool, change)
    codes, code, nothing = part_of(scene, tool)
    action.trigger()
    after = np.where(codes == code, nothing, codes)
    after[wanted] = code
    assert (after != codes).any()
    np.testing.assert_array_equal(part_of(scene, tool)[0], after)
    other = "labels" if tool is Tool.REGION else "member"
    assert getattr(scene.document, other) is getattr(before, other)
    scene.assert_nothing_is_previewed()
    assert scene.window.session.store.state.frame.U is scene.state.frame.U
    assert scene.steps == steps + 1
    assert scene.window.actions_.undo.text() == f"&Undo “{action.text().replace('&', '')}”"
    scene.window.actions_.undo.trigger()
    assert scene.document is before
    scene.assert_nothing_is_previewed()


def test_select_actions_change_a_part_by_keys(scene, keyboard):
    keys = (
        (Qt.Key.Key_Plus, CONTROL),
        (Qt.Key.Key_Minus, CONTROL),
        (Qt.Key.Key_B, CONTROL),
        (Qt.Key.Key_I, CONTROL | SHIFT),
    )
    for key, action in zip(keys, changes(scene), strict=False):
        keyboard(*key)
        assert scene.window.session.gestures.history.next_undo_name == action.text().replace("&", "")
        scene.window.actions_.undo.trigger()
        assert scene.document is scene.state.document


@pytest.mark.parametrize("tool", [Tool.HANDLE, Tool.REGION, Tool.BASE])
def test_edit_part_makes_no_step_where_it_changes_nothing(qtbot, theatre, tool):
    scene = theatre.scene(qtbot, "bare")
    scene.take(tool, SelectionMode.BRUSH)
    everything = len(scene.document.labels)
    for number, action in enumerate(changes(scene)):
        if number != INVERT:
            action.trigger()  # of nothing there is nothing to grow
    assert scene.document is scene.state.document
    changes(scene)[INVERT].trigger()
    codes, code, _ = part_of(scene, tool)
    assert (codes == code).sum() == everything
    full, steps = scene.document, scene.steps
    assert len(full.regions) == (tool is Tool.REGION)
    for number, action in enumerate(changes(scene)):
        if number != INVERT:
            action.trigger()  # and everything has no border
    assert scene.document is full
    assert scene.steps == steps
    scene.window.actions_.undo.trigger()
    assert scene.document is scene.state.document


def test_edit_part_in_the_middle_of_a_stroke_ends_the_stroke_and_does_no_more(qtbot, theatre):
    scene = theatre.scene(qtbot, "bare")
    scene.take(Tool.BASE, SelectionMode.BRUSH)
    at, mouse = Gesture(scene.window, SelectionMode.BRUSH).press, Mouse(scene.view)
    mouse.press(at)
    mouse.move(at + (30, 0))
    assert scene.document is not scene.state.document
    changes(scene)[INVERT].trigger()
    mouse.release(at + (30, 0))
    assert scene.document is scene.state.document


def test_select_actions_choose_nothing_and_break_nothing_without_a_mesh(qtbot, window):
    for way, action in window.actions_.select.modes.items():
        action.trigger()
        assert window.canvas.selection_mode is way
        mouse = Mouse(window.canvas.viewport)
        mouse.drag((300, 200), (350, 250), (400, 260))
        mouse.double_click((400, 260))
        mouse.wheel((400, 260), 1)
        preview = getattr(window.canvas.selectors[way], "preview_timer", None)
        qtbot.waitUntil(lambda preview=preview: preview is None or not preview.isActive())
    for action in [*window.actions_.select.changes, *window.actions_.select.mirrors]:
        action.trigger()
    idle(qtbot, window)
    assert window.session.store.state is None


def test_select_actions_clear_only_what_there_is_and_give_the_reason(bottle):
    base, handle, region, everything = bottle.actions_.select.clears
    assert [action.isEnabled() for action in (base, handle, region, everything)] == [True, True, False, True]
    assert region.toolTip() == "There is no region"
    base.trigger()
    assert (base.isEnabled(), base.toolTip()) == (False, "There is no base")
    everything.trigger()
    assert not any(action.isEnabled() for action in (base, handle, region, everything))
    assert everything.toolTip() == "Nothing is painted"
    bottle.session.gestures.undo()
    assert handle.isEnabled()
    assert handle.statusTip() == "Clear the active handle"
    assert "Clear the active handle" in handle.toolTip()
