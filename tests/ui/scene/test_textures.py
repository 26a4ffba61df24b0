"""Textures on the screen: the colours of a square at known places, at rest and deformed."""

import numpy as np
import pytest
from driving import document, idle, settle
from textured_files import COLORS, FILES, obj

from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.scene.surface_shading import Finish

# Where the middle of each quarter of the square is, (2, 2, 3).
PLACES = np.array([[[0.5, 1.5, 0.0], [1.5, 1.5, 0.0]], [[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]]])


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


def seen(qtbot, window, places):
    """Colours on the screen at places (..., 3), without their brightness."""
    view = window.canvas.viewport
    settle(qtbot, view)
    picture = view.screenshot(return_img=True)[:, :, :3].astype(float)
    scale = picture.shape[1] / view.width()
    at = (view.camera_controller.camera.project(places.reshape(-1, 3)) * scale).astype(int)
    colors = picture[at[:, 1], at[:, 0]].reshape(places.shape)
    return colors / colors.max(axis=-1, keepdims=True)


def expected():
    return COLORS / COLORS.max(axis=-1, keepdims=True)


def opened(qtbot, window, path):
    window.files.open_path(path)
    idle(qtbot, window)
    window.canvas.viewport.camera_controller.show_standard_view("front")
    window.canvas.frame_mesh()
    return window.actions_.display.switches["textures"]


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_texture_shows_its_colors_on_a_square_also_deformed(qtbot, window, tmp_path, kind):
    switch = opened(qtbot, window, FILES[kind](tmp_path))
    assert switch.isEnabled()
    assert np.ptp(seen(qtbot, window, PLACES).reshape(-1, 3), axis=0).max() < 0.1
    switch.trigger()
    np.testing.assert_allclose(seen(qtbot, window, PLACES), expected(), atol=0.12)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ np.diag([0.5, 1.0, 1.0])
    window.canvas.surface.set_points(np.array(window.session.store.state.frame.U) @ turn.T)
    window.canvas.viewport.camera_controller.frame(window.canvas.surface.U)
    np.testing.assert_allclose(seen(qtbot, window, PLACES @ turn.T), expected(), atol=0.12)


@pytest.mark.parametrize("finish", Finish)
def test_texture_is_seen_in_every_finish(qtbot, window, tmp_path, finish):
    opened(qtbot, window, obj(tmp_path)).trigger()
    window.actions_.display.finishes[finish].trigger()
    drawn = seen(qtbot, window, PLACES)
    assert np.corrcoef(drawn.ravel(), expected().ravel())[0, 1] > 0.8


def test_texture_lies_under_paint_and_overlays(qtbot, window, tmp_path):
    switch = opened(qtbot, window, obj(tmp_path))
    switch.trigger()
    window.session.gestures.begin()
    window.session.painting.paint(np.flatnonzero(document(window).mesh.V[:, 0] < 1.5), BASE)
    window.session.painting.end_stroke("Paint")
    found = seen(qtbot, window, PLACES)
    assert np.abs(found[:, 0] - expected()[:, 0]).max() > 0.3
    assert np.ptp(found[:, 0], axis=0).max() < 0.1
    window.actions_.display.measures[Measure.AREA].trigger()
    assert np.abs(seen(qtbot, window, PLACES)[:, 1] - expected()[:, 1]).max() > 0.3
    window.actions_.display.no_overlay.trigger()
    bare = np.array([1.95, 1.5, 0.0])  # beside the edge that no paint reaches
    for shading in window.actions_.view.shadings.values():
        if shading.isEnabled():
            shading.trigger()
            np.testing.assert_allclose(seen(qtbot, window, bare), expected()[0, 1], atol=0.25)
    switch.trigger()
    assert np.ptp(seen(qtbot, window, bare)) < 0.1


def test_texture_with_a_missing_image_is_told_and_its_switch_says_why(qtbot, window, tmp_path):
    switch = opened(qtbot, window, obj(tmp_path, with_image=False))
    assert not switch.isEnabled()
    assert switch.toolTip() == "The file has no texture"
    assert "four.png is missing" in window.notice.text
