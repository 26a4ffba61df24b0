"""Turns beyond half: what a path remembers, what it reads, and where it leads."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation
from apd_viewer.geometry.pose.waypoint_path import (
    WaypointPath,
    extended_waypoints,
    handle_path,
    has_half_turn,
    rotation_vector,
    signed_angle,
)

coordinates = st.floats(-3, 3)
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)
axes = points.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: v / np.linalg.norm(v))
angles = st.floats(-900, 900)
steps = st.floats(15, 100)


def walked(point, axis, degrees, step=10.0, start=None):
    """Waypoints and pose after a turn in steps, as a hand makes it."""
    waypoints, pose = start or ((), np.eye(4))
    first, count = pose, max(1, int(np.ceil(abs(degrees) / step)))
    for k in range(1, count + 1):
        after = rotation_about(point, axis, np.deg2rad(degrees * k / count)) @ first
        waypoints, pose = extended_waypoints(waypoints, pose, after), after
    return waypoints, pose


@settings(max_examples=20)
@given(points, axes, angles, steps)
def test_rotation_vector_is_the_total_of_the_turn_however_it_was_made(point, axis, degrees, step):
    vector = rotation_vector(*walked(point, axis, degrees, step))
    np.testing.assert_allclose(vector, np.deg2rad(degrees) * axis, atol=1e-6)


@settings(max_examples=20)
@given(points, axes, angles, steps)
def test_rotation_vector_of_there_and_back_is_nothing(point, axis, degrees, step):
    there = walked(point, axis, degrees, step)
    waypoints, pose = walked(point, axis, -degrees, step, there)
    assert not has_half_turn(waypoints, pose)
    np.testing.assert_allclose(rotation_vector(waypoints, pose), 0.0, atol=1e-6)


@settings(max_examples=20)
@given(points, axes, st.floats(-179.9, 179.9), steps)
def test_has_half_turn_says_no_to_less_than_half_a_turn_which_the_pose_tells(point, axis, degrees, step):
    assert not has_half_turn(*walked(point, axis, degrees, step))


@settings(max_examples=20)
@given(points, axes, st.floats(180, 900), steps, st.floats(0, 1.3))
def test_handle_path_a_turn_about_one_line_is_that_turn(point, axis, degrees, step, part):
    path = handle_path(*walked(point, axis, degrees, step), point)
    assert isinstance(path, RotationPath)
    expected = rotation_about(point, axis, part * np.deg2rad(degrees))
    np.testing.assert_allclose(path.pose_at(part), expected, atol=1e-5)


@settings(max_examples=8)
@given(points, axes, axes, st.floats(200, 800), st.floats(20, 90), points)
def test_handle_path_waypoints_goes_along_them_without_a_jump(point, axis, other, degrees, tilt, shift):
    twisted = walked(point, axis, degrees)
    waypoints, pose = walked(point + 1.0, other, tilt, start=twisted)
    moved = translation(shift) @ pose
    waypoints = extended_waypoints(waypoints, pose, moved)
    path = handle_path(waypoints, moved, point)
    parts = np.linspace(0, 1, 200)
    poses = [path.pose_at(part) for part in parts]
    np.testing.assert_allclose(poses[0], np.eye(4), atol=1e-7)
    np.testing.assert_allclose(poses[-1], moved, atol=1e-7)
    for one, two in itertools.pairwise(poses):
        assert np.abs(two[:3, :3] - one[:3, :3]).max() < 0.2


def test_rotation_vector_of_a_twist_and_a_bend_keeps_the_turns_of_the_twist():
    twisted = walked(np.zeros(3), np.array([0.0, 0.0, 1.0]), 380.0)
    waypoints, pose = walked(np.zeros(3), np.array([1.0, 0.0, 0.0]), 30.0, start=twisted)
    vector = rotation_vector(waypoints, pose)
    assert 380 < np.rad2deg(np.linalg.norm(vector)) < 420
    assert isinstance(handle_path(waypoints, pose, np.zeros(3)), WaypointPath)


def test_signed_angle_of_a_stretched_handle_is_the_same_total():
    waypoints, pose = walked(np.ones(3), np.array([0.0, 1.0, 0.0]), 300.0)
    stretched = pose @ scaling_about(np.ones(3), [1.0, 2.0, 0.5])
    waypoints = extended_waypoints(waypoints, pose, stretched)
    assert np.rad2deg(signed_angle(rotation_vector(waypoints, stretched))) == pytest.approx(300.0, abs=1e-6)


@pytest.mark.parametrize(("axis", "sign"), [([0, 1, 0], 1), ([0, -1, 0], -1), ([0.1, -0.9, 0.3], -1)])
def test_signed_angle_has_the_sign_about_the_positive_axis(axis, sign):
    vector = rotation_vector(*walked(np.zeros(3), np.array(axis) / np.linalg.norm(axis), 250.0))
    assert np.rad2deg(signed_angle(vector)) == pytest.approx(sign * 250.0)
