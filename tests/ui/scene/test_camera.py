from dataclasses import replace

import numpy as np
import pytest

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.scene.camera import MARGIN, ORTHOGRAPHIC, PERSPECTIVE, Camera, rotation, unit_vector

UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(params=[PERSPECTIVE, ORTHOGRAPHIC], ids=["perspective", "orthographic"])
def camera(request):
    eye = Camera(
        np.array([3.0, 2.0, 5.0]), np.array([0.2, 0.1, -0.3]), UP, PERSPECTIVE, width=800, height=600
    )
    return eye.with_angle(request.param)


def points(count=50):
    return np.random.default_rng(1).normal(size=(count, 3))


def test_ray_runs_through_the_points_that_project_to_its_pixel(camera):
    for point, (x, y) in zip(points(), camera.project(points()), strict=True):
        origin, direction = camera.ray(x, y)
        np.testing.assert_allclose(direction, unit_vector(point - origin), atol=1e-12)


def test_project_puts_the_focal_point_in_the_middle_and_up_above_it(camera):
    np.testing.assert_allclose(camera.project(camera.focal[None]), [[400, 300]])
    above = camera.project((camera.focal + 0.1 * UP)[None])[0]
    assert above[0] == pytest.approx(400)
    assert above[1] < 300


def test_world_per_pixel_is_the_length_of_a_pixel(camera):
    right = camera.axes[0] * 10 * camera.world_per_pixel(camera.focal)
    np.testing.assert_allclose(camera.project((camera.focal + right)[None]), [[410, 300]])


@pytest.mark.parametrize("factor", [0.3, 1.2, 7.0])
def test_zoomed_leaves_the_point_where_it_is(camera, factor):
    point = np.array([0.7, -0.4, 0.5])
    closer = camera.zoomed(point, factor)
    np.testing.assert_allclose(closer.project(point[None]), camera.project(point[None]), atol=1e-9)
    assert closer.distance == pytest.approx(camera.distance / factor)
    np.testing.assert_allclose(closer.axes, camera.axes, atol=1e-12)


def test_panned_moves_the_focal_plane_with_the_cursor(camera):
    moved = camera.panned(30, -12).project(camera.focal[None])
    np.testing.assert_allclose(moved, [[430, 288]], atol=1e-9)


def test_orbited_keeps_the_distance_and_the_horizon(camera):
    turned = camera
    for step in ((40, 13), (-200, 90), (10, 700), (-35, 250)):
        turned = turned.orbited(*step)
        assert turned.distance == pytest.approx(camera.distance)
        assert turned.axes[0] @ UP == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(turned.focal, camera.focal)


@pytest.mark.parametrize("upside_down", [False, True])
def test_orbited_drags_the_near_side_along(camera, upside_down):
    if upside_down:
        camera = camera.orbited(0, 450)
        assert camera.axes[1] @ UP < 0
    near = camera.focal + 0.3 * unit_vector(camera.position - camera.focal)
    x, y = camera.orbited(5, 0).project(near[None])[0] - camera.project(near[None])[0]
    # The near side moves left when the camera moves right: the object follows the cursor.
    assert x > 0
    assert abs(y) < x
    _, y = camera.orbited(0, 5).project(near[None])[0] - camera.project(near[None])[0]
    assert y > 0


def test_framed_shows_all_and_wastes_little(camera):
    for cloud in (points(), points() * [5, 0.1, 1], points() * [0.1, 3, 0.1]):
        framed = camera.framed(cloud)
        xy = framed.project(cloud) - [400, 300]
        assert np.abs(xy / [400, 300]).max() == pytest.approx(1 / MARGIN)
        np.testing.assert_allclose(framed.axes, camera.axes, atol=1e-12)


@pytest.mark.parametrize("left", [0.0, 53.0, 300.0])
def test_framed_puts_the_picture_into_the_middle_of_what_is_free(camera, left):
    eye = replace(camera, left=left)
    for cloud in (points(), points() * [5, 0.1, 1], points() * [0.1, 1, 3], points() + [4, 0, 0]):
        framed = eye.framed(cloud)
        xy = framed.project(cloud)
        middle, free = np.array([(left + 800) / 2, 300]), np.array([800 - left, 600])
        assert np.abs(((xy.min(axis=0) + xy.max(axis=0)) / 2 - middle) / free).max() < 0.002
        assert ((np.abs(xy - middle) / free).max(axis=0) < 0.5).all()
        np.testing.assert_allclose(framed.project(framed.focal[None]), [middle])
        assert framed.focal @ framed.axes[2] == pytest.approx(
            ((cloud @ framed.axes[2]).min() + (cloud @ framed.axes[2]).max()) / 2
        ), "the camera orbits about a point as deep as the middle of all"


def test_ray_and_project_agree_beside_what_is_covered(camera):
    eye = replace(camera, left=120.0)
    for point, (x, y) in zip(points(), eye.project(points()), strict=True):
        np.testing.assert_allclose(eye.ray(x, y)[1], unit_vector(point - eye.position), atol=1e-12)
    np.testing.assert_allclose(eye.project(eye.focal[None]), [[460, 300]])


def test_framed_takes_a_single_point(camera):
    framed = camera.framed(np.ones((1, 3)))
    np.testing.assert_allclose(framed.project(np.ones((1, 3))), [[400, 300]])


@pytest.mark.parametrize(
    ("axis", "forward", "up"),
    [
        ("front", (0, 0, -1), (0, 1, 0)),
        ("-front", (0, 0, 1), (0, 1, 0)),
        ("side", (-1, 0, 0), (0, 1, 0)),
        ("-side", (1, 0, 0), (0, 1, 0)),
        ("top", (0, -1, 0), (0, 0, -1)),
        ("-top", (0, 1, 0), (0, 0, 1)),
    ],
)
def test_standard_view_looks_along_the_axis_upright_from_the_same_distance(camera, axis, forward, up):
    placed = camera.standard_view(axis)
    np.testing.assert_allclose(placed.axes[2], forward, atol=1e-12)
    np.testing.assert_allclose(placed.axes[1], up, atol=1e-12)
    np.testing.assert_allclose(placed.axes[0], np.cross(forward, up), atol=1e-12)
    assert placed.distance == pytest.approx(camera.distance)


def test_rotation_is_counter_clockwise_seen_from_the_tip():
    np.testing.assert_allclose(rotation(np.array([0.0, 0, 1]), np.pi / 2) @ [1, 0, 0], [0, 1, 0], atol=1e-15)


def test_with_angle_shows_the_focal_plane_as_before_in_another_projection(camera):
    plane = camera.focal + points(20) @ camera.axes[:2].T @ camera.axes[:2]
    for angle in (PERSPECTIVE, ORTHOGRAPHIC):
        other = camera.with_angle(angle)
        np.testing.assert_allclose(other.project(plane), camera.project(plane), atol=1e-6)
        assert other.span == pytest.approx(camera.span)
        assert other.is_orthographic == (angle == ORTHOGRAPHIC)


def test_with_angle_makes_lines_of_sight_parallel_without_perspective(camera):
    eye = camera.with_angle(ORTHOGRAPHIC)
    start = eye.focal + points(20) @ eye.axes[:2].T @ eye.axes[:2]
    behind = start + 0.5 * eye.span * eye.axes[2]
    inside = np.abs(eye.project(start) - [400, 300]).max(axis=1) < 300
    assert inside.any()
    assert np.abs(eye.project(behind) - eye.project(start))[inside].max() < 0.06


@pytest.mark.parametrize("up_axis", UpAxis)
def test_up_axis_has_the_views_of_the_first_whichever_it_is(camera, up_axis):
    frame = up_axis.frame
    np.testing.assert_array_equal(frame @ frame.T, np.eye(3))
    assert np.linalg.det(frame) == pytest.approx(1)
    assert up_axis.sign * np.eye(3)[up_axis.index] == pytest.approx(up_axis.direction)
    assert UpAxis.nearest(up_axis.direction + 0.3 * points(1)[0]) is up_axis
    turned = replace(
        camera,
        position=camera.position @ frame,
        focal=camera.focal @ frame,
        up=camera.up @ frame,
        up_axis=up_axis,
    )
    for move in (
        lambda eye: eye.standard_view("front"),
        lambda eye: eye.standard_view("-side"),
        lambda eye: eye.standard_view("-top"),
        lambda eye: eye.orbited(40, 13).orbited(-200, 90),
    ):
        expected, found = move(camera).project(points()), move(turned).project(points() @ frame)
        np.testing.assert_allclose(found, expected, atol=1e-5)
