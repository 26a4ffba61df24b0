"""The list of near pairs along a way: complete, and energy as a search of all pairs finds it."""

from itertools import combinations

import numpy as np
import pytest
from meshes import grid, tube

from apd_viewer.geometry.contact.distances import gaps
from apd_viewer.geometry.contact.gap_energy import gap_energy
from apd_viewer.geometry.contact.near_pairs import NearPairs
from apd_viewer.geometry.contact.pair_search import PairSearch
from apd_viewer.geometry.contact.patches import Patches


class BruteForce:
    """Every pair without a common vertex."""

    def __init__(self, V, F, reach):
        E = np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
        two = np.array([(*a, *b) for a, b in combinations(E, 2) if not set(a) & set(b)])
        one = np.array([(v, *f) for v in range(len(V)) for f in F if v not in f])
        self.pairs = np.vstack([two, one])
        self.edges = np.arange(len(self.pairs)) < len(two)
        self.reach = np.minimum(reach, 0.25 * gaps(V, self.pairs, self.edges))

    def energy(self, U):
        d = gaps(U, self.pairs, self.edges)
        near = d < self.reach
        pairs = zip(d[near], self.reach[near], strict=True)
        return sum(gap_energy(x, h) for x, h in pairs), int(near.sum()), d.min()


def walk(V, F, reach, seed, steps, size):
    """A crumpling way, as far as it is free; after each step the list and all pairs are compared."""
    rng = np.random.default_rng(seed)
    near, every = NearPairs(V, F, np.zeros((1, len(V)), np.int64), reach), BruteForce(V, F, reach)
    U, velocity, touched, refused = V, np.zeros_like(V), 0, 0
    middle = V.mean(axis=0)
    for _ in range(steps):
        waves = np.sin(2.0 * U @ rng.normal(size=(3, 3)) + rng.normal(size=3))
        velocity = (
            0.7 * velocity + size * (waves + 0.3 * rng.normal(size=V.shape)) - 0.1 * size * (U - middle)
        )
        W = U + velocity
        for _ in range(20):
            shares = near.find_collision_free_fractions(U, W)
            if shares is None:
                break
            refused += 1
            assert shares.min() < 1.0
            W = U + 0.9 * shares.min() * (W - U)
        else:
            velocity = np.zeros_like(V)
            continue
        near.accept_step()
        U = W
        energy, count, least = every.energy(U)
        assert least > 0.0
        assert near.energy_ahead == pytest.approx(energy, rel=1e-9, abs=1e-15 * reach**2)
        _, touching, nearest = near.gradient(U)
        assert touching == count
        assert near.may_touch or not count
        if count:
            # Distances of 1e-4 of the coordinates, of which one is found from the other end.
            assert nearest >= (1.0 - 1e-11) * least
            touched += 1
    return touched, refused, U


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.night)])
@pytest.mark.parametrize(("reach", "size"), [(0.05, 0.05), (0.2, 0.02), (0.02, 0.2)])
def test_near_pairs_are_complete_along_a_crumpling_way(seed, reach, size):
    V, F = grid(7, 7)
    touched, refused, _ = walk(V, F, reach, seed, 60, size)
    if size >= 0.05:
        assert touched >= 5
        assert refused


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_near_pairs_are_complete_whatever_the_unit(scale):
    V, F = tube(8, 6)
    touched, _, _ = walk(scale * V, F, scale * 0.05, 3, 40, scale * 0.05)
    assert touched


def test_near_pairs_enter_a_shape_as_if_it_had_been_walked_to():
    V, F = grid(7, 7)
    _, _, U = walk(V, F, 0.05, 1, 40, 0.05)
    near = NearPairs(V, F, np.zeros((1, len(V)), np.int64), 0.05)
    near.rebuild_at(U)
    energy, count, _ = BruteForce(V, F, 0.05).energy(U)
    assert count
    assert near.energy_ahead == pytest.approx(energy, rel=1e-12)


def test_near_pairs_leave_out_pairs_of_one_group():
    V, F = grid(7, 7)
    _, _, U = walk(V, F, 0.05, 1, 40, 0.05)
    near = NearPairs(V, F, np.ones((1, len(V)), np.int64), 0.05)
    near.rebuild_at(U)
    assert near.energy_ahead == 0.0
    some = np.stack([np.zeros(len(V), np.int64), (np.arange(len(V)) % 2) + 1])
    near = NearPairs(V, F, some, 0.05)
    near.rebuild_at(U)
    every = BruteForce(V, F, 0.05)
    apart = (some[1][every.pairs] != some[1][every.pairs[:, :1]]).any(axis=1)
    every.pairs, every.edges, every.reach = every.pairs[apart], every.edges[apart], every.reach[apart]
    assert near.energy_ahead == pytest.approx(every.energy(U)[0], rel=1e-12)
    assert near.energy_ahead > 0.0


def test_near_pairs_shorten_a_way_for_all_that_is_too_long_at_once():
    V, F = grid(7, 7)
    near = NearPairs(V, F, np.zeros((1, len(V)), np.int64), 0.05)
    shares = near.find_collision_free_fractions(V, V + np.random.default_rng(0).normal(size=V.shape) * 50.0)
    assert shares.min() == shares.max() < 0.1


def test_near_pairs_far_from_the_origin_have_the_energy_of_those_at_it():
    """What counts as touching at rest depends on the size of the mesh, not on where it lies."""
    V, F = grid(4, 4)
    n = len(V)
    V, F = np.vstack([V, V + [0.0, 0.0, 4e-4]]), np.vstack([F, F + n])
    U = V - np.outer(np.arange(2 * n) >= n, [0.0, 0.0, 3.5e-4])

    def energy(height):
        near = NearPairs(V + [0.0, 0.0, height], F, np.zeros((1, 2 * n), np.int64), 0.05)
        near.rebuild_at(U + [0.0, 0.0, height])
        return near.energy_ahead

    assert energy(0.0) > 0.0
    assert energy(1e6) == pytest.approx(energy(0.0), rel=1e-3)


def test_pair_search_knows_of_far_patches_how_far_they_are():
    """Otherwise each of them is searched, at every step, and found to have nothing."""
    V, F = grid(15, 15)
    E = np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
    patches, reach = Patches(V, F, E), 0.05
    between, apart = patches.near_pairs(patches.boxes(V), np.inf)
    search = PairSearch(V, F, E, patches, np.zeros((1, len(V)), np.int64), reach)
    _, bound = search.near_pairs(V, between, np.zeros(len(between)))
    assert (apart > reach).any()
    assert bound == pytest.approx(np.maximum(apart - reach, 0.0))
