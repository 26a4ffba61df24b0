import numpy as np
import pytest
from driving import centre, grey, settle
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.ui.tools.brush_tool import BrushTool

ALT = Qt.KeyboardModifier.AltModifier
CONTROL = Qt.KeyboardModifier.ControlModifier
SHIFT = Qt.KeyboardModifier.ShiftModifier


class Heard:
    """What a painter has emitted."""

    def __init__(self, painter):
        self.words, self.parts = [], []
        painter.stroke_began.connect(lambda act: self.words.append(act.value))
        painter.stroke_ended.connect(lambda: self.words.append("ended"))
        painter.stroke_cancelled.connect(lambda: self.words.append("cancelled"))
        painter.vertices_painted.connect(self.parts.append)

    @property
    def ids(self):
        return np.concatenate(self.parts) if self.parts else np.empty(0, dtype=int)


@pytest.fixture
def painter(view, surface):
    painter = BrushTool(view, surface)
    painter.enabled = True
    view.tools.append(painter)
    return painter


@pytest.fixture
def heard(painter):
    return Heard(painter)


def facing(view, surface, ids):
    """Cosines between the normals of the ball and the direction to the camera."""
    to_camera = view.camera_controller.camera.position - surface.U[ids]
    return np.einsum("ij,ij->i", surface.U[ids], to_camera / np.linalg.norm(to_camera, axis=1)[:, None])


def test_brush_tool_covers_what_lies_within_the_radius_of_a_dab(view, surface, painter, heard, mouse):
    at = centre(view)
    mouse(view).drag(at, at)
    hit = surface.hit(at)
    radius = painter.size.radius * view.camera_controller.camera.world_per_pixel(hit.point)
    within = np.flatnonzero(np.linalg.norm(surface.U - hit.point, axis=1) <= radius)
    assert heard.words == ["add", "ended"]
    assert len(within) > 10
    np.testing.assert_array_equal(np.sort(heard.ids), within)


def test_brush_tool_leaves_the_camera_and_names_each_vertex_of_a_stroke_once(
    view, surface, painter, heard, mouse
):
    before, at = view.camera_controller.camera.key, centre(view)
    mouse(view).drag(*(at + QPointF(3 * i, i) for i in range(30)))
    assert view.camera_controller.camera.key == before
    assert len(heard.parts) > 3
    assert len(np.unique(heard.ids)) == len(heard.ids)


def test_brush_tool_covers_in_a_fast_stroke_what_it_does_in_a_slow_one(view, surface, painter, mouse):
    start, way = QPointF(200, 180), QPointF(240, 120)
    slow = Heard(painter)
    mouse(view).drag(*(start + way * (i / 200) for i in range(201)))
    slow = set(slow.ids.tolist())
    fast = Heard(painter)
    mouse(view).drag(start, start + way)
    fast = set(fast.ids.tolist())
    assert len(slow) > 100
    assert len(slow ^ fast) <= 0.04 * len(slow)


def test_brush_tool_stays_on_the_near_side_in_a_stroke_over_the_rim(view, surface, painter, heard, mouse):
    mouse(view).drag((320, 240), (320, 2), (320, 478), (630, 240), (10, 240))
    assert len(heard.ids) > 200
    assert facing(view, surface, heard.ids).min() > -0.35  # a brush on the rim reaches a little around it


def test_brush_tool_does_not_touch_what_a_stroke_leaps_over(qtbot, view, painter, surface, mouse):
    """Two plates, one far behind the other: between them the stroke leaves the surface."""
    steps = np.linspace(-1, 1, 41)
    X, Y = np.meshgrid(steps, steps)
    plate = np.column_stack([X.ravel(), Y.ravel(), np.zeros(X.size)])
    i = np.arange(41 * 41).reshape(41, 41)
    a, b, c, d = (q.ravel() for q in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    F = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    U = np.vstack([plate * [0.5, 1, 1] + [-0.5, 0, 0.0], plate * [2, 1.5, 1] + [0, 0, -4.0]])
    F = np.vstack([F, F + len(plate)])
    surface.set_mesh(SurfaceIndex.from_triangles(F, len(U)), U, grey(len(U)))
    view.camera_controller.camera = view.camera_controller.camera.framed(U)
    settle(qtbot, view)
    start, end = view.camera_controller.camera.project(np.array([[-0.5, 0.0, 0.0], [1.5, 0.0, -4.0]]))
    heard = Heard(painter)
    mouse(view).drag(start, end)
    behind = U[heard.ids][U[heard.ids][:, 2] < -1]
    assert len(behind) > 5
    edge = view.camera_controller.camera.project(np.array([[0.0, 0.0, 0.0]]))[0][0]
    # Nothing of the back plate that is hidden by the front one, but for the width of the brush.
    assert view.camera_controller.camera.project(behind)[:, 0].min() > edge - painter.size.radius - 2


def test_brush_tool_erases_with_alt(view, painter, heard, mouse):
    mouse(view).drag(centre(view), centre(view), modifiers=ALT)
    assert heard.words == ["remove", "ended"]


def test_brush_tool_lets_a_press_on_the_background_move_the_camera(view, painter, heard, mouse):
    before = view.camera_controller.camera.key
    mouse(view).drag((4, 4), (40, 60))
    assert heard.words == []
    assert view.camera_controller.camera.key != before


@pytest.mark.parametrize(
    ("button", "modifiers"), [(Qt.MouseButton.RightButton, ALT & ~ALT), (Qt.MouseButton.LeftButton, SHIFT)]
)
def test_brush_tool_lets_other_drags_on_the_surface_move_the_camera(
    view, painter, heard, mouse, button, modifiers
):
    before = view.camera_controller.camera.key
    mouse(view).drag((320, 240), (350, 250), button=button, modifiers=modifiers)
    assert heard.words == []
    assert view.camera_controller.camera.key != before


def test_brush_tool_does_nothing_when_it_is_put_away(view, painter, heard, mouse):
    painter.enabled = False
    mouse(view).drag(centre(view), centre(view))
    mouse(view).wheel(centre(view), 1)
    assert heard.words == []
    assert painter.size.radius == 24


def test_brush_tool_says_that_a_stroke_has_begun_closely_beside_the_surface(view, surface, painter, mouse):
    missed = []
    painter.missed.connect(lambda: missed.append(True))
    low = view.camera_controller.camera.project(surface.U)[:, 0].min()
    for x, expected in ((low - 60, 0), (low - 8, 1), (low + 30, 1)):
        at = QPointF(x, view.height() / 2)
        assert (surface.hit(at) is not None) == (x > low)
        mouse(view).drag(at, at)
        assert len(missed) == expected


def test_brush_tool_takes_the_stroke_back_on_escape(view, painter, heard, mouse):
    m, at = mouse(view), centre(view)
    m.press(at)
    QTest.keyClick(view, Qt.Key.Key_Escape)
    count = len(heard.ids)
    m.move(at + QPointF(60, 0))
    m.release(at + QPointF(60, 0))
    assert heard.words == ["add", "cancelled"]
    assert len(heard.ids) == count


def test_brush_tool_cancels_a_stroke_when_it_is_put_away(view, painter, heard, mouse):
    mouse(view).press(centre(view))
    painter.enabled = False
    assert heard.words == ["add", "cancelled"]


def test_brush_size_radius_is_changed_by_the_wheel_within_limits(view, painter, mouse):
    heard, before = [], view.camera_controller.camera.key
    painter.size.changed.connect(lambda: heard.append(painter.size.radius))
    mouse(view).wheel(centre(view), 1)
    assert painter.size.radius > 24
    mouse(view).wheel(centre(view), 100)
    assert painter.size.radius == 200
    mouse(view).wheel(centre(view), 1)  # nothing changes, nothing is said
    mouse(view).wheel(centre(view), -200)
    assert painter.size.radius == 4
    assert heard == [pytest.approx(24 * 1.12), 200, 4]
    assert view.camera_controller.camera.key == before


def test_brush_tool_lets_control_and_the_wheel_zoom(view, painter, mouse):
    before = view.camera_controller.camera.distance
    mouse(view).wheel(centre(view), 1, CONTROL)
    assert painter.size.radius == 24
    assert view.camera_controller.camera.distance < before


def test_brush_tool_shows_by_its_ring_where_the_brush_lies(view, painter, mouse):
    empty = view.tool_layer.grab().toImage()
    m = mouse(view)
    m.move(centre(view))
    on = view.tool_layer.grab().toImage()
    assert on != empty
    m.move((4, 4))
    assert view.tool_layer.grab().toImage() == empty
    m.move(centre(view))
    painter.enabled = False
    assert view.tool_layer.grab().toImage() == empty


def test_brush_tool_ring_follows_the_surface_under_a_resting_cursor(view, surface, painter, mouse):
    mouse(view).move(centre(view))
    before = view.tool_layer.grab().toImage()
    surface.set_points(surface.U + 5.0)
    after = view.tool_layer.grab().toImage()
    assert after != before
    view.mouse.leave()
    assert view.tool_layer.grab().toImage() == after, "there is nothing under the cursor"


def test_brush_tool_draws_no_scene_while_hovering(view, painter, mouse):
    QApplication.processEvents()
    view.antialiasing.idle_timer.stop()
    draws, m = view.draw_count, mouse(view)
    for x in range(300, 340, 5):
        m.move((x, 240))
        QApplication.processEvents()
    assert view.draw_count == draws


def test_brush_tool_covers_vertices_of_the_deformed_mesh(view, surface, painter, heard, mouse):
    surface.set_points(surface.U * [1, 1, 0.2])
    mouse(view).drag(centre(view), centre(view))
    hit = surface.hit(centre(view))
    assert hit.point[2] == pytest.approx(0.2, abs=0.01)
    reach = np.linalg.norm(surface.U[heard.ids] - hit.point, axis=1).max()
    assert reach <= painter.size.radius * view.camera_controller.camera.world_per_pixel(hit.point) * 1.001


def test_brush_tool_crosses_seams_in_a_stroke(view, surface, painter, mouse):
    F, U = surface.surface_index.F.copy(), surface.U.copy()
    whole = Heard(painter)
    mouse(view).drag(centre(view), centre(view))
    whole = whole.ids
    first = np.unique(F, return_index=True)[1]
    loose = np.arange(F.size).reshape(F.shape)
    surface.set_mesh(SurfaceIndex.from_triangles(loose, F.size, first[F]), U[F.ravel()], grey(F.size))
    loose = Heard(painter)
    mouse(view).drag(centre(view), centre(view))
    np.testing.assert_array_equal(np.sort(loose.ids), np.sort(first[whole]))


def test_brush_size_mesh_radius_is_as_large_on_the_mesh_however_near_it_is(view, surface, painter, mouse):
    painter.size.mesh_radius = 0.2
    counts = []
    for _ in range(2):
        heard = Heard(painter)
        mouse(view).drag(centre(view), centre(view))
        hit = surface.hit(centre(view))
        within = np.flatnonzero(np.linalg.norm(surface.U - hit.point, axis=1) <= 0.2)
        np.testing.assert_array_equal(np.sort(heard.ids), within)
        counts.append(len(within))
        mouse(view).wheel(centre(view), 6, CONTROL)
    assert counts[0] == counts[1] > 10


def test_brush_tool_leaves_no_gap_in_a_stroke_with_a_small_length(view, surface, painter, heard, mouse):
    painter.size.mesh_radius = 0.05
    start, end = centre(view) - QPointF(60, 0), centre(view) + QPointF(60, 0)
    mouse(view).drag(start, end)
    way = np.linspace(0, 1, 600).tolist()
    places = [surface.hit(start + (end - start) * t).point for t in way]
    away = np.min([np.linalg.norm(surface.U - x, axis=1) for x in places], axis=0)
    assert set(np.flatnonzero(away <= 0.045)) <= set(heard.ids) <= set(np.flatnonzero(away <= 0.0501))


def test_brush_size_mesh_radius_is_scaled_by_the_wheel_and_put_aside_by_pixels(view, painter, mouse):
    painter.size.mesh_radius = 0.2
    mouse(view).wheel(centre(view), 1)
    assert painter.size.mesh_radius == pytest.approx(0.2 * 1.12)
    painter.size.radius = painter.size.radius
    assert painter.size.mesh_radius is None
