"""Turns of the whole: taken out of steps, and of forces by the transpose."""

import numpy as np
from meshes import rotation

from apd_viewer.geometry.solver.touching_surface import NetRotationFilter

RNG = np.random.default_rng(0)
X, MASSES = RNG.normal(size=(50, 3)) * [1.0, 2.0, 0.3], RNG.uniform(0.1, 2.0, size=50)
FIRST = X + 0.2 * RNG.normal(size=(50, 3))


def test_net_rotation_filter_take_out_a_turn_and_not_a_shift():
    turns = NetRotationFilter(X, MASSES, FIRST)
    h = 1e-7
    turn = (X @ rotation((1.0, 2.0, 3.0), h).T - X) / h
    assert np.abs(turns.without_rotation(turn) - turns.without_rotation(turn).mean(axis=0)).max() < 1e-6
    shift = np.tile([1.0, -2.0, 0.5], (50, 1))
    assert np.allclose(turns.without_rotation(shift), shift)


def test_net_rotation_filter_leave_what_has_no_mean_turn_and_stays():
    turns, step = NetRotationFilter(X, MASSES, FIRST), RNG.normal(size=(50, 3))
    left = turns.without_rotation(step)
    assert (
        np.abs(np.cross(FIRST, MASSES[:, None] * (left - MASSES @ left / MASSES.sum())).sum(axis=0)).max()
        < 1e-12
    )
    assert np.allclose(turns.without_rotation(left), left)


def test_net_rotation_filter_balance_forces_by_the_transpose():
    turns = NetRotationFilter(X, MASSES, FIRST)
    step, force = RNG.normal(size=(2, 50, 3))
    assert np.isclose(
        (force * turns.without_rotation(step)).sum(), (turns.without_torque(force) * step).sum()
    )
    torque = np.cross(X - MASSES @ X / MASSES.sum(), turns.without_torque(force)).sum(axis=0)
    assert np.abs(torque).max() < 1e-12


def test_net_rotation_filter_let_many_steps_not_add_up_to_a_turn():
    """A shape that changes in a cycle; told against the shape of each step, it turns as a falling cat."""
    U, first = X, X - MASSES @ X / MASSES.sum()
    modes = RNG.normal(size=(2, 50, 3))
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    cycle = np.einsum("ka,kij->aij", 0.3 * np.array([np.cos(angles), np.sin(angles)]), modes)
    for step in np.diff(cycle, axis=0):
        U = U + NetRotationFilter(U, MASSES, X).without_rotation(step)
    moment = np.cross(first, MASSES[:, None] * U).sum(axis=0)
    assert np.abs(moment).max() < 1e-10


def test_net_rotation_filter_turn_points_on_a_line_about_what_they_can():
    line = np.outer(np.linspace(-1, 1, 20), [1.0, 0.0, 0.0])
    turns = NetRotationFilter(line, np.ones(20), line)
    assert np.abs(turns.without_rotation(np.cross([0.0, 1.0, 2.0], line))).max() < 1e-12
