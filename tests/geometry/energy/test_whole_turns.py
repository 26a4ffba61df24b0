"""Turns of the whole: taken out of steps, and of forces by the transpose."""

import numpy as np
from meshes import rotation

from apd_viewer.geometry.energy.whole_turns import WholeTurns

RNG = np.random.default_rng(0)
X, MASSES = RNG.normal(size=(50, 3)) * [1.0, 2.0, 0.3], RNG.uniform(0.1, 2.0, size=50)


def test_a_turn_is_taken_out_and_a_shift_is_not():
    turns = WholeTurns(X, MASSES)
    h = 1e-7
    turn = (X @ rotation((1.0, 2.0, 3.0), h).T - X) / h
    assert np.abs(turns.without(turn) - turns.without(turn).mean(axis=0)).max() < 1e-6
    shift = np.tile([1.0, -2.0, 0.5], (50, 1))
    assert np.allclose(turns.without(shift), shift)


def test_what_is_left_has_no_mean_turn_and_stays():
    turns, step = WholeTurns(X, MASSES), RNG.normal(size=(50, 3))
    left = turns.without(step)
    assert (
        np.abs(np.cross(X, MASSES[:, None] * (left - MASSES @ left / MASSES.sum())).sum(axis=0)).max() < 1e-12
    )
    assert np.allclose(turns.without(left), left)


def test_forces_are_balanced_by_the_transpose():
    turns = WholeTurns(X, MASSES)
    step, force = RNG.normal(size=(2, 50, 3))
    assert np.isclose((force * turns.without(step)).sum(), (turns.balanced(force) * step).sum())
    torque = np.cross(X - MASSES @ X / MASSES.sum(), turns.balanced(force)).sum(axis=0)
    assert np.abs(torque).max() < 1e-12


def test_points_on_a_line_turn_about_what_they_can():
    line = np.outer(np.linspace(-1, 1, 20), [1.0, 0.0, 0.0])
    turns = WholeTurns(line, np.ones(20))
    assert np.abs(turns.without(np.cross([0.0, 1.0, 2.0], line))).max() < 1e-12
