"""The way of held vertices: rigid where their motion is, and each handle for itself."""

import numpy as np
import pytest
from meshes import moved, rotation
from scipy.spatial.distance import pdist

from apd_viewer.geometry.pose.held_path import HeldPath

X = np.random.default_rng(4).normal(size=(12, 3)) + [3.0, 0.0, 1.0]
ONE = np.ones(12, int)


@pytest.mark.parametrize("degrees", [30.0, 179.0, 180.0, -180.0, 200.0])
@pytest.mark.parametrize("axis", [(0, 0, 1), (0, -1, 0), (1, -2, 3)])
def test_held_path_of_a_rigid_motion_is_rigid_all_the_way(degrees, axis):
    Y = moved(X, rotation(axis, np.radians(degrees)), (0.5, 0.0, 2.0))
    path = HeldPath(X, Y, ONE)
    assert np.array_equal(path.positions_at(1.0), Y)
    last = X
    for share in np.linspace(0.0, 1.0, 21):
        now = path.positions_at(share)
        assert np.allclose(pdist(now), pdist(X), rtol=1e-9)
        assert np.linalg.norm(now - last, axis=1).max() <= 1.05 * path.length / 20 + 1e-9, (
            "no jump at the end"
        )
        last = now


def test_held_path_of_half_a_turn_goes_the_same_way_round_whatever_rounding_says():
    ways = [
        HeldPath(X, moved(X, rotation((0, 1, 0), angle)), ONE).positions_at(0.5) for angle in (np.pi, -np.pi)
    ]
    assert np.allclose(*ways, atol=1e-6)


def test_held_path_leads_each_handle_its_own_way_and_the_rest_stays():
    handle_of = np.repeat([0, 1, 2], [2, 4, 6])
    Y = X.copy()
    Y[2:6] = moved(X[2:6], rotation((0, 0, 1), 1.0))
    Y[6:] = X[6:] ** 3
    now = HeldPath(X, Y, handle_of).positions_at(0.5)
    assert np.array_equal(now[:2], X[:2])
    assert np.allclose(pdist(now[2:6]), pdist(X[2:6]))
    assert np.allclose(now[6:], 0.5 * (X[6:] + Y[6:])), "what is deformed goes straight"


def test_held_path_of_points_is_straight_and_as_quick_for_hundreds():
    """Each of them is a handle of its own, beside one that turns."""
    random = np.random.default_rng(0)
    X = random.normal(size=(400, 3))
    turning, handle_of = slice(0, 20), np.r_[np.ones(20, int), np.arange(2, 382)]
    Y = X + random.normal(size=X.shape)
    Y[turning] = moved(X[turning], rotation((0, 0, 1), 1.0))
    path = HeldPath(X, Y, handle_of)
    half = path.positions_at(0.5)
    assert half[20:] == pytest.approx(0.5 * (X + Y)[20:], abs=1e-15)
    alone = HeldPath(X[turning], Y[turning], handle_of[turning])
    assert half[turning].tobytes() == alone.positions_at(0.5).tobytes()
    assert path.length == pytest.approx(max(alone.length, np.linalg.norm((Y - X)[20:], axis=1).max()))
