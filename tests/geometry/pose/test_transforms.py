"""Motions: what stays, what they are followed by each other, and that a readout says the same motion."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.transforms import (
    rigid_transform,
    rotation_about,
    scaling_about,
    shear,
    translation,
    twist,
)

ORIGIN, Z = np.zeros(3), np.array([0.0, 0.0, 1.0])
coordinates = st.floats(-100, 100)
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)
lengths = st.sampled_from([1e-300, 1e-5, 1.0, 7.0, 1e200])
shares = st.floats(-1, 1)
units = (
    st.tuples(shares, shares, shares)
    .map(np.array)
    .filter(lambda v: np.linalg.norm(v) > 0.1)
    .map(lambda v: v / np.linalg.norm(v))
)
axes = st.builds(lambda v, length: v * length, units, lengths)
angles = st.floats(-10, 10)
# Also as near to nothing and to half a turn as can be.
near = st.builds(lambda at, off: abs(at - off), st.sampled_from([0.0, np.pi]), st.floats(0, 1e-6))
readable = st.one_of(
    st.floats(0, np.pi), near, st.sampled_from([0.0, 1e-300, 1e-12, np.pi - 1e-15, np.pi, np.pi / 2])
)


def at(pose, point):
    return (pose @ [*point, 1.0])[:3]


def close(actual, expected, scale=1.0):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-11 * scale)


def composed(displacement, axis, angle, centre):
    """The rotation about the centre followed by the translation: what is decomposed."""
    return translation(displacement) @ rotation_about(centre, axis, angle)


def is_rigid(pose):
    R = pose[:3, :3]
    whole = np.array_equal(pose[3], [0, 0, 0, 1]) and np.abs(R.T @ R - np.eye(3)).max() <= 1e-9
    return whole and np.linalg.det(R) > 0


def raised(call, *given):
    with pytest.raises(InputError) as error:
        call(*given)
    sentence = str(error.value)
    assert sentence.endswith(".")
    assert "\n" not in sentence
    return sentence


@given(points, units, lengths, angles)
def test_rotation_about_is_what_scipy_says_and_leaves_its_axis(point, unit, length, angle):
    pose = rotation_about(point, unit * length, angle)
    close(pose[:3, :3], Rotation.from_rotvec(unit * angle).as_matrix())
    for t in (-3.0, 0.0, 2.0):
        close(at(pose, point + t * unit), point + t * unit, 100)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0, abs=1e-12)
    assert is_rigid(pose)


@given(points, axes, angles, angles)
def test_rotation_about_one_line_adds_up_and_is_undone(point, axis, a, b):
    both = rotation_about(point, axis, a) @ rotation_about(point, axis, b)
    close(both, rotation_about(point, axis, a + b), 1000)
    close(rotation_about(point, -axis, a), rotation_about(point, axis, -a), 1000)
    close(rotation_about(point, axis, a) @ rotation_about(point, axis, -a), np.eye(4), 1000)


@given(points, axes)
def test_rotation_about_by_no_angle_is_exactly_no_motion(point, axis):
    assert np.array_equal(rotation_about(point, axis, 0.0), np.eye(4))


def test_rotation_about_makes_a_quarter_turn_counter_clockwise_seen_from_the_tip():
    close(at(rotation_about([1, 0, 0], Z, np.pi / 2), [2, 0, 5]), [1, 1, 5])


@given(points, points)
def test_translation_adds_up_translations(a, b):
    assert np.array_equal(translation(a) @ translation(b), translation(a + b))
    assert is_rigid(translation(a))


@given(points, points, st.tuples(*[st.sampled_from([-2.0, 0.5, 1.0, 3.0])] * 3))
def test_scaling_about_leaves_its_point_and_multiplies_offsets(point, offset, factors):
    pose = scaling_about(point, factors)
    close(at(pose, point), point, 1000)
    close(at(pose, point + offset), point + offset * factors, 1000)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(np.prod(factors))


def test_scaling_about_takes_one_factor_for_three():
    assert np.array_equal(scaling_about([1, 2, 3], 1.5), scaling_about([1, 2, 3], [1.5, 1.5, 1.5]))


@pytest.mark.parametrize("factors", [0, -0.0, np.inf, np.nan, (1, 0, 2), (1, 2, -np.inf)])
def test_scaling_about_refuses_a_scale_that_flattens_or_bursts(factors):
    assert "scale" in raised(scaling_about, ORIGIN, factors)


@pytest.mark.parametrize("axis", [(0, 0, 0), (np.nan, 0, 1), (np.inf, 0, 0)])
def test_rotation_about_refuses_an_axis_without_a_direction(axis):
    assert "axis" in raised(rotation_about, ORIGIN, axis, 1.0)


@given(points, axes, angles)
def test_twist_leaves_the_line_between_the_centres(base, axis, angle):
    handle = base + 10 * axis / np.abs(axis).max()
    pose = twist(base, handle, angle)
    close(at(pose, base), base, 100)
    close(at(pose, handle), handle, 100)
    close(pose, rotation_about(base, handle - base, angle), 100)
    assert rigid_transform(pose, base).angle == pytest.approx(abs(np.arctan2(np.sin(angle), np.cos(angle))))


@pytest.mark.parametrize("apart", [0.0, 1e-15])
def test_twist_refuses_centres_that_coincide_and_have_no_line_between_them(apart):
    base = np.array([1.0, 2.0, 3.0])
    assert "coincide" in raised(twist, base, base + apart, 1.0)
    assert "coincide" in raised(twist, ORIGIN, ORIGIN, 1.0)
    assert is_rigid(twist(ORIGIN, [1e-15, 0, 0], 1.0))


@given(points, units, readable, points)
def test_rigid_transform_says_what_the_motion_is(displacement, axis, angle, centre):
    pose = composed(displacement, axis, angle, centre)
    close(at(pose, centre), centre + displacement, 1000)
    said = rigid_transform(pose, centre)
    close(said.displacement, displacement, 100)
    assert 0.0 <= said.angle <= np.pi
    assert said.angle == pytest.approx(angle, rel=1e-9, abs=1e-14)
    assert np.linalg.norm(said.axis) == pytest.approx(1.0)
    close(composed(*said, centre), pose, 1000)
    # The axis is as sure as the angle is large, and of half a turn it may be the other.
    if angle >= 1e-300:
        way = np.sign(said.axis @ axis) if angle > 3.14159265 else 1.0
        np.testing.assert_allclose(way * said.axis, axis, atol=1e-9)


@given(points, st.integers(0, 2**32 - 1))
def test_rigid_transform_says_what_scipy_says(centre, seed):
    R = Rotation.random(rng=np.random.default_rng(seed))
    pose = np.eye(4)
    pose[:3, :3] = R.as_matrix()
    said = rigid_transform(pose, centre)
    close(said.axis * said.angle, R.as_rotvec(), 100)
    close(said.displacement, R.apply(centre) - centre, 100)


def test_rigid_transform_reads_no_motion_as_nothing():
    said = rigid_transform(np.eye(4), [5.0, 1e9, -3.0])
    assert (*said.displacement, *said.axis, said.angle) == (0, 0, 0, 0, 0, 1, 0)


@pytest.mark.parametrize("i", range(3))
def test_rigid_transform_reads_half_a_turn_about_an_axis(i):
    said = rigid_transform(np.diag([*(2 * np.eye(3)[i] - 1), 1.0]), ORIGIN)
    assert said.angle == np.pi
    assert np.array_equal(np.abs(said.axis), np.eye(3)[i])


def test_rotation_about_stays_rigid_over_many_rotations_one_after_another():
    pose, rng = np.eye(4), np.random.default_rng(0)
    for _ in range(2000):
        pose = rotation_about(rng.normal(size=3), rng.normal(size=3), rng.normal()) @ pose
    assert is_rigid(pose)


@given(points, points, axes, angles)
def test_shear_moves_along_the_axis_by_the_height_and_keeps_volumes(base, point, axis, factor):
    along = axis / np.linalg.norm(axis / np.abs(axis).max()) / np.abs(axis).max()
    across = np.cross(along, np.roll(along, 1) + [0.1, 0.2, 0.3])
    pose = shear(base, base + 10.0 * across + 3.0 * along, axis, factor)
    height = (point - base) @ across / np.linalg.norm(across)
    close(at(pose, point), point + factor * height * along, 1e4)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0, abs=1e-9)


def test_shear_refuses_an_axis_along_the_line_to_the_handle():
    assert "no height" in raised(shear, [1.0, 2.0, 3.0], [1.0, 2.0, 9.0], Z, 0.3)
    assert "no height" in raised(shear, ORIGIN, ORIGIN, Z, 0.3)
