"""What helps to see: the rest shape, before and after, sections, the grid and the turntable."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from driving import LEFT, Mouse, document, idle, settle, show, work_off
from grid_figures import figures
from meshes import sphere
from PySide6.QtCore import QPointF, Qt, QTimer

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

SHIFT = Qt.KeyboardModifier.ShiftModifier


@pytest.fixture(scope="module")
def kept(unused):
    """What other windows were used for has been made in them."""
    return unused


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def globe(qtbot, window):
    """A window on a sphere of radius one, seen from the front, that has the keys."""
    window.files.show_mesh(Mesh(*sphere(3)))
    idle(qtbot, window)
    window.canvas.viewport.camera_controller.show_standard_view("front")
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    window.canvas.viewport.setFocus()
    settle(qtbot, window.canvas.viewport)
    return window


def answer(qtbot, window, U):
    """Show a shape as a frame of the worker is shown."""
    stage = window.session.store
    stage.set_state(stage.state.updated(frame=dataclasses.replace(stage.state.frame, U=frozen(U))))
    settle(qtbot, window.canvas.viewport)


def switch(window, name):
    return window.actions_.display.switches[name]


def picture(window):
    return window.canvas.viewport.screenshot(return_img=True).astype(int)


# The rest shape


def test_ghost_is_seen_where_the_mesh_was_and_leaves_no_trace(qtbot, globe):
    view = globe.canvas.viewport
    answer(qtbot, globe, 0.5 * document(globe).mesh.V)
    plain = picture(globe)
    qtbot.keyClick(view, Qt.Key.Key_A)
    assert switch(globe, "ghost").isChecked()
    changed = np.abs(picture(globe) - plain).max(axis=2)
    centre_of = np.array([view.height(), view.width()]) / 2
    radius = np.linalg.norm(
        view.camera_controller.camera.project(np.array([[0.999, 0.0, 0.0]]))[0] - centre_of[::-1]
    )
    y, x = np.nonzero(changed > 12)
    away = np.hypot(y - centre_of[0], x - centre_of[1])
    assert len(away) > 1000
    assert away.max() < 1.05 * radius
    change = changed[y, x]
    ring = (away > 0.9 * radius) & (away < radius)
    assert change[ring].mean() > 2 * change[away < 0.45 * radius].mean(), "most of it is the outline"
    qtbot.keyClick(view, Qt.Key.Key_A)
    np.testing.assert_array_equal(picture(globe), plain)


def test_ghost_of_an_equal_shape_is_not_seen_through_the_mesh(qtbot, globe):
    plain, view = picture(globe), globe.canvas.viewport
    switch(globe, "ghost").trigger()
    settle(qtbot, view)
    changed = np.abs(picture(globe) - plain).max(axis=2)
    rows, columns = np.indices(changed.shape)
    away = np.hypot(rows - view.height() / 2, columns - view.width() / 2)
    edge = view.camera_controller.camera.project(np.array([[0.999, 0.0, 0.0]]))[0]
    radius = np.linalg.norm(edge - np.array([view.width(), view.height()]) / 2)
    assert changed[away < 0.95 * radius].max() == 0


def test_display_options_make_nothing_that_is_not_shown(qtbot, globe):
    switch(globe, "shadow").trigger()
    qtbot.waitUntil(lambda: not globe.canvas.viewport.is_stale)
    hidden = [actor for actor in globe.canvas.viewport.renderer.GetActors() if not actor.GetVisibility()]
    assert len(hidden) >= 3
    assert {actor.GetMapper().GetInput() for actor in hidden if not actor.GetTexture()} == {None}
    assert {find() for find in globe.canvas.viewport.more_boxes} == {()}


def test_ghost_is_not_cut_off_where_it_is_larger_than_the_mesh(qtbot, globe):
    answer(qtbot, globe, 0.1 * document(globe).mesh.V)
    switch(globe, "ghost").trigger()
    settle(qtbot, globe.canvas.viewport)
    eye = globe.canvas.viewport.camera_controller.camera
    near, far = globe.canvas.viewport.renderer.GetActiveCamera().GetClippingRange()
    assert near <= eye.distance - 1.0
    assert far >= eye.distance + 1.0


# Before and after


def test_blend_card_shows_the_way_from_rest_while_its_slider_is_held(qtbot, globe):
    V = document(globe).mesh.V
    answer(qtbot, globe, V * [2.0, 1.0, 1.0])
    qtbot.keyClick(globe.canvas.viewport, Qt.Key.Key_A, SHIFT)
    compare, surface = globe.display_options.before_after, globe.canvas.surface
    assert compare.isVisible()
    slider = compare.slider
    mouse, knob = Mouse(slider), slider.knob_position(slider.value())
    mouse.press((knob, slider.height() / 2))
    mouse.move((slider.width() / 2, slider.height() / 2))
    np.testing.assert_allclose(surface.U, V * [1.5, 1.0, 1.0], atol=0.01)
    mouse.move((-20, slider.height() / 2))
    np.testing.assert_allclose(surface.U, V, atol=1e-12)
    answer(qtbot, globe, V * [3.0, 1.0, 1.0])
    np.testing.assert_allclose(surface.U, V, atol=1e-12, err_msg="a frame comes while it is held")
    mouse.release((-20, slider.height() / 2))
    np.testing.assert_allclose(surface.U, V * [3.0, 1.0, 1.0])
    assert document(globe).mesh.V is V, "nothing was done"
    assert not globe.session.gestures.history.next_undo_name


def test_deviation_overlay_says_what_is_so_and_not_what_lies_on_the_way(qtbot, globe):
    globe.actions_.display.measures[Measure.STRAIN].trigger()
    heat = globe.display_options.overlay
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    answer(qtbot, globe, 1.5 * document(globe).mesh.V)
    globe.canvas.surface.blend(document(globe).mesh.V, 0.0)
    settle(qtbot, globe.canvas.viewport)
    np.testing.assert_allclose(heat.reading.values, np.log(1.5))


def test_blend_card_is_ended_by_keys_and_by_another_mesh(qtbot, globe):
    switch(globe, "compare").trigger()
    slider = globe.display_options.before_after.slider
    slider.setFocus()
    qtbot.keyClick(slider, Qt.Key.Key_PageDown)
    assert slider.value() < slider.maximum()
    globe.canvas.viewport.setFocus()
    assert slider.value() == slider.maximum()
    slider.setValue(0)
    globe.files.show_mesh(Mesh(*sphere(2)))
    idle(qtbot, globe)
    assert len(globe.canvas.surface.U) == len(document(globe).mesh.V)
    assert slider.value() == slider.maximum()
    qtbot.mouseClick(globe.display_options.before_after.close_button, LEFT)
    assert not switch(globe, "compare").isChecked()
    assert not globe.display_options.before_after.isVisible()


# Sections


def test_cutting_plane_card_lets_nothing_be_touched_that_is_cut_away(qtbot, globe):
    view, surface = globe.canvas.viewport, globe.canvas.surface
    middle = QPointF(*view.camera_controller.camera.middle)
    assert surface.hit(middle).point[2] == pytest.approx(1.0, abs=0.01)
    qtbot.keyClick(view, Qt.Key.Key_S)
    cut = globe.display_options.cutting_plane
    assert cut.isVisible()
    cut.slider.setValue(200)  # through the middle
    assert surface.hit(middle).point[2] == pytest.approx(-1.0, abs=0.01), "the inside of its back"
    cut.flip.click()
    assert surface.hit(middle).point[2] == pytest.approx(1.0, abs=0.01), "its front"
    view.camera_controller.show_standard_view("-front")
    assert surface.hit(middle).point[2] == pytest.approx(1.0, abs=0.01), "the inside of its front"
    qtbot.mouseClick(cut.axes[0], LEFT)
    at = view.camera_controller.camera.project(np.array([[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]]))
    hits = [surface.hit(QPointF(*p)) for p in at]
    assert [hit is None for hit in hits] == [False, True]
    qtbot.mouseClick(cut.close_button, LEFT)
    assert not switch(globe, "cut").isChecked()
    assert surface.hit(QPointF(*at[1])) is not None


def test_cutting_plane_card_cuts_the_picture_where_the_mesh_is_cut(qtbot, globe):
    view = globe.canvas.viewport
    switch(globe, "cut").trigger()
    plain, cut = picture(globe), globe.display_options.cutting_plane
    qtbot.mouseClick(cut.axes[1], LEFT)
    cut.slider.setValue(300)
    _, normal = cut.plane
    height = cut.plane[0][1]
    assert 0.3 < height < 0.95
    x, y = view.camera_controller.camera.project(np.array([[0.0, height, 0.0]]))[0]
    shown = picture(globe)
    inside = np.abs(shown[int(y) + 25, int(x)] - plain[0, 0]).max()
    assert normal[1] == -1.0
    assert inside > 10
    top = view.camera_controller.camera.project(np.array([[0.0, 0.97, 0.25]]))[0].astype(int)
    np.testing.assert_allclose(shown[top[1], top[0]], shown[top[1], 5], atol=6)


def test_cutting_plane_card_tells_its_place_in_the_unit(qtbot, globe):
    switch(globe, "cut").trigger()
    globe.choose_unit(Unit.CENTIMETRE)
    cut = globe.display_options.cutting_plane
    cut.slider.setValue(300)
    value, unit = cut.place.text().replace("−", "-").split("\u00a0")
    assert unit == "cm"
    assert float(value) == pytest.approx(cut.plane[0][2], rel=0.01)


def test_cutting_plane_card_tells_every_place_from_the_next_far_from_the_origin(qtbot, window):
    V, F = sphere(2)
    window.files.show_mesh(Mesh(V + [1000.0, 0.0, 500.0], F))
    idle(qtbot, window)
    switch(window, "cut").trigger()
    cut, places = window.display_options.cutting_plane, {}
    for step in range(150, 250, 10):
        cut.slider.setValue(step)
        places[cut.place.text()] = cut.plane[0][2]
    assert len(places) == 10
    assert [float(text) for text in places] == pytest.approx(list(places.values()), abs=0.005)


# The grid


def grid_of(view):
    """Actor of the grid, and its lines."""
    shown = [actor for actor in view.renderer.GetActors() if actor.GetVisibility()]
    drawn = [(actor, actor.GetMapper().GetInput()) for actor in shown]
    return next((actor, data) for actor, data in drawn if data.GetNumberOfLines())


def test_ground_lies_below_the_mesh_in_nice_steps(qtbot, globe):
    qtbot.keyClick(globe.canvas.viewport, Qt.Key.Key_I)
    ground, V = globe.display_options.ground, document(globe).mesh.V
    assert ground.visible
    assert ground.grid_step == 0.2
    grid, lines = grid_of(globe.canvas.viewport)
    low, high = np.array(grid.GetBounds()).reshape(3, 2).T
    assert low[1] == high[1] == pytest.approx(V[:, 1].min(), abs=1e-6)
    for axis in (0, 2):
        assert low[axis] <= V[:, axis].min() < V[:, axis].max() <= high[axis]
        assert low[axis] / ground.grid_step == pytest.approx(round(low[axis] / ground.grid_step), abs=1e-4)
    across = sum(
        round((ground.grid_corners[1, axis] - ground.grid_corners[0, axis]) / ground.grid_step) + 1
        for axis in (0, 2)
    )
    assert lines.GetNumberOfLines() == across
    globe.canvas.viewport.camera_controller.show_standard_view("top")
    settle(qtbot, globe.canvas.viewport)


def test_ground_gives_every_line_a_figure_of_its_own_far_from_the_origin(qtbot, window):
    V, F = sphere(2)
    window.files.show_mesh(Mesh(V + [1000.0, 0.0, 500.0], F))
    idle(qtbot, window)
    switch(window, "ground").trigger()
    window.canvas.viewport.camera_controller.show_standard_view("front")
    settle(qtbot, window.canvas.viewport)
    ground = window.display_options.ground
    told = [value for value, _ in figures(window) if value > 900.0]  # along x
    assert len(told) > 3
    assert (np.diff(told) > 0.5 * ground.grid_step).all()
    steps = np.array(told) / ground.grid_step
    np.testing.assert_allclose(steps, np.round(steps), rtol=0.0, atol=1e-6)


# The turntable


def test_turntable_turns_until_the_mouse_takes_the_camera(qtbot, globe):
    view, table = globe.canvas.viewport, globe.display_options.turntable
    before = view.camera_controller.camera
    qtbot.keyClick(view, Qt.Key.Key_T, SHIFT)
    qtbot.waitUntil(
        lambda: (
            np.linalg.norm(view.camera_controller.camera.position - before.position) > 0.05 * before.distance
        )
    )
    eye = view.camera_controller.camera
    assert eye.distance == pytest.approx(before.distance)
    assert eye.position[1] == pytest.approx(before.position[1]), "it goes around, and not up"
    Mouse(view).drag((30, 30), (30, 30))
    assert not table.is_running
    assert not switch(globe, "turntable").isChecked()
    assert not any(timer.isActive() for timer in table.findChildren(QTimer))
    switch(globe, "turntable").trigger()
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert not table.is_running


# All of them


def test_display_options_remember_what_is_shown_but_for_the_section(qtbot, globe, settings):
    for name in ("ghost", "ground"):
        switch(globe, name).trigger()
    other = Workbench(Shell(settings))
    show(qtbot, other.shell, other.canvas.viewport)
    try:
        assert other.display_options.ghost.visible
        assert other.display_options.ground.visible
        assert not switch(other, "cut").isChecked()
    finally:
        other.shell.close()
        other.shell.deleteLater()
        work_off()


def test_cards_stand_beside_the_ways_to_choose(qtbot, bottle):
    bottle.shell.resize(1280, 720)
    for name in ("compare", "cut"):
        switch(bottle, name).trigger()
    bottle.actions_.display.measures[Measure.AREA].trigger()
    bottle.actions_.tools[next(t for t in bottle.actions_.tools if t.name == "BASE")].trigger()
    work_off()
    cards = bottle.display_options.cards.geometry()
    assert bottle.mode_bar.isVisible()
    assert bottle.invitation.isVisible()
    for other in (bottle.mode_bar, bottle.invitation):
        assert not cards.intersects(other.geometry())
    assert bottle.canvas.viewport.rect().contains(cards)
    tops = [
        card.geometry()
        for card in (
            bottle.display_options.before_after,
            bottle.display_options.cutting_plane,
            bottle.display_options.legend,
        )
    ]
    for above, below in pairwise(tops):
        assert above.bottom() < below.top()
