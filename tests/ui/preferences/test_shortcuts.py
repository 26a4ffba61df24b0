"""The sheet lists every action with its keys, and there the keys can be changed."""

import pytest
from driving import LEFT, document, work_off
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QLabel, QMenu, QScrollArea, QWidget

from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.workbench import Workbench

CTRL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


@pytest.fixture
def active(qtbot, window):
    """A window that has the keys."""
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    window.canvas.viewport.setFocus()
    return window


@pytest.fixture
def sheet(qtbot, active):
    """The sheet, opened with Shift+F1."""
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_F1, SHIFT)
    assert active.help.sheet.isVisible()
    return active.help.sheet


@pytest.fixture
def again(qapp, settings):
    """Makes a second window with the same settings, not shown."""
    made = []

    def make():
        window = Workbench(Shell(settings))
        made.append(window)
        return window

    yield make
    for window in made:
        window.shell.close()
        window.shell.deleteLater()
    work_off()


def press(qtbot, sheet, name, key, modifiers=Qt.KeyboardModifier.NoModifier):
    """Click the keys of an action and press others."""
    field = sheet.rows[name].keys
    sheet.findChild(QScrollArea).ensureWidgetVisible(field)
    qtbot.mouseClick(field, LEFT)
    assert field.is_recording
    qtbot.keyClick(field, key, modifiers)
    assert not field.is_recording


def shown(sheet):
    return [row.title for row in sheet.rows.values() if row.isVisible()]


def leaves(menu):
    for action in menu.actions():
        if isinstance(action.menu(), QMenu):
            yield from leaves(action.menu())
        elif not action.isSeparator():
            yield action


# The list


@pytest.mark.parametrize("key", [pytest.param("Shift+F1", marks=pytest.mark.night), "?", "menu"])
def test_shortcut_sheet_opens_and_closes(qtbot, active, key):
    sheet = active.help.sheet
    if key == "menu":
        active.actions_.help["shortcuts"].trigger()
    else:
        pressed = (Qt.Key.Key_F1, SHIFT) if key == "Shift+F1" else (Qt.Key.Key_Question,)
        qtbot.keyClick(active.canvas.viewport, *pressed)
    assert sheet.isVisible()
    assert active.shell.focusWidget() is sheet.search
    qtbot.keyClick(sheet.search, Qt.Key.Key_Escape)
    assert not sheet.isVisible()
    assert active.shell.focusWidget() is active.canvas.viewport
    assert active.canvas.tool is Tool.MOVE, "Esc closed the sheet and did no more"
    active.actions_.help["shortcuts"].trigger()
    active.canvas.viewport.setFocus()
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_Escape)
    assert not sheet.isVisible()
    active.actions_.help["shortcuts"].trigger()
    qtbot.mouseClick(sheet.head.close_button, LEFT)
    assert not sheet.isVisible()


def test_shortcut_sheet_has_every_action_of_the_menus(active, sheet):
    in_menus = [action for top in active.shell.menuBar().actions() for action in leaves(top.menu())]
    assert [row.entry.action for row in sheet.rows.values()] == in_menus
    names = [entry.name for entry in active.actions_.entries]
    assert len(names) == len(set(names)), "keys are remembered by the name"
    assert all(" " not in name for name in names)
    for row in sheet.rows.values():
        assert not row.symbol.pixmap().isNull()
        keys = row.entry.action.shortcut().toString(QKeySequence.SequenceFormat.NativeText) or "none"
        assert f"Keys of {row.entry.title}: {keys}" in row.keys.accessibleName()
    assert "Open sample: Rubber duck" in shown(sheet)


def test_shortcut_sheet_explains_the_mouse_in_the_words_of_the_tools(sheet):
    said = " ".join(label.text() for label in sheet.findChildren(QLabel)).casefold()
    for way in SelectionMode:
        assert way.traits.hint.casefold() in said
    for tool in (Tool.ORBIT, Tool.MOVE):
        assert tool.traits.hint.casefold() in said
    assert Tool.HANDLE.modifiers.casefold() in said


@pytest.mark.parametrize(
    ("word", "title"),
    [("pinch", ["On a touch screen", "On a trackpad"]), ("eraser", ["With a pen"]), ("pen", ["With a pen"])],
)
def test_shortcut_sheet_names_fingers_and_pens(qtbot, sheet, word, title):
    qtbot.keyClicks(sheet.search, word)
    gestures = [row for row in sheet.groups[-1].rows if row.isVisible()]
    assert [row.accessibleName().partition(":")[0] for row in gestures] == title


def test_shortcut_sheet_search_finds_titles_keys_menus_and_gestures(qtbot, sheet):
    everything = shown(sheet)
    qtbot.keyClicks(sheet.search, "PAINT h")
    assert shown(sheet)[0] == "Paint handle"
    assert set(shown(sheet)) < set(everything)
    sheet.search.clear()
    qtbot.keyClicks(sheet.search, "ctrl+e")
    assert shown(sheet) == ["Export"]
    sheet.search.clear()
    qtbot.keyClicks(sheet.search, "lasso")
    gestures = [row for row in sheet.groups[-1].rows if row.isVisible()]
    assert [row.accessibleName().partition(":")[0] for row in gestures] == ["Lasso"]
    qtbot.keyClicks(sheet.search, " nowhere")
    assert not shown(sheet)
    assert sheet.no_results.isVisible()
    assert "lasso nowhere" in sheet.no_results.text()
    sheet.search.clear()
    assert shown(sheet) == everything
    assert not sheet.no_results.isVisible()


def test_shortcut_sheet_takes_no_tool_for_a_letter_in_its_search_field(qtbot, active, sheet):
    qtbot.keyClicks(sheet.search, "b?")
    assert sheet.search.text() == "b?"
    assert active.canvas.tool is Tool.MOVE
    assert sheet.isVisible()


def test_shortcut_sheet_lets_the_window_be_used_while_it_is_open(qtbot, active, sheet):
    active.canvas.viewport.setFocus()
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_O)
    assert active.canvas.tool is Tool.ORBIT
    assert sheet.isVisible()


def test_shortcut_sheet_keeps_the_mouse_from_the_mesh(qtbot, bottle):
    before, eye = document(bottle), bottle.canvas.viewport.camera_controller.camera.key
    bottle.actions_.help["shortcuts"].trigger()
    label = bottle.help.sheet.findChildren(QLabel)[3]
    qtbot.mousePress(label, LEFT)
    qtbot.mouseMove(label)
    qtbot.mouseRelease(label, LEFT)
    assert bottle.help.sheet.isVisible()
    assert document(bottle) is before
    assert bottle.canvas.viewport.camera_controller.camera.key == eye


@pytest.mark.parametrize("size", [(800, 640), (1280, 800)])
def test_shortcut_sheet_lies_within_the_canvas_and_scrolls(qtbot, window, size):
    window.shell.resize(*size)
    work_off()
    window.actions_.help["shortcuts"].trigger()
    work_off()
    sheet = window.help.sheet
    assert window.canvas.viewport.rect().contains(sheet.geometry())
    room = sheet.findChild(QScrollArea)
    body = room.widget()
    assert body.height() > room.viewport().height()
    assert body.width() <= room.viewport().width()
    last = sheet.groups[-1].rows[-1]
    bar = room.verticalScrollBar()
    bar.setValue(bar.maximum())
    assert not last.visibleRegion().isEmpty()
    for row in sheet.rows.values():
        assert row.keys.width() >= row.keys.sizeHint().width()
    window.shell.resize(900, 700)
    work_off()
    assert window.canvas.viewport.rect().contains(sheet.geometry())


def test_shortcut_sheet_has_names_for_all_its_controls(sheet):
    for widget in sheet.findChildren(QWidget):
        if widget.focusPolicy() & Qt.FocusPolicy.TabFocus and widget.isVisible():
            assert widget.accessibleName() or getattr(widget, "text", str)(), widget


# Changing keys


def test_shortcuts_give_new_keys_that_work_at_once_and_after_a_new_start(qtbot, active, sheet, again):
    press(qtbot, sheet, "take:BASE", Qt.Key.Key_K, CTRL | SHIFT)
    action = active.actions_.tools[Tool.BASE]
    assert action.shortcut() == QKeySequence("Ctrl+Shift+K")
    assert "(Ctrl+Shift+K)" in action.toolTip()
    assert "(B)" not in action.toolTip()
    qtbot.keyClick(sheet, Qt.Key.Key_Escape)
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_B)
    assert active.canvas.tool is Tool.MOVE
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_K, CTRL | SHIFT)
    assert active.canvas.tool is Tool.BASE
    other = again()
    assert other.actions_.tools[Tool.BASE].shortcut() == QKeySequence("Ctrl+Shift+K")
    assert "(Ctrl+Shift+K)" in other.actions_.tools[Tool.BASE].toolTip()
    assert other.actions_.tools[Tool.HANDLE].shortcut() == QKeySequence("H")


def test_key_field_takes_a_sign_as_the_sign_and_shift_with_a_letter_as_shift(qtbot, sheet):
    press(qtbot, sheet, "frame", Qt.Key.Key_Exclam, SHIFT)
    press(qtbot, sheet, "edges", Qt.Key.Key_Q, SHIFT)
    assert sheet.rows["frame"].entry.keys in ("!", "Shift+!")  # a test's event may lack the text
    assert sheet.rows["edges"].entry.keys == "Shift+Q"


def test_key_field_takes_keys_away_by_delete(qtbot, sheet, again):
    press(qtbot, sheet, "edges", Qt.Key.Key_Delete)
    entry = sheet.rows["edges"].entry
    assert entry.keys == ""
    assert "(" not in entry.action.toolTip()
    assert again().actions_.view.edges.shortcut().isEmpty()


@pytest.mark.parametrize("way", ["esc", "elsewhere", "modifiers"])
def test_key_field_ends_waiting_for_keys_without_a_change(qtbot, active, sheet, way):
    field = sheet.rows["frame"].keys
    qtbot.mouseClick(field, LEFT)
    if way == "esc":
        qtbot.keyClick(field, Qt.Key.Key_Escape)
    elif way == "elsewhere":
        sheet.search.setFocus()
    else:
        qtbot.keyPress(field, Qt.Key.Key_Control)
        assert field.is_recording, "more is to come"
        qtbot.keyRelease(field, Qt.Key.Key_Control)
        qtbot.keyClick(field, Qt.Key.Key_Escape)
    assert not field.is_recording
    assert field.entry.keys == "F"
    assert sheet.isVisible()


def test_key_field_lets_the_keys_do_nothing_else_while_it_waits(qtbot, active, sheet):
    press(qtbot, sheet, "frame", Qt.Key.Key_F1)
    assert sheet.isVisible()
    assert "F1 is already used by “What is this?”." in sheet.status.text()


def test_shortcuts_refuse_a_conflict_and_name_the_other_action(qtbot, active, sheet):
    press(qtbot, sheet, "frame", Qt.Key.Key_B)
    assert sheet.status.text() == "B is already used by “Paint base”."
    assert sheet.swap.isVisible()
    assert active.shell.focusWidget() is sheet.swap
    qtbot.keyClick(sheet.swap, Qt.Key.Key_Escape)
    assert sheet.isVisible(), "Esc takes back the offer only"
    assert not sheet.swap.isVisible()
    assert active.actions_.view.frame.shortcut() == QKeySequence("F")
    assert active.actions_.tools[Tool.BASE].shortcut() == QKeySequence("B")
    assert active.shell.focusWidget() is sheet.rows["frame"].keys


def test_shortcuts_solve_a_conflict_by_a_swap(qtbot, active, sheet, again):
    press(qtbot, sheet, "frame", Qt.Key.Key_B)
    qtbot.mouseClick(sheet.swap, LEFT)
    assert active.actions_.view.frame.shortcut() == QKeySequence("B")
    assert active.actions_.tools[Tool.BASE].shortcut() == QKeySequence("F")
    assert "(F)" in active.actions_.tools[Tool.BASE].toolTip()
    qtbot.keyClick(sheet, Qt.Key.Key_Escape)
    qtbot.keyClick(active.canvas.viewport, Qt.Key.Key_F)
    assert active.canvas.tool is Tool.BASE
    other = again()
    assert other.actions_.view.frame.shortcut() == QKeySequence("B")
    assert other.actions_.tools[Tool.BASE].shortcut() == QKeySequence("F")


def test_shortcuts_let_one_of_several_keys_be_taken(qtbot, active, sheet):
    press(qtbot, sheet, "tour", Qt.Key.Key_F1, SHIFT)
    assert sheet.swap.text() == "Reassign"
    qtbot.mouseClick(sheet.swap, LEFT)
    assert sheet.rows["tour"].entry.keys == "Shift+F1"
    assert sheet.rows["shortcuts"].entry.keys == "?"


def test_shortcuts_refuse_keys_that_the_window_needs(qtbot, active, sheet):
    for key, modifiers, word in (
        (Qt.Key.Key_Return, Qt.KeyboardModifier.NoModifier, "Return"),
        (Qt.Key.Key_Space, Qt.KeyboardModifier.NoModifier, "Space"),
        (Qt.Key.Key_Down, Qt.KeyboardModifier.NoModifier, "Down"),
        (Qt.Key.Key_E, Qt.KeyboardModifier.AltModifier, "menu “Edit”"),
    ):
        press(qtbot, sheet, "frame", key, modifiers)
        assert word in sheet.status.text()
        assert not sheet.swap.isVisible()
        assert sheet.rows["frame"].entry.keys == "F"


def test_shortcut_sheet_goes_back_to_the_standard_for_one_and_for_all(qtbot, active, sheet, again):
    assert not sheet.restore_all.isEnabled()
    press(qtbot, sheet, "frame", Qt.Key.Key_6)
    press(qtbot, sheet, "export", Qt.Key.Key_J, CTRL)
    press(qtbot, sheet, "edges", Qt.Key.Key_Delete)
    rows = sheet.rows
    assert [row.back.isVisible() for row in (rows["frame"], rows["export"], rows["open"])] == [
        True,
        True,
        False,
    ]
    assert "Ctrl+E" in rows["export"].back.accessibleName()
    qtbot.mouseClick(rows["export"].back, LEFT)
    assert active.actions_.file.export.shortcut() == QKeySequence("Ctrl+E")
    assert not rows["export"].back.isVisible()
    assert again().actions_.view.frame.shortcut() == QKeySequence("6")
    qtbot.mouseClick(sheet.restore_all, LEFT)
    assert all(not entry.is_changed for entry in active.actions_.entries)
    assert not sheet.restore_all.isEnabled()
    other = again()
    assert all(not entry.is_changed for entry in other.actions_.entries)


def test_shortcuts_see_a_conflict_in_a_standard_that_another_action_has_by_now(qtbot, active, sheet):
    press(qtbot, sheet, "frame", Qt.Key.Key_6)
    press(qtbot, sheet, "edges", Qt.Key.Key_F)
    qtbot.mouseClick(sheet.rows["frame"].back, LEFT)
    assert "“Edges”" in sheet.status.text()
    assert sheet.rows["frame"].entry.keys == "6"
    qtbot.mouseClick(sheet.swap, LEFT)
    assert sheet.rows["frame"].entry.keys == "F"
    assert sheet.rows["edges"].entry.keys == "6"


def test_shortcut_sheet_is_used_by_keys_alone(qtbot, active, sheet):
    qtbot.keyClicks(sheet.search, "front")
    qtbot.keyClick(sheet.search, Qt.Key.Key_Down)
    field = active.shell.focusWidget()
    assert field is sheet.rows["look:front"].keys
    qtbot.keyClick(field, Qt.Key.Key_Return)
    qtbot.keyClick(field, Qt.Key.Key_6)
    assert sheet.rows["look:front"].entry.keys == "6"
    assert active.shell.focusWidget() is field
    qtbot.keyClick(field, Qt.Key.Key_Up)
    assert active.shell.focusWidget() is sheet.search
    sheet.search.clear()
    sheet.rows["open"].keys.setFocus()
    qtbot.keyClick(sheet.rows["open"].keys, Qt.Key.Key_Down)
    assert active.shell.focusWidget() is sheet.rows["open_sample:bottle"].keys
    qtbot.keyClick(active.shell.focusWidget(), Qt.Key.Key_Tab)
    assert active.shell.focusWidget() is not sheet.rows["open_sample:bottle"].keys


@pytest.mark.parametrize(
    "lines",
    [
        ["frame nonsense", "gone Ctrl+K", "edges"],
        ["frame B"],
        "frame K",
        ["take:BASE H", "take:HANDLE H"],
    ],
)
def test_shortcuts_make_no_key_work_twice_by_settings_that_others_have_written(settings, again, lines):
    settings.setValue("shortcuts", lines)
    window = again()
    keys = [key.toString() for entry in window.actions_.entries for key in entry.action.shortcuts()]
    assert len(keys) == len(set(keys))
    assert "" not in keys
    assert len(keys) > 30


@pytest.mark.night
def test_shortcut_sheet_follows_the_theme_while_open(qtbot, sheet, active):
    before = sheet.rows["open"].symbol.pixmap().toImage()
    active.actions_.view.schemes[Qt.ColorScheme.Dark].trigger()
    assert sheet.rows["open"].symbol.pixmap().toImage() != before
