"""Finishes on the screen: one sees through PET, foil mirrors, and overlays have the colours of the legend."""

import numpy as np
import pytest
from driving import idle, settle
from meshes import sphere

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.scene.surface_shading import Finish

BALL = Mesh(*sphere(3))
# Places on the front of the ball: bare below, painted above.
BARE, PAINTED = np.array([0.3, -0.4, 0.86]), np.array([0.3, 0.5, 0.81])


@pytest.fixture
def window(qtbot, kept_window):
    """The window on a ball with its upper half painted, seen from the front."""
    kept_window.session.files.open_mesh(BALL)
    idle(qtbot, kept_window)
    gestures, painting = kept_window.session.gestures, kept_window.session.painting
    gestures.begin()
    painting.paint(np.flatnonzero(BALL.V[:, 1] > 0.1), BASE)
    painting.end_stroke("Paint")
    kept_window.canvas.viewport.camera_controller.show_standard_view("front")
    kept_window.canvas.frame_mesh()
    return kept_window


def picture(qtbot, window):
    settle(qtbot, window.canvas.viewport)
    return window.canvas.viewport.screenshot(return_img=True)[:, :, :3].astype(float)


def color_at(qtbot, window, place):
    view, seen = window.canvas.viewport, picture(qtbot, window)
    x, y = (view.camera_controller.camera.project(place[None])[0] * seen.shape[1] / view.width()).astype(int)
    return seen[y, x]


def background(qtbot, window):
    """What the picture has at the height of the bare place, beside the ball."""
    view, seen = window.canvas.viewport, picture(qtbot, window)
    y = view.camera_controller.camera.project(BARE[None])[0, 1] * seen.shape[1] / view.width()
    return seen[int(y), 5]


def choose(window, finish):
    window.actions_.display.finishes[finish].trigger()


def test_finish_of_pet_lets_one_see_through_what_is_not_painted(qtbot, window):
    behind = background(qtbot, window)
    bare, painted = (color_at(qtbot, window, place) for place in (BARE, PAINTED))
    choose(window, Finish.PET)
    clear = color_at(qtbot, window, BARE)
    assert np.abs(clear - behind).max() < 0.6 * np.abs(bare - behind).max()
    blue = color_at(qtbot, window, PAINTED)
    assert blue[2] - blue[0] > 0.4 * (painted[2] - painted[0])


def bright_bands(brightness):
    """Number of maxima along a line that stand out by 8 of 255."""
    count, rising, turn = 0, True, brightness[0]
    for value in brightness:
        if (value > turn) == rising:
            turn = value
        elif abs(value - turn) > 8.0:
            count, rising, turn = count + rising, not rising, value
    return count


def test_finish_of_foil_mirrors_the_windows_on_both_sides(qtbot, window):
    """Across the bare half of the ball, where clay and fabric are bright on the side of the light alone."""
    bands = {}
    for finish in (Finish.CLAY, Finish.FOIL, Finish.FABRIC):
        choose(window, finish)
        view, seen = window.canvas.viewport, picture(qtbot, window)
        ends = np.array([[side, -0.35, 0.0] for side in (-0.9, 0.9)])
        (x0, y), (x1, _) = view.camera_controller.camera.project(ends) * seen.shape[1] / view.width()
        bands[finish] = bright_bands(seen[int(y), int(x0) : int(x1)].mean(axis=1))
    assert bands[Finish.CLAY] <= 1
    assert bands[Finish.FABRIC] <= 1
    assert bands[Finish.FOIL] >= 2


@pytest.mark.parametrize("finish", [Finish.PET, pytest.param(Finish.FOIL, marks=pytest.mark.night)])
def test_finish_yields_to_an_overlay_and_comes_back(qtbot, window, finish):
    display = window.actions_.display
    display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.canvas.surface.color_map is not None)
    expected = picture(qtbot, window)
    display.no_overlay.trigger()
    choose(window, finish)
    drawn = picture(qtbot, window)
    display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.canvas.surface.color_map is not None)
    np.testing.assert_array_equal(picture(qtbot, window), expected)
    display.no_overlay.trigger()
    np.testing.assert_array_equal(picture(qtbot, window), drawn)


def test_finish_is_remembered(qtbot, window):
    choose(window, Finish.FABRIC)
    assert window.preferences.display_options["finish"] == "fabric"
    assert window.actions_.display.finishes[Finish.FABRIC].isChecked()
    assert not window.actions_.display.finishes[Finish.CLAY].isChecked()
