"""Obstacles: distances, forces, and ways that do not lead into them."""

import numpy as np
import pytest
from meshes import sphere

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.contact_obstacles import capsule, plate, sphere as ball
from apd_viewer.geometry.contact.distances import gaps

REACH = 0.05
KINDS = {
    "plate": plate([0.2, 0.1, -1.0 - 0.5 * REACH], [0.1, -0.2, 1.0], 2.0),
    "sphere": ball([0.1, 1.5 + 0.4 * REACH, 0.0], 0.5),
    "capsule": capsule([1.3 + 0.4 * REACH, -0.4, 0.1], [1.3 + 0.4 * REACH, 0.5, -0.2], 0.3),
}


def touching(kind, **options):
    """A sphere of radius 1 in touch with an obstacle, or with all."""
    V, F = sphere(3)
    obstacles = [KINDS[kind]] if kind else list(KINDS.values())
    return V, F, Contact(V, F, np.zeros(len(V), np.int64), 1.0, REACH, obstacles=obstacles)


def edges_of(F):
    E = np.sort(np.vstack([F[:, :2], F[:, 1:], F[:, ::2]]), axis=1)
    return np.unique(E, axis=0)


def nearest(obstacle, shift, V, F):
    """Distance of a surface from an obstacle, by all pairs, on which side it is being known."""
    points = obstacle.points + shift
    pairs, edges = obstacle.pairs(F, edges_of(F), len(V))
    found = gaps(np.vstack([V, points]), pairs, edges) - obstacle.radius
    return float(found.min()), found


@pytest.mark.parametrize("kind", KINDS)
def test_obstacle_distances_are_those_of_samples_of_the_surface(kind):
    """Of a fine sampling of all triangles none is nearer than the nearest pair."""
    V, F = sphere(3)
    obstacle = KINDS[kind]
    least, _ = nearest(obstacle, 0.0, V, F)
    a, b = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12))
    inside = (a + b <= 1.0).ravel()
    w = np.stack([1 - a - b, a, b], axis=-1).reshape(-1, 3)[inside]
    X = np.einsum("sc,mcx->msx", w, V[F]).reshape(-1, 3)
    sampled = np.abs(obstacle.distances_and_directions(obstacle.points, X)[0]).min()
    assert least <= sampled + 1e-12
    assert sampled == pytest.approx(least, abs=0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_distances_and_directions_directions_are_the_slopes_of_distances(kind):
    obstacle, X = KINDS[kind], np.random.default_rng(0).normal(size=(20, 3))
    d, outwards = obstacle.distances_and_directions(obstacle.points, X)
    h = 1e-6
    for k in range(3):
        more, less = (
            obstacle.distances_and_directions(obstacle.points, X + s * h * np.eye(3)[k])[0] for s in (1, -1)
        )
        assert np.allclose((more - less) / (2 * h), outwards[:, k], atol=1e-6)
    assert np.abs(d).min() > 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_contact_forces_of_obstacles_are_those_of_differences(kind):
    """On the surface and on the obstacle, which carries what the surface does."""
    V, _, contact = touching(kind)
    contact.start_at(V)
    g, h = contact.quarter_gradient(V), 1e-7
    assert contact.touching_pairs > 0
    assert np.abs(g).max() > 0.0
    # Forces are balanced: what the gap does to one it does to the other.
    assert np.allclose(contact.loads[0], 4.0 * g.sum(axis=0), rtol=1e-10)
    load = contact.loads[0]
    for k in range(3):
        energies = []
        for sign in (1.0, -1.0):
            contact.start_at(V, sign * h * np.eye(3)[k : k + 1])
            energies.append(contact.energy_at(V))
        assert -(energies[0] - energies[1]) / (2 * h) == pytest.approx(load[k], rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.night) for k in range(1, 5))])
def test_contact_lets_no_way_lead_into_an_obstacle(seed):
    """Random steps of surface and obstacles: what is said to be free is free, and all in touch is listed."""
    rng = np.random.default_rng(seed)
    V, F, contact = touching(None)
    V, shifts = V.copy(), np.zeros((3, 3))
    contact.start_at(V)
    gone = refused = 0
    while gone <= 5 or refused <= 5:
        assert gone + refused < 60
        W = V + rng.normal(size=3) * 0.05 + 0.02 * np.sin(3 * V @ rng.normal(size=(3, 3)))
        ahead = shifts + 0.03 * rng.normal(size=(3, 3))
        contact.set_obstacle_targets(ahead)
        shares = contact.trial_fractions(W)
        if shares is not None:
            refused += 1
            contact.set_obstacle_targets(shifts)
            continue
        contact.accept_shape(W)
        gone += 1
        for t in np.linspace(0, 1, 9):
            between, place = V + t * (W - V), shifts + t * (ahead - shifts)
            for obstacle, shift in zip(KINDS.values(), place, strict=True):
                assert nearest(obstacle, shift, between, F)[0] > 0.0
                assert obstacle.distances_and_directions(obstacle.points + shift, between)[0].min() > 0.0
        V, shifts = W, ahead
        contact.quarter_gradient(V)
        near = [nearest(o, s, V, F)[1] for o, s in zip(KINDS.values(), shifts, strict=True)]
        assert contact.touching_pairs >= sum((found < REACH).sum() for found in near) > -1


def test_positions_pushed_by_obstacles_takes_what_is_pushed_along():
    """Vertices next to a plate keep their distance from it, far ones stay."""
    V, _, contact = touching("plate")
    contact.start_at(V)
    normal = contact.obstacles[0].obstacle.distances_and_directions(KINDS["plate"].points, V[:1])[1][0]
    contact.set_obstacle_targets(np.array([0.02 * normal]))
    W = contact.positions_pushed_by_obstacles(V, V)
    before = KINDS["plate"].distances_and_directions(KINDS["plate"].points, V)[0]
    after = KINDS["plate"].distances_and_directions(KINDS["plate"].points + 0.02 * normal, W)[0]
    near = before < REACH
    assert near.any()
    assert np.allclose(after[near], before[near], atol=1e-12)
    assert np.array_equal(W[before > 0.5], V[before > 0.5])
    assert contact.trial_fractions(W) is None


def test_positions_pushed_by_obstacles_lets_no_plate_push_back_what_another_pushes():
    V, F = sphere(3)
    plates = [plate([0, 0, s * (1.0 + 0.5 * REACH)], [0, 0, -s], 2.0) for s in (-1.0, 1.0)]
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, REACH, obstacles=plates)
    contact.start_at(V)
    contact.set_obstacle_targets(np.array([[0.0, 0.0, 0.02], [0.0, 0.0, -0.02]]))
    moved = contact.positions_pushed_by_obstacles(V, V) - V
    assert moved[np.argmin(V[:, 2]), 2] == pytest.approx(0.02)
    assert moved[np.argmax(V[:, 2]), 2] == pytest.approx(-0.02)


@pytest.mark.parametrize(
    "finger", [ball([0.0, 0.0, 0.5], 0.498), capsule([0.0, -0.1, 0.5], [0.0, 0.1, 0.5], 0.498)]
)
def test_positions_pushed_by_obstacles_takes_along_a_triangle_whose_vertices_are_far(finger):
    V = np.array([[2.0, 0.0, 0.0], [-1.0, 1.8, 0.0], [-1.0, -1.8, 0.0]])
    contact = Contact(V, np.array([[0, 1, 2]]), np.zeros(3, np.int64), 1.0, 0.01, obstacles=[finger])
    contact.start_at(V)
    ahead = np.array([[0.0, 0.0, -0.02]])
    contact.set_obstacle_targets(ahead)
    assert contact.trial_fractions(V) is not None, "it does not reach the triangle"
    W = contact.positions_pushed_by_obstacles(V, V)
    np.testing.assert_allclose(W - V, np.repeat(ahead, 3, axis=0), atol=1e-12)
    assert contact.trial_fractions(W) is None


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: plate([0, 0, 0], [0, 0, 0], 1.0), "direction"),
        (lambda: plate([0, 0, 0], [1, np.nan, 0], 1.0), "direction"),
        (lambda: ball([0, 0, 0], 0.0), "radius"),
        (lambda: capsule([0, 0, 0], [0, 0, 0], 1.0), "apart"),
        (lambda: capsule([0, 0, 0], [1, 0, 0], -1.0), "radius"),
    ],
)
def test_contact_obstacles_refuse_an_impossible_obstacle(make, words):
    with pytest.raises(InputError, match=words):
        make()
