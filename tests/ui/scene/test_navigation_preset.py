"""The mouse of other programs: which drag orbits, pans or zooms, in a real window."""

import numpy as np
import pytest
from driving import Mouse, document, settle
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox

from apd_viewer.ui.scene.navigation_preset import DEFAULT_PRESET, NAVIGATION_PRESETS
from apd_viewer.ui.settings_page.preference_table import NAVIGATION
from apd_viewer.ui.tools.tool_modes import Tool

LEFT, MIDDLE, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton
ALONE, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier
CTRL, ALT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.AltModifier
BESIDE = (40, 400)

# As the manuals of these programs have it; Fusion zooms by the wheel alone.
MANUALS = [
    ("own", RIGHT, ALONE, "orbit"),
    ("own", MIDDLE, ALONE, "pan"),
    ("own", RIGHT, CTRL, "zoom"),
    ("blender", MIDDLE, ALONE, "orbit"),
    ("blender", MIDDLE, SHIFT, "pan"),
    ("blender", MIDDLE, CTRL, "zoom"),
    ("rhino", RIGHT, ALONE, "orbit"),
    ("rhino", RIGHT, SHIFT, "pan"),
    ("rhino", RIGHT, CTRL, "zoom"),
    ("fusion", MIDDLE, ALONE, "pan"),
    ("fusion", MIDDLE, SHIFT, "orbit"),
    ("maya", LEFT, ALT, "orbit"),
    ("maya", MIDDLE, ALT, "pan"),
    ("maya", RIGHT, ALT, "zoom"),
    ("meshlab", LEFT, ALONE, "orbit"),
    ("meshlab", MIDDLE, ALONE, "pan"),
    ("meshlab", LEFT, CTRL, "pan"),
    ("meshlab", LEFT, SHIFT, "zoom"),
]


def moved(view, **drag):
    """What a drag beside the mesh has done to the camera."""
    before = view.camera_controller.camera
    Mouse(view).drag(BESIDE, (70, 420), (90, 440), **drag)
    after = view.camera_controller.camera
    if np.abs(after.axes - before.axes).max() > 1e-6:
        return "orbit"
    return "zoom" if abs(after.distance - before.distance) > 1e-6 else "pan"


@pytest.mark.parametrize(("name", "button", "keys", "motion"), MANUALS)
def test_navigation_preset_moves_the_camera_as_the_program_does(view, surface, name, button, keys, motion):
    view.navigation.preset = NAVIGATION_PRESETS[name]
    assert moved(view, button=button, modifiers=keys) == motion


@pytest.mark.parametrize("name", NAVIGATION_PRESETS)
def test_navigation_preset_has_a_plain_left_drag_beside_the_mesh_orbit(view, surface, name):
    view.navigation.preset = NAVIGATION_PRESETS[name]
    assert moved(view, button=LEFT) == "orbit"


@pytest.mark.parametrize("name", NAVIGATION_PRESETS)
def test_navigation_preset_leaves_the_left_button_to_the_brush(qtbot, bottle, name):
    view = bottle.canvas.viewport
    view.navigation.preset = NAVIGATION_PRESETS[name]
    bottle.tools.choose_tool(Tool.REGION)
    settle(qtbot, view)
    stand, at = view.camera_controller.camera.position.copy(), (view.width() / 2, view.height() / 2)
    Mouse(view).drag(at, at)
    painted = int((document(bottle).member == 1).sum())
    assert painted > 0
    Mouse(view).drag(at, (at[0] + 40, at[1]), modifiers=ALT)
    erased = int((document(bottle).member == 1).sum()) < painted
    turned = not np.array_equal(view.camera_controller.camera.position, stand)
    assert (erased, turned) == ((False, True) if name == "maya" else (True, False))
    view.navigation.preset = DEFAULT_PRESET


def test_navigation_preset_is_chosen_in_the_settings_and_holds_at_once(qtbot, bottle, settings):
    view = bottle.canvas.viewport
    bottle.actions_.settings.trigger()
    control = bottle.settings_page.dialog.findChild(QComboBox, NAVIGATION.name)
    control.setFocus()
    qtbot.keyClick(control, Qt.Key.Key_Down)
    assert control.currentText() == "Blender"
    assert settings.value("navigation") == "blender"
    assert moved(view, button=MIDDLE) == "orbit"
    bottle.tools.choose_tool(Tool.ORBIT)
    assert NAVIGATION_PRESETS["blender"].sentence in bottle.status.hint.text()
    bottle.settings_page.close()
