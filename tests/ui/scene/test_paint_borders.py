"""Borders of the paint: within a triangle they run straight through the middles of its edges."""

import numpy as np
import pytest
from driving import settle

from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.presentation.palette import HANDLE_COLORS, REGION_COLORS, label_colors, paint_classes
from apd_viewer.ui.scene import surface_shading
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.surface_shading import Finish

CORNERS = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
TRIANGLE = np.array([[0, 1, 2]])


@pytest.fixture
def drawn(qtbot, view):
    """Draws a triangle with three colours at its corners; gives the colour at barycentric weights."""
    surface = Surface(view)

    def draw(rgba, before=lambda _: None):
        surface.set_mesh(SurfaceIndex.from_triangles(TRIANGLE, 3), CORNERS, rgba)
        before(surface)
        view.camera_controller.show_standard_view("front")
        view.camera_controller.frame(CORNERS)
        settle(qtbot, view)
        picture = view.screenshot(return_img=True)[:, :, :3].astype(float)
        ratio = picture.shape[1] / view.width()

        def at(*weights):
            weights = np.array(weights)
            point = (weights / weights.sum()) @ CORNERS
            x, y = (view.camera_controller.camera.project(point[None])[0] * ratio).astype(int)
            return picture[y, x]

        return at

    return draw


def near(a, b):
    """Whether two pixels differ by no more than rounding: the triangle is flat and lit evenly."""
    return np.abs(a - b).max() < 14.0


PAIRS = [(FREE, BASE), (FREE, HANDLE), (BASE, HANDLE), (HANDLE, HANDLE + 1)]


@pytest.mark.parametrize("finish", [Finish.CLAY, Finish.FABRIC])
@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("corner", range(3))
def test_surface_ends_paint_at_the_middles_of_edges(drawn, pair, corner, finish):
    labels = np.full(3, pair[0])
    labels[corner] = pair[1]
    at = drawn(label_colors(labels), lambda surface: surface.set_finish(finish))
    other = [k for k in range(3) if k != corner]
    pure = at(*np.roll([0.96, 0.02, 0.02], corner)), at(*np.roll([0.02, 0.49, 0.49], corner))
    assert not near(*pure)
    for share in (0.1, 0.5, 0.9):
        for own, expected in ((0.8, 0), (0.56, 0), (0.44, 1), (0.2, 1)):
            weights = np.zeros(3)
            weights[corner], weights[other[0]] = own, share * (1 - own)
            weights[other[1]] = (1 - share) * (1 - own)
            assert near(at(*weights), pure[expected]), (share, own)


def test_surface_ends_paint_where_a_stroke_has_changed_it(drawn):
    labels = np.array([FREE, FREE, FREE])
    painted = label_colors(np.array([BASE]))
    at = drawn(label_colors(labels), lambda surface: surface.set_colors(painted, np.array([1])))
    assert near(at(0.2, 0.58, 0.22), at(0.02, 0.96, 0.02))
    assert near(at(0.3, 0.42, 0.28), at(0.49, 0.02, 0.49))


def test_surface_has_the_edges_and_the_border_of_paint(drawn):
    def with_edges(surface):
        surface.shows_edges = True

    at = drawn(label_colors(np.array([FREE, BASE, FREE])), with_edges)
    assert near(at(0.2, 0.58, 0.22), at(0.05, 0.9, 0.05))
    assert near(at(0.3, 0.42, 0.28), at(0.45, 0.1, 0.45))


def test_surface_keeps_each_corner_its_colour_where_three_parts_meet(drawn):
    labels = np.array([BASE, HANDLE, FREE])
    at = drawn(label_colors(labels))
    for corner, label in enumerate(labels):
        alone = drawn(label_colors(np.full(3, label)))
        assert near(at(*np.roll([0.94, 0.03, 0.03], corner)), alone(*np.roll([0.94, 0.03, 0.03], corner)))
    # In the middle no colour stands out from what the three corners have.
    middle = at(1, 1, 1)
    ends = np.array([at(*np.roll([0.94, 0.03, 0.03], k)) for k in range(3)])
    assert (middle > ends.min(axis=0) - 14).all()
    assert (middle < ends.max(axis=0) + 14).all()


def test_surface_blends_colours_that_are_no_part(drawn):
    rgba = np.array([[250, 40, 40, 255], [40, 250, 40, 255], [40, 40, 250, 255]], dtype=np.uint8)
    at = drawn(rgba)
    halfway = (at(0.98, 0.01, 0.01) + at(0.01, 0.98, 0.01)) / 2
    assert near(at(0.5, 0.49, 0.01), halfway)


def test_paint_classes_differ_between_parts_that_are_likely_to_touch():
    labels = np.array([FREE, BASE, HANDLE, FREE, FREE, BASE, HANDLE])
    members = np.array([0, 0, 0, 1, 2, 1, 2])
    classes = paint_classes(label_colors(labels, members))
    assert classes[0] == 0
    assert len(set(classes[:5].tolist())) == 5
    assert classes[5] not in classes[[0, 1, 3]]
    assert classes[6] not in classes[[0, 2, 4]]
    for k in range(len(HANDLE_COLORS) - 1):
        a, b = paint_classes(label_colors(np.array([HANDLE + k, HANDLE + k + 1])))
        assert 0 < a != b > 0
    for k in range(1, len(REGION_COLORS)):
        a, b = paint_classes(label_colors(np.full(2, FREE), np.array([k, k + 1])))
        assert 0 < a != b > 0


def test_surface_blends_paint_on_a_mesh_of_too_many_vertices(drawn, monkeypatch):
    monkeypatch.setattr(surface_shading, "MOST_SHARP", 2)
    at = drawn(label_colors(np.array([FREE, BASE, FREE])))
    halfway = (at(0.02, 0.96, 0.02) + at(0.49, 0.02, 0.49)) / 2
    assert near(at(0.25, 0.5, 0.25), halfway)
