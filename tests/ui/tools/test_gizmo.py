from dataclasses import replace

import numpy as np
import pytest
from driving import centre
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.ui.scene.camera import Camera, rotation
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.tools.gizmo_drag import (
    ARROWS,
    RING_RADIUS,
    RINGS,
    SQUARES,
    GizmoFrame,
    GizmoOrientation,
    begin_drag,
    distance_to_polyline,
    nice_step,
    rotated_pose,
    snapped_value,
)

CENTRE = np.array([0.3, -0.2, 0.1])
POSE = np.eye(4)
POSE[:3, :3] = rotation(np.array([0.6, 0.0, 0.8]), 0.7)
POSE[:3, 3] = 0.4, 1.1, -0.3
UP = np.array([0.0, 1.0, 0.0])

ALONG_AXES = [(0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0.001), (0, -1, 0.001)]
ASKEW = [(0.5, 0.4, 1), (-0.7, 0.3, -1), (1, -0.5, 0.4), (-1, 0.6, 0.5), (0.4, 1, 0.5), (-0.5, -1, 0.4)]


def frame_from(direction, axes=None):
    direction = np.array(direction, dtype=float)
    position = CENTRE + 6 * direction / np.linalg.norm(direction) + np.array([0.02, 0.01, 0.03])
    camera = Camera(position, CENTRE + np.array([0.1, 0.05, 0.0]), UP, np.deg2rad(30), 800, 600)
    return GizmoFrame(camera, CENTRE, np.eye(3) if axes is None else axes)


def dragged(frame, handle, start, end, snap=False):
    return begin_drag(handle, frame, POSE, *start).moved_to(frame.camera, *end, snap)


def on_ring(frame, i, turn):
    a, b = frame.axes[(i + 1) % 3], frame.axes[(i + 2) % 3]
    world = frame.centre + RING_RADIUS * frame.pixel_length * (np.cos(turn) * a + np.sin(turn) * b)
    return frame.camera.project(world[None])[0]


def nearest_turn(frame, i):
    """The point of a ring nearest to the viewer, as an angle."""
    return np.arctan2(frame.view_cosines[(i + 2) % 3], frame.view_cosines[(i + 1) % 3])


@pytest.mark.parametrize(("height", "scale"), [(600, 1.0), (300, 2 / 3), (100, 0.5)])
def test_gizmo_shrinks_with_a_small_view_and_is_taken_where_it_is_drawn(height, scale):
    wide = frame_from((0.5, 0.4, 1))
    frame = GizmoFrame(replace(wide.camera, height=height), CENTRE, np.eye(3))
    assert np.linalg.norm(frame.scale_corner - frame.screen_centre) == pytest.approx(scale * np.hypot(86, 86))
    drawn = np.linalg.norm(frame.ring(2)[0] - frame.screen_centre, axis=1).max()
    assert drawn == pytest.approx(scale * RING_RADIUS, rel=0.1)
    for name, at in (("y", frame.arrow(1)[2]), ("scale", frame.scale_corner)):
        assert frame.handle_at(*at) == name


@pytest.mark.parametrize("direction", ALONG_AXES + ASKEW)
@pytest.mark.parametrize("i", range(3))
def test_gizmo_orientation_axis_lets_an_arrow_follow_the_cursor_from_every_side(direction, i):
    frame = frame_from(direction)
    if not frame.is_usable(ARROWS[i]):
        return
    grabbed = CENTRE + 60 * frame.pixel_length * frame.axes[i]
    for way in (0.37, -0.21):
        start, end = frame.camera.project(np.array([grabbed, grabbed + way * frame.axes[i]]))
        expected = POSE.copy()
        expected[:3, 3] += way * frame.axes[i]
        np.testing.assert_allclose(dragged(frame, ARROWS[i], start, end).pose, expected, atol=1e-9)


@pytest.mark.parametrize("slope", [0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.6])
@pytest.mark.parametrize("i", range(3))
def test_gizmo_orientation_axis_does_not_let_an_arrow_near_the_line_of_sight_run_away(slope, i):
    towards = np.eye(3)[i] + slope * np.eye(3)[(i + 1) % 3]
    frame = frame_from(towards)
    if not frame.is_usable(ARROWS[i]):
        assert slope < 0.4
        return
    start = frame.arrow(i)[1]
    for x, y in np.random.default_rng(i).uniform(-400, 400, (200, 2)):
        moved = dragged(frame, ARROWS[i], start, start + (x, y)).pose[:3, 3] - POSE[:3, 3]
        assert np.linalg.norm(moved) <= 4.001 * frame.pixel_length * np.hypot(x, y)


@pytest.mark.parametrize("direction", ASKEW)
@pytest.mark.parametrize("i", range(3))
@pytest.mark.parametrize("angle", [0.5, -0.3])
def test_turn_lets_a_ring_follow_the_cursor_from_every_side(direction, i, angle):
    frame = frame_from(direction)
    turn = nearest_turn(frame, i)
    drag = dragged(frame, RINGS[i], on_ring(frame, i, turn), on_ring(frame, i, turn + angle))
    np.testing.assert_allclose(drag.pose, rotated_pose(POSE, CENTRE, frame.axes[i], angle), atol=1e-9)


@pytest.mark.parametrize("direction", ALONG_AXES)
@pytest.mark.parametrize("i", range(3))
def test_turn_goes_the_way_of_the_cursor_for_a_ring_seen_from_the_side(direction, i):
    frame = frame_from(direction)
    turn = nearest_turn(frame, i)
    drag = dragged(frame, RINGS[i], on_ring(frame, i, turn), on_ring(frame, i, turn + 0.3))
    assert drag.angle == pytest.approx(0.3, rel=0.03)
    fixed = drag.pose @ np.linalg.inv(POSE)
    np.testing.assert_allclose(fixed[:3, :3] @ frame.axes[i], frame.axes[i], atol=1e-12)


@pytest.mark.parametrize("direction", ASKEW)
@pytest.mark.parametrize("i", range(3))
def test_offset_in_plane_moves_a_square_in_its_plane_with_the_cursor(direction, i):
    frame = frame_from(direction)
    offset = 0.2 * frame.axes[(i + 1) % 3] - 0.1 * frame.axes[(i + 2) % 3]
    start, end = frame.camera.project(np.array([CENTRE, CENTRE + offset]))
    drag = dragged(frame, SQUARES[i], start, end)
    np.testing.assert_allclose(drag.pose[:3, 3] - POSE[:3, 3], offset, atol=1e-9)
    np.testing.assert_array_equal(drag.pose[:3, :3], POSE[:3, :3])


def test_offset_in_plane_moves_the_dot_in_the_plane_of_the_picture():
    frame = frame_from((0.5, 0.4, 1))
    start = frame.camera.project(CENTRE[None])[0]
    end = start + np.array([50, -20])
    drag = dragged(frame, "centre", start, end)
    moved = drag.pose[:3, 3] - POSE[:3, 3]
    assert moved @ frame.camera.axes[2] == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(frame.camera.project((CENTRE + moved)[None])[0], end)


def test_drag_turns_rigidly_about_the_pivot_and_does_not_drift():
    frame = frame_from((0.5, 0.4, 1))
    drag = begin_drag("ry", frame, POSE, *on_ring(frame, 1, 0.4))
    for turn in np.linspace(0.4, 0.4 + 4 * np.pi, 300):
        drag = drag.moved_to(frame.camera, *on_ring(frame, 1, turn), snap=False)
    assert drag.angle == pytest.approx(4 * np.pi)
    np.testing.assert_allclose(drag.pose, POSE, atol=1e-9)
    half = drag.moved_to(frame.camera, *on_ring(frame, 1, 0.4 + 2.0), snap=False).pose
    np.testing.assert_allclose(half[:3, :3] @ half[:3, :3].T, np.eye(3), atol=1e-14)
    body = np.linalg.inv(POSE) @ [*CENTRE, 1]
    np.testing.assert_allclose((half @ body)[:3], CENTRE, atol=1e-12)


def test_drag_snaps_to_fifteen_degrees_and_to_round_lengths():
    frame = frame_from((0.5, 0.4, 1))
    drag = dragged(frame, "ry", on_ring(frame, 1, 0.2), on_ring(frame, 1, 0.2 + np.deg2rad(50)), snap=True)
    np.testing.assert_allclose(drag.pose, rotated_pose(POSE, CENTRE, UP, np.deg2rad(45)), atol=1e-12)
    assert drag.text == "+45.0°"
    start, end = frame.camera.project(np.array([CENTRE, CENTRE + 0.337 * np.eye(3)[0]]))
    moved = dragged(frame, "x", start, end, snap=True).pose[0, 3] - POSE[0, 3]
    step = nice_step(20 * frame.pixel_length)
    assert moved / step == pytest.approx(round(0.337 / step))


def test_drag_text_says_in_words_how_far_it_went():
    frame = frame_from((0, 0, 1))
    start, end = frame.camera.project(np.array([CENTRE, CENTRE - 0.25 * UP]))
    assert dragged(frame, "y", start, end).text == "Δy −0.250"
    start, end = frame.camera.project(np.array([CENTRE, CENTRE + np.array([0.1, 0.2, 0])]))
    assert dragged(frame, "xy", start, end).text == "Δx +0.100  Δy +0.200"


@pytest.mark.parametrize(
    ("length", "step"),
    [(1.0, 1), (1.3, 1), (1.6, 2), (4, 5), (8, 10), (0.031, 0.02), (0.04, 0.05), (700, 500)],
)
def test_nice_step_is_a_round_number_near_the_length(length, step):
    assert nice_step(length) == pytest.approx(step)


def test_snapped_value_gives_the_nearest_multiple_of_the_step():
    assert snapped_value(0.37, 0.25) == 0.25


def test_offset_in_plane_moves_nothing_for_a_cursor_past_the_horizon_of_the_plane():
    frame = frame_from((1, 0.3, 0))  # the floor seen flatly; high up in the picture is sky
    start = frame.camera.project(CENTRE[None])[0]
    assert dragged(frame, "zx", start, (400, -3000)).pose == pytest.approx(POSE)


@pytest.mark.parametrize("direction", ASKEW)
def test_handle_at_finds_each_handle_where_it_is_drawn(direction):
    frame = frame_from(direction)
    assert frame.handle_at(*frame.to_screen(np.zeros((1, 3)))[0]) == "centre"
    for i in range(3):
        if frame.is_usable(ARROWS[i]):
            assert frame.handle_at(*frame.arrow(i)[2]) == ARROWS[i]
        assert frame.handle_at(*frame.square(i).mean(axis=0)) in (SQUARES[i], *SQUARES, "centre")
    assert frame.handle_at(5, 5) is None


@pytest.mark.parametrize("direction", ASKEW)
def test_arrow_stands_clear_of_the_rings_through_its_axis_and_alone_begins_at_the_centre(direction):
    frame = frame_from(direction)
    for i in np.flatnonzero(np.abs(frame.view_cosines) < 0.8):
        for ring in {0, 1, 2} - {int(i)}:
            gaps = [distance_to_polyline(frame.ring(ring)[0], point) for point in frame.arrow(i)[:3]]
            assert min(gaps) > 2.0
    alone = replace(frame, offered_handles=frozenset({"x"}))
    assert alone.arrow(0)[0] == pytest.approx(alone.stem_foot(0))


def test_is_usable_refuses_arrows_along_the_view_and_squares_from_the_side():
    frame = frame_from((0, 0, 1))
    assert [frame.is_usable(h) for h in (*ARROWS, *SQUARES)] == [True, True, False, False, False, True]


def test_handle_at_finds_nothing_behind_the_camera():
    frame = frame_from((0, 0, 1))
    behind = GizmoFrame(frame.camera, 2 * frame.camera.position - CENTRE, np.eye(3))
    assert behind.handle_at(400, 300) is None


# ---- in the viewport


class Heard:
    """What a gizmo has emitted."""

    def __init__(self, gizmo):
        self.words, self.poses, self.hints = [], [], []
        for name in ("began", "ended", "cancelled"):
            getattr(gizmo, name).connect(lambda name=name: self.words.append(name))
        gizmo.moved.connect(self.poses.append)
        gizmo.hint_changed.connect(self.hints.append)


@pytest.fixture
def gizmo(view, surface):
    gizmo = Gizmo(view)
    view.tools.append(gizmo)
    view.camera_controller.camera = view.camera_controller.camera.orbited(-60, 60)
    gizmo.place(np.eye(4), np.array([0.1, 0.2, 0.0]))
    gizmo.visible = True
    return gizmo


def at_arrow(gizmo, i):
    return QPointF(*gizmo.frame.arrow(i)[:2].mean(axis=0))


def over_ring(gizmo, angle):
    """Way of the cursor along the near side of the y ring."""
    turn = nearest_turn(gizmo.frame, 1) - 0.7
    return [on_ring(gizmo.frame, 1, t) for t in np.linspace(turn, turn + angle, 12)]


def test_gizmo_moves_along_the_axis_of_a_dragged_arrow_and_leaves_the_camera(view, gizmo, mouse):
    heard, before, start = Heard(gizmo), view.camera_controller.camera.key, at_arrow(gizmo, 1)
    end = start + QPointF(0, -60)
    mouse(view).drag(start, start + QPointF(0, -20), end)
    assert heard.words == ["began", "ended"]
    assert len(heard.poses) == 2
    pose = heard.poses[-1]
    np.testing.assert_array_equal(pose[:3, :3], np.eye(3))
    np.testing.assert_array_equal(pose[[0, 2], 3], 0)
    assert pose[1, 3] > 0
    assert view.camera_controller.camera.key == before
    moved = at_arrow(gizmo, 1) - end
    assert abs(moved.y()) < 4  # perspective changes the length of the arrow a little
    np.testing.assert_array_equal(gizmo.pose, pose)


def test_gizmo_turns_about_the_pivot_when_a_ring_is_dragged(view, gizmo, mouse):
    heard = Heard(gizmo)
    mouse(view).drag(*over_ring(gizmo, np.deg2rad(55)))
    pose, pivot = heard.poses[-1], np.array([0.1, 0.2, 0.0])
    np.testing.assert_allclose(pose[:3, :3] @ UP, UP, atol=1e-12)
    np.testing.assert_allclose(pose[:3, :3] @ pivot + pose[:3, 3], pivot, atol=1e-12)
    assert np.arctan2(pose[0, 2], pose[0, 0]) == pytest.approx(np.deg2rad(55), abs=1e-6)
    assert heard.hints[-2] == "+55.0°"
    assert heard.hints[-1] == ""


def test_gizmo_snaps_while_dragging_with_control(view, gizmo, mouse):
    heard = Heard(gizmo)
    mouse(view).drag(*over_ring(gizmo, np.deg2rad(55)), modifiers=Qt.KeyboardModifier.ControlModifier)
    assert heard.hints[-2] == "+60.0°"


def test_gizmo_goes_back_on_escape(view, gizmo, mouse):
    heard, m, start = Heard(gizmo), mouse(view), at_arrow(gizmo, 1)
    m.press(start)
    m.move(start + QPointF(0, -40))
    QTest.keyClick(view, Qt.Key.Key_Escape)
    m.move(start + QPointF(0, -80))
    m.release(start + QPointF(0, -80))
    assert heard.words == ["began", "cancelled"]
    np.testing.assert_array_equal(heard.poses[-1], np.eye(4))
    np.testing.assert_array_equal(gizmo.pose, np.eye(4))


def test_gizmo_takes_a_click_for_no_drag(view, gizmo, mouse):
    heard, start = Heard(gizmo), at_arrow(gizmo, 1)
    mouse(view).drag(start, start + QPointF(1, 0))
    assert heard.words == []
    assert heard.poses == []
    assert not view.mouse.cancel()


def test_gizmo_lets_a_press_beside_it_move_the_camera(view, gizmo, mouse):
    heard, before = Heard(gizmo), view.camera_controller.camera.key
    mouse(view).drag((5, 5), (60, 40))
    assert heard.words == []
    assert view.camera_controller.camera.key != before


def test_gizmo_lets_the_right_button_on_a_handle_move_the_camera(view, gizmo, mouse):
    before, start = view.camera_controller.camera.key, at_arrow(gizmo, 1)
    mouse(view).drag(start, start + QPointF(0, 30), button=Qt.MouseButton.RightButton)
    assert view.camera_controller.camera.key != before


def test_gizmo_shows_under_the_cursor_what_a_press_takes(view, gizmo, mouse):
    m = mouse(view)
    m.move(at_arrow(gizmo, 1))
    assert view.cursor().shape() == Qt.CursorShape.OpenHandCursor
    lit = view.tool_layer.grab().toImage()
    m.press(at_arrow(gizmo, 1))
    assert view.cursor().shape() == Qt.CursorShape.ClosedHandCursor
    m.release(at_arrow(gizmo, 1))
    m.move((5, 5))
    assert view.cursor().shape() == Qt.CursorShape.ArrowCursor
    assert view.tool_layer.grab().toImage() != lit


def test_gizmo_keeps_the_pose_of_a_drag_whatever_is_placed_meanwhile(view, gizmo, mouse):
    heard, m, start = Heard(gizmo), mouse(view), at_arrow(gizmo, 1)
    m.press(start)
    m.move(start + QPointF(0, -30))
    gizmo.place(POSE, np.zeros(3))  # a late answer from the session
    m.move(start + QPointF(0, -60))
    m.release(start + QPointF(0, -60))
    np.testing.assert_array_equal(heard.poses[-1][:3, :3], np.eye(3))


def test_gizmo_cancels_a_drag_when_hidden_and_is_not_taken_while_hidden(view, gizmo, mouse):
    heard, m, start = Heard(gizmo), mouse(view), at_arrow(gizmo, 1)
    m.press(start)
    m.move(start + QPointF(0, -30))
    gizmo.visible = False
    m.release(start)
    m.drag(start, start + QPointF(0, -30))
    assert heard.words == ["began", "cancelled"]


def test_gizmo_axes_along_the_handle_turn_with_its_pose(view, gizmo, mouse):
    gizmo.orientation = GizmoOrientation.HANDLE
    gizmo.place(POSE, np.zeros(3))
    np.testing.assert_allclose(gizmo.frame.axes, POSE[:3, :3].T)
    np.testing.assert_allclose(gizmo.frame.centre, POSE[:3, 3])
    view.camera_controller.frame(gizmo.frame.centre + np.array([[1, 1, 1], [-1, -1, -1]]))
    heard, start = Heard(gizmo), at_arrow(gizmo, 0)
    tip = QPointF(*gizmo.frame.arrow(0)[2])
    mouse(view).drag(start, tip)
    moved = heard.poses[-1][:3, 3] - POSE[:3, 3]
    np.testing.assert_allclose(np.cross(moved, POSE[:3, 0]), 0, atol=1e-12)
    assert moved @ POSE[:3, 0] > 0


def test_gizmo_has_the_same_size_at_every_distance(view, gizmo):
    def length():
        ends = gizmo.frame.to_screen([[0, 0, 0], [0, 110, 0]])
        return np.linalg.norm(ends[1] - ends[0])

    before = length()
    view.camera_controller.zoom_at(centre(view), 0.2)
    assert length() == pytest.approx(before, rel=0.15)
    assert 70 < before < 140
