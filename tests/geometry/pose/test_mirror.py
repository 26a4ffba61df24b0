"""Mirror planes: laws of mirrored motions and of motions within the plane."""

import numpy as np
import pytest

from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.mirror import MirrorPlane
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, shear, translation
from apd_viewer.geometry.pose.waypoint_path import rotation_vector

RNG = np.random.default_rng(11)
X = RNG.normal(size=(9, 3))
POSE = translation([0.3, -0.2, 0.9]) @ rotation_about(X[0], [1, 2, -3], 1.9) @ scaling_about(X[1], 1.3)


@pytest.mark.parametrize("axis", range(3))
def test_mirror_plane_mirrors_a_motion_to_one_that_moves_mirror_images_to_mirror_images(axis):
    plane = MirrorPlane(axis, 0.7)
    there = transform(plane.mirrored_pose(POSE), plane.image(X))
    np.testing.assert_allclose(there, plane.image(transform(POSE, X)), atol=1e-12)
    np.testing.assert_allclose(plane.mirrored_pose(plane.mirrored_pose(POSE)), POSE, atol=1e-12)
    np.testing.assert_allclose(plane.image(X), transform(plane.reflection, X), atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_mirror_plane_turns_a_mirrored_path_as_far_the_other_way_round(axis):
    plane, direction = MirrorPlane(axis, -2.0), np.array([2.0, 1.0, 2.0]) / 3.0
    way = [rotation_about(X[2], direction, a) for a in (1.5, 3.0, 4.5)]
    vector = rotation_vector([plane.mirrored_pose(each) for each in way[:-1]], plane.mirrored_pose(way[-1]))
    expected = 4.5 * direction * np.where(np.arange(3) == axis, 1.0, -1.0)
    np.testing.assert_allclose(vector, expected, atol=1e-9)


@pytest.mark.parametrize("axis", range(3))
def test_mirror_plane_has_motions_within_it_that_are_their_own_mirror_images(axis):
    plane, normal = MirrorPlane(axis, 0.4), np.eye(3)[axis]
    within = plane.symmetric_motion(POSE, X[3])
    np.testing.assert_allclose(plane.mirrored_pose(within), within, atol=1e-12)
    np.testing.assert_allclose(plane.symmetric_motion(within, X[3]), within, atol=1e-12)
    on_plane = np.where(normal > 0.0, 0.4, X[4])
    already = (
        translation(X[5] * (1 - normal)) @ rotation_about(X[6], normal, -2.8) @ scaling_about(on_plane, 0.7)
    )
    np.testing.assert_allclose(plane.symmetric_motion(already, X[3]), already, atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_mirror_plane_keeps_a_shear_within_it_and_makes_any_other_symmetric(axis):
    plane, normal = MirrorPlane(axis, 0.4), np.eye(3)[axis]
    one, other = np.eye(3)[[axis - 1, axis - 2]]
    foot = np.where(normal > 0.0, 0.4, X[4])
    within = shear(foot, foot + one, other, 0.7)
    np.testing.assert_allclose(plane.symmetric_motion(within, foot), within, atol=1e-12)
    made = plane.symmetric_motion(shear(foot, foot + normal + one, other, 0.7), X[3])
    np.testing.assert_allclose(plane.mirrored_pose(made), made, atol=1e-12)


def test_mirror_plane_leaves_nothing_of_a_motion_across_it():
    plane = MirrorPlane(0, 0.0)
    for angle in (0.3, 2.0, 3.1, -2.5):
        across = translation([5.0, 0.0, 0.0]) @ rotation_about(X[7], [0, 1, 2], angle)
        np.testing.assert_allclose(plane.symmetric_motion(across, X[7]), np.eye(4), atol=1e-12)
