"""Parts of a motion: equal parts are equal motions, and all of them together are the whole."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.screw_motion import RotationPath, screw_path
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation

coordinates = st.floats(-10, 10)
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)
plain = points.map(lambda v: v.round(6))  # SciPy's logarithm divides by entries that are all but nothing
axes = points.filter(lambda v: np.linalg.norm(v) > 0.1)
angles = st.floats(0, 3.1)
parts = st.floats(-0.5, 1.6)


def composed(displacement, axis, angle, centre):
    return translation(displacement) @ rotation_about(centre, axis, angle)


rigid = st.builds(composed, points, axes, angles, points)


def close(actual, expected, atol=1e-9):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=atol)


@given(rigid, points, st.floats(0.2, 5))
def test_screw_path_a_motion_begins_with_nothing_and_ends_with_the_motion(pose, pivot, factor):
    for whole in (pose, pose @ scaling_about(pivot, factor), pose @ scaling_about(pivot, [factor, 1, 0.5])):
        path = screw_path(whole, pivot)
        close(path.pose_at(0.0), np.eye(4), 1e-7)
        close(path.pose_at(1.0), whole, 1e-8)


@given(rigid, points, parts, parts)
def test_screw_path_a_rigid_motion_has_parts_that_follow_each_other_as_their_sum(pose, pivot, s, t):
    path = screw_path(pose, pivot)
    close(path.pose_at(s) @ path.pose_at(t), path.pose_at(s + t), 1e-6)


@settings(max_examples=20)  # SciPy takes long
@given(st.builds(composed, plain, plain.filter(np.any), st.floats(0.01, 3.0), plain), points, parts)
def test_screw_path_a_rigid_motion_is_the_exponential_of_a_part_of_the_logarithm(pose, pivot, part):
    close(screw_path(pose, pivot).pose_at(part), expm(part * logm(pose)).real, 1e-5)


@given(points, axes, angles.filter(lambda a: a > 1e-3), points, parts)
def test_screw_path_a_bend_goes_along_its_arc(point, axis, angle, pivot, part):
    """Not along the chord, which would come nearer to the line that is turned about."""
    close(
        screw_path(rotation_about(point, axis, angle), pivot).pose_at(part),
        rotation_about(point, axis, part * angle),
        1e-6,
    )


@given(points, points, parts)
def test_screw_path_a_shift_goes_straight(way, pivot, part):
    close(screw_path(translation(way), pivot).pose_at(part), translation(part * way))


@given(points, st.floats(0.1, 8), st.floats(0, 1.5))
def test_screw_path_a_stretch_grows_by_equal_factors_about_the_pivot(pivot, factor, part):
    close(
        screw_path(scaling_about(pivot, factor), pivot).pose_at(part),
        scaling_about(pivot, factor**part),
        1e-7,
    )


@given(points, axes, st.floats(-20, 20), parts)
def test_rotation_path_may_go_around_more_than_once(point, axis, angle, part):
    R = Rotation.from_rotvec(part * angle * axis / np.linalg.norm(axis)).as_matrix()
    close(RotationPath(point, axis, angle).pose_at(part)[:3, :3], R)
    close((RotationPath(point, axis, angle).pose_at(part) @ [*point, 1.0])[:3], point)


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        (rotation_about([1, 2, 3], [0, 1, 1], np.pi), "half turn.+twist of 180deg"),
        (scaling_about([0, 0, 0], [1, 1, -1]), "mirrors or flattens"),
        (np.diag([1.0, 1.0, 0.0, 1.0]), "mirrors or flattens"),
        (np.diag([0.0, 0.0, 0.0, 1.0]), "mirrors or flattens"),
    ],
)
def test_screw_path_refuses_what_has_no_one_way(pose, words):
    with pytest.raises(InputError, match=words):
        screw_path(pose, np.ones(3))
