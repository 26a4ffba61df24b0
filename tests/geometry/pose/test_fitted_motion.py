"""The motion that fits points best: exact where there is one, and harmless where there is none."""

import numpy as np

from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.transforms import fitted_motion, rotation_about, scaling_about, translation

RNG = np.random.default_rng(5)
MOTION = translation([3, 1, -2]) @ rotation_about([1, 0, 4], [1, -2, 2], 2.7) @ scaling_about([0, 1, 0], 1.7)


def test_fitted_motion_finds_a_similarity_from_points_in_space_or_in_a_plane():
    X = RNG.normal(size=(12, 3))
    for points in (X, X * [1, 1, 0], X[:3]):
        np.testing.assert_allclose(fitted_motion(points, transform(MOTION, points)), MOTION, atol=1e-12)


def test_fitted_motion_fits_no_worse_than_any_other():
    X, Y = RNG.normal(size=(2, 15, 3))
    fitted = fitted_motion(X, Y)

    def error(motion):
        return float(((transform(motion, X) - Y) ** 2).sum())

    for _ in range(100):
        axis, centre = RNG.normal(size=(2, 3))
        near = (
            rotation_about(centre, axis, 1e-3 * RNG.normal())
            @ translation(1e-3 * RNG.normal(size=3))
            @ fitted
        )
        assert error(near) >= error(fitted)
        assert error(scaling_about(centre, 1.0 + 1e-3 * RNG.normal()) @ fitted) >= error(fitted)


def test_fitted_motion_moves_few_points_onto_their_targets():
    for count in (1, 2):
        X = RNG.normal(size=(count, 3))
        fitted = fitted_motion(X, transform(MOTION, X))
        np.testing.assert_allclose(transform(fitted, X), transform(MOTION, X), atol=1e-12)
        assert np.linalg.det(fitted[:3, :3]) > 0.0
    same = np.ones((4, 3))
    np.testing.assert_allclose(fitted_motion(same, same + 1.0), translation([1, 1, 1]), atol=1e-12)
