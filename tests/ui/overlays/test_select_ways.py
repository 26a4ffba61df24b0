"""Every way to choose vertices, with every tool and modifier, against a look at every vertex and triangle."""

import numpy as np
import pytest
from choosing import ALT, COLORS, CONTROL, MESHES, NONE, Gesture, painted

from apd_viewer.presentation.palette import FREE_COLOR, tinted_colors
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool

STROKES = [
    (Tool.HANDLE, NONE),
    (Tool.HANDLE, ALT),
    (Tool.HANDLE, CONTROL),
    (Tool.REGION, NONE),
    (Tool.REGION, ALT),
    (Tool.REGION, CONTROL),
    (Tool.BASE, CONTROL),
    (Tool.ERASE, NONE),
]

SOME_STROKES = {"rabbit": slice(None), "seams": slice(6), "bare": slice(3, 6)}
OUTLINES = SelectionMode.BOX, SelectionMode.LASSO, SelectionMode.POLYGON, SelectionMode.SLAB
LONG = {
    *(("bent", mode) for mode in SelectionMode if mode is not SelectionMode.BRUSH),
    ("cup", SelectionMode.LASSO),
    ("cup", SelectionMode.POLYGON),
    *((name, mode) for name in ("seams", "pieces", "bare") for mode in OUTLINES[1:]),
}


@pytest.mark.parametrize(
    ("name", "way"),
    [
        pytest.param(name, way, marks=pytest.mark.night if (name, way) in LONG else ())
        for name in MESHES
        for way in SelectionMode
    ],
)
def test_selection_tool_paints_what_it_previews_as_one_step_of_undo(qtbot, theatre, name, way):
    scene = theatre.scene(qtbot, name)
    before, gesture = scene.document, None
    for tool, modifiers in STROKES[SOME_STROKES.get(name, slice(3))]:
        scene.take(tool, way)
        gesture = gesture or Gesture(scene.window, way)
        assert gesture.chosen.any() or (name, way) == ("cup", SelectionMode.LOOP)
        assert way is SelectionMode.PIECE or not gesture.chosen.all()
        steps, said = scene.steps, f"{tool.traits.title} with {modifiers}"
        mouse = gesture.begin(scene.view, modifiers)
        if way is not SelectionMode.BRUSH:
            np.testing.assert_array_equal(scene.previewed, gesture.chosen, said)
            colors, chosen = scene.own_colors, gesture.chosen
            colors[chosen] = tinted_colors(colors[chosen], FREE_COLOR if modifiers == ALT else COLORS[tool])
            np.testing.assert_array_equal(scene.colors, colors, said)
            assert scene.document is before
        gesture.end(mouse, modifiers)
        scene.leave()
        labels, member = painted(before, gesture.chosen, tool, modifiers)
        if not gesture.chosen.any():  # there is no border
            labels, member = before.labels, before.member
        np.testing.assert_array_equal(scene.document.labels, labels, said)
        np.testing.assert_array_equal(scene.document.member, member, said)
        scene.assert_nothing_is_previewed()
        changed = (labels != before.labels).any() or (member != before.member).any()
        assert scene.steps == steps + changed
        assert scene.window.session.store.state.frame.U is scene.state.frame.U
        assert scene.view.camera_controller.camera.key == scene.eye.key
        if changed:
            scene.window.actions_.undo.trigger()
        assert scene.document is before
        assert scene.steps == steps
        scene.assert_nothing_is_previewed()
