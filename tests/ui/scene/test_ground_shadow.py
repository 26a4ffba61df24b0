"""The shadow on the ground, in pictures of a real window."""

import numpy as np
import pytest
from driving import document, settle
from PySide6.QtCore import QSize

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.scene.scene_picture import scene_picture


@pytest.fixture
def shown(qtbot, bottle):
    """Brightness of the view without the shadow minus that with it."""

    def difference():
        pictures = []
        for _ in range(2):
            settle(qtbot, bottle.canvas.viewport)
            pictures.append(bottle.canvas.viewport.screenshot(return_img=True).astype(float).mean(axis=2))
            bottle.actions_.display.switches["shadow"].trigger()
        return pictures[1] - pictures[0]

    return difference


def test_ground_shadow_darkens_the_ground_around_the_foot_alone(bottle, shown):
    darker = shown()
    at = np.argwhere(darker > 3.0)
    assert np.percentile(darker, 0.1) > -1.0, "nothing is brighter, but for smoothed edges"
    assert darker.max() > 20.0
    foot = np.array([0.0, document(bottle).mesh.V[:, 1].min(), 0.0])  # the bottle stands around the y-axis
    x, y = bottle.canvas.viewport.camera_controller.camera.project(foot[None])[0]
    high, wide = darker.shape
    assert abs(at[:, 1].mean() / wide * bottle.canvas.viewport.width() - x) < 30.0
    assert (at[:, 0] / high * bottle.canvas.viewport.height() > y - 60.0).all()


def test_ground_shadow_is_not_seen_from_below(bottle, shown):
    bottle.canvas.viewport.camera_controller.show_standard_view("-top")
    assert shown().max() <= 1.0


@pytest.mark.parametrize("up", [UpAxis.PLUS_Z, UpAxis.MINUS_X])
def test_ground_shadow_lies_below_the_shape_whatever_is_up(qtbot, bottle, up):
    view, shadow = bottle.canvas.viewport, bottle.display_options.shadow
    for stretch in (1.0, 1.5):
        view.camera_controller.set_up_axis(up)
        U = stretch * document(bottle).mesh.V
        bottle.canvas.surface.set_points(U)
        settle(qtbot, view)
        (box,) = (found for find in view.more_boxes if (found := find()))
        ends = np.array(box).reshape(3, 2)
        level = (U @ up.direction).min()
        heights = up.sign * ends[up.index]
        assert heights[0] == pytest.approx(heights[1])
        assert level - 0.01 * np.ptp(U) < heights[0] < level
    assert shadow.visible


def test_ground_shadow_is_in_pictures_with_their_background_alone(qtbot, bottle):
    settle(qtbot, bottle.canvas.viewport)
    pictures = [
        [scene_picture(bottle.canvas.viewport, QSize(300, 300), transparent=empty) for empty in (False, True)]
        for _ in range(2)
        if bottle.actions_.display.switches["shadow"].trigger() is None
    ]
    assert pictures[0][0] != pictures[1][0]
    assert pictures[0][1] == pictures[1][1]
