"""Free shares of ways: safe against dense sampling and another library, and no smaller than need be."""

from itertools import combinations, product

import ipctk
import numpy as np
import pytest

from apd_viewer.geometry.contact import collision_times
from apd_viewer.geometry.contact.distances import gaps
from apd_viewer.geometry.contact.near_pairs import NearPairs

TWO = np.array([[0, 1, 2], [3, 4, 5]])
ALONE = np.zeros((1, 6), np.int64)
ENDS = list(combinations(range(3), 2))
PAIRS = np.array(
    [(*e, f[0] + 3, f[1] + 3) for e, f in product(ENDS, ENDS)]
    + [(v, 3, 4, 5) for v in range(3)]
    + [(v, 0, 1, 2) for v in range(3, 6)]
)
EDGES = np.arange(15) < 9


def least(X):
    """Least gap of two loose triangles (6, 3)."""
    return gaps(X, PAIRS, EDGES).min()


def at(U, W, share):
    return U + share * (W - U)


def shares(U, W, reach=1e-3):
    """Least share of the way of two loose triangles that is said to be free."""
    found = NearPairs(U, TWO, ALONE, reach).find_collision_free_fractions(U, W)
    return 1.0 if found is None else found.min()


def ways(count, seed=5):
    """Two triangles beside each other, and a way that often leads one through the other."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        U = rng.normal(size=(6, 3))
        U[3:] += 2.0 * rng.normal(size=3)
        d = least(U)
        if d < 1e-3:
            continue
        edge = np.linalg.norm(U[TWO] - U[np.roll(TWO, 1, axis=1)], axis=2).mean()
        middle = U.reshape(2, 3, 3).mean(axis=1)
        W = U + 0.2 * rng.normal(size=(6, 3))
        W[3:] += rng.uniform(0.3, 1.2) * (middle[0] - middle[1])
        longest = np.abs(W - U).max() * 3**0.5
        yield U, at(U, W, min(1.0, 0.7 * edge / longest))


def test_find_collision_free_fractions_finds_a_free_share_within_which_a_way_never_closes_a_gap():
    blocked = 0
    for U, W in ways(100):
        share = shares(U, W)
        blocked += share < 1.0
        sampled = min(least(at(U, W, share * s)) for s in np.linspace(0, 1, 50))
        assert sampled >= 0.05 * min(least(U), 0.02)
    assert blocked >= 5


def test_find_collision_free_fractions_ends_a_share_only_where_a_gap_is_about_to_close():
    blocked = free = open_ways = 0
    for U, W in ways(100):
        share, d = shares(U, W), least(U)
        if share < 1.0:
            blocked += 1
            motion = 2 * np.linalg.norm(W - U, axis=1).max()
            assert share >= 0.85 * min(1.0, d / motion)
        else:
            free += 1
        sampled = np.min([gaps(at(U, W, s), PAIRS, EDGES) for s in np.linspace(0, 1, 50)], axis=0)
        if (sampled > 0.2 * gaps(U, PAIRS, EDGES)).all():
            assert share == 1.0
            open_ways += 1
    assert blocked >= 10 < free
    assert open_ways >= 10


@pytest.mark.parametrize("seed", range(8))
def test_find_collision_free_fractions_lets_nearly_the_whole_gap_be_gone_straight_on(seed):
    """The bound is reached there, so that rounding decides what is left."""
    rng = np.random.default_rng(seed)
    d, normal = rng.uniform(0.05, 0.3), np.array([0.0, 0.0, 1.0])
    U = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, d], [0.3, 0.3, d + 1], [0.4, 0.2, d + 1]])
    W = U - (np.arange(6) >= 3)[:, None] * rng.uniform(1.01, 1.5) * d * normal
    blocked = d / np.abs(W - U).max()
    assert 0.85 * blocked <= shares(U, W) < blocked


def first_contact(U, W):
    """Time of the first contact by another library, 1 without any."""
    ccd, time = ipctk.TightInclusionCCD(), 1.0
    for pair, edges in zip(PAIRS, EDGES, strict=True):
        hits, when = (ccd.edge_edge_ccd if edges else ccd.point_triangle_ccd)(*U[pair], *W[pair])
        if hits:
            time = min(time, when)
    return time


def test_find_collision_free_fractions_lets_no_share_reach_the_first_contact_that_another_library_finds():
    blocked = 0
    for U, W in ways(60, seed=6):
        time, share = first_contact(U, W), shares(U, W)
        blocked += time < 1.0
        assert share < time or time == share == 1.0
        if time < 1.0:
            assert share >= 0.3 * time
    assert blocked >= 5


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-6, 1e-4, 9e-4, 1e-2])
@pytest.mark.parametrize("height", [1e-4, 1e-2])
def test_find_collision_free_fractions_lets_no_edges_at_a_small_angle_pass_through_each_other(angle, height):
    """Ridges of two roofs, one above the other, nearly along each other."""
    turned = np.array([np.cos(angle), np.sin(angle), 0.0])
    U = np.array(
        [
            [-1, 0, 0],
            [1, 0, 0],
            [0, 0.0, -1],
            -0.9 * turned + [0, 0, height],
            1.1 * turned + [0, 0, height],
            [0, 0, 1],
        ]
    )
    W = U - (np.arange(6) >= 3)[:, None] * [0.0, 0.0, 2 * height]
    share = shares(U, W, 10 * height)
    assert 0.3 <= share < 0.5


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_find_collision_free_fractions_gives_shares_that_do_not_depend_on_the_unit(scale):
    for U, W in ways(20, seed=7):
        assert shares(scale * U, scale * W, scale * 1e-3) == pytest.approx(shares(U, W), rel=1e-6)


def test_find_collision_free_fractions_gives_safe_shares_far_from_the_origin():
    away = np.array([1e4, -2e4, 3e4])
    for U, W in ways(20, seed=8):
        share = shares(U + away, W + away)
        assert share == pytest.approx(shares(U, W), rel=1e-3)
        assert least(at(U, W, share)) > 0.0


def test_find_collision_free_fractions_lets_what_is_as_near_as_it_may_be_go_away_again():
    """A way that opens a gap is free, however small the gap is."""
    U = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1e-7], [0.3, 0.3, 1], [0.4, 0.2, 1.0]])
    W = U + (np.arange(6) >= 3)[:, None] * [0.0, 0.0, 0.1]
    assert shares(U, W) == 1.0


def near_triangles(rng, height):
    """A corner of one triangle at a height above the middle of another, the rest of it well above."""
    U = rng.uniform(-1.0, 1.0, size=(6, 3)) * [1.0, 1.0, 0.1]
    U[3] = U[:3].mean(axis=0)
    normal = np.cross(U[1] - U[0], U[2] - U[0])
    normal /= np.linalg.norm(normal)
    U[4:] += normal * (0.2 - (U[4:] - U[3]) @ normal)[:, None]
    U[3:] += height * normal
    return U, normal


@pytest.mark.parametrize("height", [1e-3, 1e-5, 1e-7])
def test_find_collision_free_fractions_gives_neighbors_that_turn_and_stretch_as_one_a_free_way(height):
    """As those in slivers of a surface that bends: they move by many times their gap."""
    rng = np.random.default_rng(11)
    for _ in range(20):
        U, normal = near_triangles(rng, height)
        affine = 0.1 * rng.normal(size=(3, 3)) + np.cross(np.eye(3), 0.3 * rng.normal(size=3))
        W = U + U @ affine.T
        assert shares(U, W) == 1.0
        # Down by three times the gap besides: only the gap is free.
        W[3:] -= 3.0 * height * normal
        share = shares(U, W)
        assert share < 0.5
        assert min(least(at(U, W, share * s)) for s in np.linspace(0, 1, 200)) > 0.0


def test_find_collision_free_fractions_lets_a_pair_below_its_floor_that_stays_be_in_nobodys_way():
    X = np.array([[0.0, 0.0, 1e-3], [-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [-1.0, 2.0, 0.0]])
    pair, none = np.array([[0, 1, 2, 3]], dtype=np.int32), np.zeros(1, np.int32)
    low, after, share = np.full(1, 1e-3), np.empty(1), np.empty(1)
    numbers = np.full(1, 1e-2), np.full(1, 2e-3)  # reach and floor
    collision_times.detect_collisions(
        X, X.copy(), 0.0, pair, np.zeros(1, bool), low, *numbers, np.zeros(1), none, after, share, 0.0
    )
    assert share[0] == 1.0
