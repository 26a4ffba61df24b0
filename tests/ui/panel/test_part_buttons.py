"""The buttons of parts in the panel, their keys, and strokes over locked and hidden parts."""

import numpy as np
import pytest
from driving import LEFT, document, idle, on_screen, stroke
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QLabel, QToolButton

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.palette import FREE_COLOR, HANDLE_COLORS
from apd_viewer.ui.tools.tool_modes import Tool


@pytest.fixture
def row(bottle):
    """The buttons of the first handle."""
    return bottle.panel.handles.list.rows[0].buttons


def colors(window, label):
    return np.array(window.canvas.surface.arrays.rgba)[document(window).labels == label, :3]


def test_part_buttons_hide_the_color_of_a_handle_that_holds_all_the_same(qtbot, bottle, row):
    before = document(bottle)
    assert (colors(bottle, HANDLE) == HANDLE_COLORS[0]).all()
    qtbot.mouseClick(row.hide_part, LEFT)
    assert (colors(bottle, HANDLE) == FREE_COLOR).all()
    assert document(bottle).labels is before.labels
    assert row.hide_part.toolTip() == "Show the colour of this part"
    qtbot.mouseClick(row.hide_part, LEFT)
    assert (colors(bottle, HANDLE) == HANDLE_COLORS[0]).all()
    bottle.actions_.undo.trigger()
    assert (colors(bottle, HANDLE) == FREE_COLOR).all()


def test_selection_strokes_go_round_a_locked_part_and_so_does_their_preview(qtbot, bottle, row):
    qtbot.mouseClick(row.lock_part, LEFT)
    held = document(bottle).labels == HANDLE
    edge = int(np.flatnonzero(held)[np.argmin(document(bottle).mesh.V[held, 1])])
    bottle.tools.choose_tool(Tool.BASE)
    everything = np.arange(len(held))
    bottle.canvas.preview_selection(everything)
    assert not held[bottle.canvas.coloring.previewed_ids].any()
    bottle.canvas.preview_selection(None)
    stroke(qtbot, bottle, on_screen(bottle, edge))
    np.testing.assert_array_equal(document(bottle).labels == HANDLE, held)


def test_selection_strokes_with_a_locked_part_change_nothing_and_say_why(qtbot, bottle, row):
    qtbot.mouseClick(row.lock_part, LEFT)
    before = document(bottle)
    bottle.tools.choose_tool(Tool.HANDLE)
    free = int(np.argmin(abs(before.mesh.V[:, 1])))
    stroke(qtbot, bottle, on_screen(bottle, free))
    assert document(bottle) is before
    assert bottle.notice.text == "Handle 1 is locked; unlock it in the panel first."


def test_part_buttons_clear_the_base_in_one_step(qtbot, bottle):
    before, base = bottle.session.store.state, bottle.panel.parts.base
    first = bottle.panel.handles.list.rows[0]
    assert base.mapTo(bottle.shell, base.rect().bottomLeft()).y() <= first.mapTo(bottle.shell, QPoint()).y()
    qtbot.mouseClick(base.clear_part, LEFT)
    assert not (document(bottle).labels == BASE).any()
    assert not base.clear_part.isEnabled()
    bottle.actions_.undo.trigger()
    assert bottle.session.store.state is before
    qtbot.mouseClick(base.lock_part, LEFT)
    assert not base.clear_part.isEnabled()


def test_clear_all_leaves_what_is_locked(qtbot, bottle, row):
    qtbot.mouseClick(row.lock_part, LEFT)
    qtbot.mouseClick(bottle.panel.paint.clear_all, LEFT)
    assert not (document(bottle).labels == BASE).any()
    assert (document(bottle).labels == HANDLE).any()


def test_part_commands_lock_and_hide_the_part_of_the_tool_by_keys(qtbot, bottle):
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.canvas.viewport.setFocus()
    bottle.tools.choose_tool(Tool.BASE)
    qtbot.keyClick(bottle.canvas.viewport, Qt.Key.Key_K)
    assert document(bottle).base.locked
    qtbot.keyClick(bottle.canvas.viewport, Qt.Key.Key_H, Qt.KeyboardModifier.ControlModifier)
    assert document(bottle).base.hidden
    qtbot.keyClick(bottle.canvas.viewport, Qt.Key.Key_K)
    assert not document(bottle).base.locked


def test_part_commands_clear_the_active_parts_from_the_menu(qtbot, bottle):
    base, handle, _, all_of_it = bottle.actions_.select.clears
    handle.trigger()
    assert not (document(bottle).labels == HANDLE).any()
    base.trigger()
    assert not (document(bottle).labels == BASE).any()
    steps = len(bottle.session.gestures.history.undo_states)
    all_of_it.trigger()
    assert len(bottle.session.gestures.history.undo_states) == steps, "nothing is left to clear"
    idle(qtbot, bottle)


@pytest.mark.parametrize("handles", [1, 2])
def test_parts_section_aligns_names_and_readings_of_all_rows(qtbot, bottle, handles):
    panel = bottle.panel
    bottle.obstacles.add_floor()
    add_handle, _, add_region = bottle.actions_.pose.part_actions
    add_region.trigger()
    for _ in range(1, handles):
        add_handle.trigger()
    idle(qtbot, bottle)
    rows = [row for each in (panel.handles, panel.regions, panel.obstacles) for row in each.list.rows]
    assert len(rows) == handles + 2
    labels = [row.reading for row in rows]
    labels += [each for each in panel.parts.findChildren(QLabel) if each.toolTip() == "Vertices of the base"]
    assert len(labels) == len(rows) + 1

    def ends():
        return {label.mapTo(panel, label.rect().topRight()).x() for label in labels}

    qtbot.waitUntil(lambda: len(ends()) == 1)
    assert all(row.remove.mapTo(panel, QPoint(0, 0)).x() > max(ends()) for row in rows)


def test_buttons_with_a_menu_keep_nothing_of_the_press_once_it_is_closed(qtbot, bottle):
    buttons = [button for button in bottle.shell.findChildren(QToolButton) if button.menu() is not None]
    ours = [button for button in buttons if not button.objectName().startswith("qt_")]
    assert {bottle.panel.parts.add, bottle.panel.area.unit, bottle.plots.save} <= set(ours)
    corner = bottle.shell.mapToGlobal(QPoint(5, 5))
    for button in ours:
        assert button.focusPolicy() is Qt.FocusPolicy.TabFocus
        button.setAttribute(Qt.WidgetAttribute.WA_UnderMouse)  # as Qt leaves it when a menu takes the mouse
        button.menu().popup(corner)
        qtbot.waitUntil(button.menu().isVisible)
        button.menu().close()
        qtbot.waitUntil(lambda button=button: not button.underMouse())
        assert not button.isDown()
