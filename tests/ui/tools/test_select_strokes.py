"""How strokes end, are given up and are previewed, in every way to choose vertices."""

import meshes
import numpy as np
import pytest
from choosing import ALT, CONTROL, NONE, OUTLINES, TOUCHES, Gesture, Sight
from driving import LEFT, Mouse, centre, idle
from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import QApplication

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool

SHIFT = Qt.KeyboardModifier.ShiftModifier
MIDDLE, RIGHT = Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton
ESCAPE, RETURN, ENTER = Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Enter


@pytest.fixture
def cup(qtbot, theatre):
    return theatre.scene(qtbot, "cup")


@pytest.fixture
def bare(qtbot, theatre):
    return theatre.scene(qtbot, "bare")


def begun(scene, way, modifiers=NONE):
    """A stroke that has begun, with all of its preview; the button is down, but for a polygon."""
    scene.take(Tool.HANDLE, way)
    gesture = Gesture(scene.window, way)
    mouse = gesture.begin(scene.view, modifiers)
    if way in TOUCHES:
        mouse.press(gesture.press, modifiers=modifiers)
    if way is not SelectionMode.BRUSH:
        np.testing.assert_array_equal(scene.previewed, gesture.chosen)
        assert (scene.colors != scene.own_colors).any()
    return gesture, mouse


def let_go(gesture, mouse):
    if gesture.way is not SelectionMode.POLYGON:
        mouse.release(gesture.moves[-1])


def off_the_mesh(scene):
    """A position where nothing is seen."""
    low = Sight(scene.window).screen.min(axis=0)
    assert (low > 20).all()
    return low / 2


def held(scene, label=HANDLE):
    return scene.document.labels == label


# Giving up


@pytest.mark.parametrize("modifiers", [NONE, CONTROL])
@pytest.mark.parametrize("way", SelectionMode)
def test_selection_tool_changes_nothing_by_escape_in_the_middle_of_a_stroke(qtbot, scene, way, modifiers):
    steps = scene.steps
    gesture, mouse = begun(scene, way, modifiers)
    qtbot.keyClick(scene.view, ESCAPE)
    scene.assert_nothing_is_previewed()
    let_go(gesture, mouse)
    scene.leave()
    scene.assert_nothing_is_previewed()
    assert scene.document is scene.state.document
    assert scene.steps == steps
    assert scene.canvas.tool is Tool.HANDLE, "it was the stroke that was given up"
    qtbot.keyClick(scene.view, ESCAPE)
    assert scene.canvas.tool is Tool.ORBIT


INTERRUPTIONS = {
    "another tool": lambda actions: actions.tools[Tool.BASE],
    "no tool": lambda actions: actions.tools[Tool.ORBIT],
    "another way": lambda actions: actions.select.modes[SelectionMode.BRUSH],
    "undo": lambda actions: actions.undo,
    "grow": lambda actions: actions.select.changes[0],
}


@pytest.mark.parametrize("action", INTERRUPTIONS)
@pytest.mark.parametrize(
    "way", [SelectionMode.BOX, SelectionMode.POLYGON, SelectionMode.FILL, SelectionMode.SLAB]
)
def test_selection_tool_gives_the_stroke_up_for_what_comes_between(scene, way, action):
    steps = scene.steps
    gesture, mouse = begun(scene, way)
    INTERRUPTIONS[action](scene.window.actions_).trigger()
    scene.assert_nothing_is_previewed()
    let_go(gesture, mouse)
    scene.leave()
    scene.assert_nothing_is_previewed()
    assert scene.document is scene.state.document
    assert scene.steps == steps


@pytest.mark.parametrize("subdivisions", [1, 4])
@pytest.mark.parametrize("way", SelectionMode)
def test_selection_tool_gives_the_stroke_up_for_another_mesh_of_any_size(qtbot, scene, way, subdivisions):
    gesture, mouse = begun(scene, way)
    scene.window.session.files.open_mesh(Mesh(*meshes.sphere(subdivisions)))
    idle(qtbot, scene.window)
    assert (scene.document.labels == FREE).all()
    assert scene.document.mesh is not scene.state.document.mesh
    scene.assert_nothing_is_previewed()
    let_go(gesture, mouse)
    mouse.wheel(gesture.press, -1)
    scene.leave()
    scene.assert_nothing_is_previewed()
    assert (scene.document.labels == FREE).all()


def test_selection_tool_goes_on_with_a_stroke_while_the_cursor_is_outside(scene):
    for way in (SelectionMode.BOX, SelectionMode.LASSO, SelectionMode.SLAB, SelectionMode.POLYGON):
        gesture, mouse = begun(scene, way)
        scene.leave()
        np.testing.assert_array_equal(scene.previewed, gesture.chosen)
        gesture.end(mouse)
        np.testing.assert_array_equal(held(scene), held(scene) | gesture.chosen)
        scene.reset(scene.qtbot)


# Clicks, and strokes that choose nothing


@pytest.mark.parametrize("modifiers", [NONE, ALT, CONTROL])
@pytest.mark.parametrize("way", [SelectionMode.BOX, SelectionMode.LASSO, SelectionMode.SLAB])
def test_selection_tool_changes_nothing_by_a_click_without_a_drag(scene, way, modifiers):
    scene.take(Tool.HANDLE, way)
    mouse, at, steps = Mouse(scene.view), Gesture(scene.window, SelectionMode.FILL).press, scene.steps
    mouse.drag(at, at, modifiers=modifiers)
    mouse.drag(at, at + (1, 1), modifiers=modifiers)  # a hand that trembles
    mouse.double_click(at)
    scene.leave()
    scene.assert_nothing_is_previewed()
    assert scene.document is scene.state.document
    assert scene.steps == steps


@pytest.mark.parametrize("tool", [Tool.BASE, Tool.HANDLE, Tool.REGION, Tool.ERASE])
def test_outline_tool_changes_nothing_by_a_box_around_nothing(bare, tool):
    bare.take(tool, SelectionMode.BOX)
    steps = bare.steps
    for modifiers in (NONE, ALT, CONTROL):
        Mouse(bare.view).drag((2, 2), (9, 9), modifiers=modifiers)
    assert bare.document is bare.state.document, "not even a region without a vertex"
    assert bare.steps == steps


def test_outline_tool_takes_away_what_is_replaced_by_nothing(scene):
    scene.take(Tool.HANDLE, SelectionMode.BOX)
    before = scene.document.labels
    Mouse(scene.view).drag((2, 2), (9, 9), modifiers=CONTROL)
    np.testing.assert_array_equal(scene.document.labels, np.where(before == HANDLE, FREE, before))
    scene.window.actions_.undo.trigger()
    assert scene.document is scene.state.document


@pytest.mark.parametrize("tool", [Tool.HANDLE, Tool.REGION])
@pytest.mark.parametrize(
    "way", [SelectionMode.BRUSH, SelectionMode.BOX, SelectionMode.POLYGON, SelectionMode.FILL]
)
def test_selection_tool_makes_no_step_of_what_is_replaced_by_itself(scene, way, tool):
    scene.take(tool, way)
    gesture = Gesture(scene.window, way)
    gesture.end(gesture.begin(scene.view, CONTROL))
    steps, document = scene.steps, scene.document
    assert document is not scene.state.document
    gesture.end(gesture.begin(scene.view, CONTROL))
    assert scene.document is document
    assert scene.steps == steps


@pytest.mark.parametrize("way", [SelectionMode.BRUSH, *TOUCHES, SelectionMode.SLAB])
def test_selection_tool_lets_a_press_beside_the_mesh_move_the_camera(scene, way):
    scene.take(Tool.HANDLE, way)
    at, mouse = off_the_mesh(scene), Mouse(scene.view)
    mouse.move(at)
    assert scene.canvas.coloring.previewed_ids is None
    mouse.drag(at, at + (15, 25))
    assert scene.view.camera_controller.camera.key != scene.eye.key
    assert scene.document is scene.state.document


@pytest.mark.parametrize("way", TOUCHES)
def test_click_selector_changes_nothing_by_a_click_that_ends_beside_the_mesh(scene, way):
    _, mouse = begun(scene, way)
    mouse.move(off_the_mesh(scene))
    scene.assert_nothing_is_previewed()
    mouse.release(off_the_mesh(scene))
    assert scene.document is scene.state.document


def test_click_selector_previews_nothing_for_tools_that_paint_nothing(scene):
    at = Gesture(scene.window, SelectionMode.FILL).press
    for way in TOUCHES:
        for tool in (Tool.ORBIT, Tool.MOVE):
            scene.take(tool, way)
            Mouse(scene.view).move(at)
            scene.assert_nothing_is_previewed()


# Polygons


@pytest.mark.parametrize("end", ["double click", "first corner", "near the first corner", RETURN, ENTER])
def test_outline_tool_ends_a_polygon_by_double_click_first_corner_or_return(qtbot, scene, end):
    gesture, mouse = begun(scene, SelectionMode.POLYGON)
    if end == "double click":
        gesture.end(mouse)
    elif isinstance(end, str):
        at = gesture.press + ((5, -6) if "near" in end else (0, 0))
        mouse.move(at)
        np.testing.assert_array_equal(scene.previewed, gesture.chosen, "the click that ends it is no corner")
        mouse.drag(at, at)
    else:
        qtbot.keyClick(scene.view, end)
    scene.assert_nothing_is_previewed()
    before = scene.state.document.labels
    np.testing.assert_array_equal(scene.document.labels, np.where(gesture.chosen, HANDLE, before))
    assert scene.window.session.gestures.history.next_undo_name == Tool.HANDLE.traits.title


@pytest.mark.parametrize("modifiers", [NONE, CONTROL])
@pytest.mark.parametrize("corners", [1, 2])
def test_outline_tool_encloses_nothing_by_a_polygon_of_less_than_three_corners(
    qtbot, scene, corners, modifiers
):
    scene.take(Tool.HANDLE, SelectionMode.POLYGON)
    mouse, at = Mouse(scene.view), np.array(Gesture(scene.window, SelectionMode.FILL).press)
    for end in ("Return", "first corner"):
        for k in range(corners):
            mouse.drag(at + 40 * k, at + 40 * k, modifiers=modifiers)
        if end == "Return":
            qtbot.keyClick(scene.view, RETURN)
        else:
            mouse.drag(at, at)
        scene.assert_nothing_is_previewed()
        assert not scene.view.mouse.cancel(), "nothing is left of it"
    assert scene.document is scene.state.document


def test_outline_tool_lets_the_camera_move_between_clicks_of_a_polygon(qtbot, scene):
    scene.take(Tool.HANDLE, SelectionMode.POLYGON)
    mouse, middle = Mouse(scene.view), centre(scene.view)
    at = np.array([middle.x(), middle.y()])
    corners = at + [(-150, -90), (120, -130), (10, 140)]
    mouse.drag(corners[0], corners[0])
    mouse.drag(at, at + (40, 30), button=MIDDLE)
    mouse.drag(corners[1], corners[1])
    mouse.drag(at, at + (60, 10), button=RIGHT)
    mouse.move(corners[2])
    mouse.wheel(corners[2], 1)
    scene.draw()
    sight = Sight(scene.window)
    chosen = sight.vertices(sight.within(corners))
    assert chosen.any()
    np.testing.assert_array_equal(scene.previewed, chosen, "the preview follows the camera")
    qtbot.keyClick(scene.view, RETURN)
    np.testing.assert_array_equal(held(scene), (scene.state.document.labels == HANDLE) | chosen)


# The surface in the way


@pytest.mark.parametrize(
    "name", ["rabbit", "cup", "seams", "pieces", pytest.param("bent", marks=pytest.mark.night)]
)
@pytest.mark.parametrize("way", OUTLINES)
def test_outline_tool_through_takes_what_is_hidden_too(qtbot, theatre, name, way):
    scene = theatre.scene(qtbot, name)
    gesture, mouse = begun(scene, way)
    through = Gesture(scene.window, way, through=True)
    assert (through.chosen > gesture.chosen).any()
    assert (through.chosen >= gesture.chosen).all()
    scene.window.actions_.select.select_hidden.trigger()
    scene.draw()
    np.testing.assert_array_equal(scene.previewed, through.chosen, "though the mouse has not moved")
    gesture.end(mouse)
    np.testing.assert_array_equal(held(scene), (scene.state.document.labels == HANDLE) | through.chosen)


def outside_of_cup(scene):
    V = scene.document.mesh.V
    return (np.hypot(V[:, 0], V[:, 2]) > 0.97) | (V[:, 1] < 0.01)


def looking_into_the_cup(scene):
    """A position where the inner side of the far wall is seen, well below the rim."""
    scene.view.camera_controller.camera = scene.view.camera_controller.camera.orbited(0, 80)
    V, sight = scene.document.mesh.V, Sight(scene.window)
    deep = ~outside_of_cup(scene) & (V[:, 2] < -0.5) & (np.abs(V[:, 1] - 0.7) < 0.2)
    return np.mean(
        scene.view.camera_controller.camera.project(V[deep & sight.vertices(np.flatnonzero(sight.seen))]),
        axis=0,
    )


def test_brush_tool_inside_a_cup_leaves_its_outside_alone(cup):
    cup.canvas.brush.size.radius = 50.0
    cup.take(Tool.BASE, SelectionMode.BRUSH)
    at = looking_into_the_cup(cup)
    sight = Sight(cup.window)
    here = sight.hit(at)[1]
    near = np.linalg.norm(sight.U - here, axis=1) < 50 * cup.view.camera_controller.camera.world_per_pixel(
        here
    )
    assert (outside_of_cup(cup) & sight.vertices(np.flatnonzero(near))).any(), "the wall is that thin"
    Mouse(cup.view).drag(*(at + (dx, 0) for dx in range(-120, 121, 10)), modifiers=CONTROL)
    assert held(cup, BASE).sum() > 15
    assert not (held(cup, BASE) & outside_of_cup(cup)).any()


def test_click_selector_ends_a_fill_inside_a_cup_at_its_rim(cup):
    cup.take(Tool.BASE, SelectionMode.FILL)
    at = looking_into_the_cup(cup)
    Mouse(cup.view).drag(at, at, modifiers=CONTROL)
    y = cup.document.mesh.V[:, 1]
    np.testing.assert_array_equal(held(cup, BASE), ~outside_of_cup(cup) & (y > 0.04) & (on_the_wall(cup)))


def on_the_wall(scene):
    V = scene.document.mesh.V
    return np.hypot(V[:, 0], V[:, 2]) > 0.9


@pytest.mark.parametrize("way", OUTLINES)
def test_outline_tool_from_above_does_not_see_the_outside_of_a_cup(qtbot, cup, way):
    cup.view.camera_controller.show_standard_view("top")
    cup.take(Tool.BASE, way)
    low, high = np.array([3, 3]), np.array([cup.view.width(), cup.view.height()]) - 3
    corners = [low, (high[0], low[1]), high, (low[0], high[1])]
    mouse = Mouse(cup.view)
    if way is SelectionMode.BOX:
        mouse.drag(low, (0.5 * (low + high)), high, modifiers=CONTROL)
    elif way is SelectionMode.LASSO:
        mouse.drag(*corners, modifiers=CONTROL)
    else:
        for corner in corners:
            mouse.drag(corner, corner, modifiers=CONTROL)
        qtbot.keyClick(cup.view, RETURN)
    rim = cup.document.mesh.V[:, 1] > 1.49
    np.testing.assert_array_equal(held(cup, BASE), ~outside_of_cup(cup) | rim)


# The wheel, and the camera


def test_click_selector_crease_and_preview_of_a_fill_are_changed_by_the_wheel(scene):
    scene.take(Tool.HANDLE, SelectionMode.FILL)
    gesture, mouse = Gesture(scene.window, SelectionMode.FILL), Mouse(scene.view)
    fill, heard = scene.canvas.selectors[SelectionMode.FILL], []
    fill.crease_angle_changed.connect(heard.append)
    mouse.move(gesture.press)
    for notches in (-1, -1, 3, 1):
        before, crease = scene.previewed, fill.crease_angle
        mouse.wheel(gesture.press, notches)
        assert fill.crease_angle == pytest.approx(crease + 5 * notches)
        np.testing.assert_array_equal(scene.previewed, Gesture(scene.window, SelectionMode.FILL).chosen)
        assert (scene.previewed >= before if notches > 0 else scene.previewed <= before).all()
    mouse.wheel(gesture.press, 100)
    assert fill.crease_angle == 180
    np.testing.assert_array_equal(scene.previewed, Gesture(scene.window, SelectionMode.PIECE).chosen)
    mouse.wheel(gesture.press, -100)
    assert fill.crease_angle == 1
    assert heard == [7.5, 2.5, 17.5, 22.5, 180, 1]
    assert scene.window.status.currentMessage() == "Edge angle 1°"
    assert scene.view.camera_controller.camera.key == scene.eye.key
    mouse.wheel(gesture.press, 1, ALT)
    assert fill.crease_angle == 6


def test_slab_tool_turns_its_planes_by_the_wheel_but_not_in_the_middle_of_a_drag(scene):
    scene.take(Tool.HANDLE, SelectionMode.SLAB)
    slab, heard = scene.canvas.selectors[SelectionMode.SLAB], []
    slab.axis_changed.connect(heard.append)
    at, mouse = Gesture(scene.window, SelectionMode.SLAB).press, Mouse(scene.view)
    for notches in (-1, -1, -1, 1, 1):
        mouse.wheel(at, notches)
    assert heard == [2, 0, 1, 0, 2]
    gesture = Gesture(scene.window, SelectionMode.SLAB)
    mouse = gesture.begin(scene.view)
    mouse.wheel(gesture.moves[-1], 1)
    assert slab.axis == 2
    np.testing.assert_array_equal(scene.previewed, gesture.chosen)
    gesture.end(mouse)
    np.testing.assert_array_equal(held(scene), (scene.state.document.labels == HANDLE) | gesture.chosen)
    assert scene.view.camera_controller.camera.key == scene.eye.key


@pytest.mark.parametrize("way", SelectionMode)
def test_selection_tool_lets_the_wheel_zoom_with_control_and_without_where_it_sets_nothing(scene, way):
    scene.take(Tool.HANDLE, way)
    mouse, at = Mouse(scene.view), Gesture(scene.window, way).press
    crease, axis = (
        scene.canvas.selectors[SelectionMode.FILL].crease_angle,
        scene.canvas.selectors[SelectionMode.SLAB].axis,
    )
    mouse.move(at)
    mouse.wheel(at, 1, CONTROL)
    zoomed = scene.view.camera_controller.camera.distance
    assert zoomed < scene.eye.distance
    assert (crease, axis) == (
        scene.canvas.selectors[SelectionMode.FILL].crease_angle,
        scene.canvas.selectors[SelectionMode.SLAB].axis,
    )
    mouse.wheel(at, 1)
    assert (scene.view.camera_controller.camera.distance < zoomed) == (
        way not in (SelectionMode.BRUSH, SelectionMode.FILL, SelectionMode.SLAB)
    )


@pytest.mark.parametrize("way", SelectionMode)
def test_selection_tool_lets_other_drags_move_the_camera_while_a_tool_is_in_hand(scene, way):
    scene.take(Tool.HANDLE, way)
    at, mouse = Gesture(scene.window, way).press, Mouse(scene.view)
    for button, modifiers in ((MIDDLE, NONE), (RIGHT, NONE), (LEFT, SHIFT)):
        before = scene.view.camera_controller.camera.key
        mouse.drag(at, at + (20, 9), at + (40, 10), button=button, modifiers=modifiers)
        assert scene.view.camera_controller.camera.key != before
    scene.leave()
    scene.assert_nothing_is_previewed()
    assert scene.document is scene.state.document


@pytest.mark.parametrize("way", TOUCHES)
def test_click_selector_preview_follows_the_camera_under_a_resting_cursor(qtbot, scene, way):
    scene.take(Tool.HANDLE, way)
    at = off_the_mesh(scene)
    Mouse(scene.view).move(at)
    scene.assert_nothing_is_previewed()
    scene.view.camera_controller.zoom_at(centre(scene.view), 6.0)
    scene.draw()
    sight = Sight(scene.window)
    face = sight.hit(at)[0]
    places = {
        SelectionMode.FILL: lambda: sight.fill(face, scene.canvas.selectors[SelectionMode.FILL].crease_angle),
        SelectionMode.PIECE: lambda: sight.rings(set(sight.F[face].tolist())),
        SelectionMode.LOOP: lambda: sight.loop(face),
    }[way]()
    np.testing.assert_array_equal(scene.previewed, sight.vertices(places))


# The preview and what else changes colours


def test_click_selector_preview_leaves_no_trace_after_undo(scene):
    gesture = Gesture(scene.window, SelectionMode.FILL)
    scene.take(Tool.BASE, SelectionMode.FILL)
    gesture.end(gesture.begin(scene.view))
    np.testing.assert_array_equal(scene.previewed, gesture.chosen, "the cursor is still there")
    scene.window.actions_.undo.trigger()
    assert scene.document is scene.state.document
    scene.leave()
    scene.assert_nothing_is_previewed()


def test_coloring_gives_marks_their_color_back_after_a_preview(scene):
    gesture = Gesture(scene.window, SelectionMode.FILL)
    marked = np.flatnonzero(gesture.chosen)[::2]
    scene.canvas.coloring.mark(marked)
    before = scene.colors
    scene.take(Tool.HANDLE, SelectionMode.FILL)
    Mouse(scene.view).move(gesture.press)
    assert (scene.colors != before).any()
    scene.leave()
    np.testing.assert_array_equal(scene.colors, before)
    scene.canvas.coloring.mark(None)
    scene.assert_nothing_is_previewed()


def test_selection_tool_draws_planes_and_outline_that_are_gone_after_the_stroke(scene):
    for way in (SelectionMode.BOX, SelectionMode.LASSO, SelectionMode.POLYGON, SelectionMode.SLAB):
        scene.take(Tool.HANDLE, way)
        scene.leave()
        empty = scene.view.tool_layer.grab().toImage()
        gesture = Gesture(scene.window, way)
        mouse = gesture.begin(scene.view)
        assert scene.view.tool_layer.grab().toImage() != empty
        scene.qtbot.keyClick(scene.view, ESCAPE)
        let_go(gesture, mouse)
        QApplication.sendEvent(scene.view, QEvent(QEvent.Type.Leave))
        assert scene.view.tool_layer.grab().toImage() == empty
