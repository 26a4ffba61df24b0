"""From painted labels and a pose to held vertices and their targets."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from meshes import rotation

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import (
    BASE,
    FREE,
    HANDLE,
    constraints,
    next_paint_sentence,
    transform,
)

labelled = arrays(int, st.integers(1, 12), elements=st.sampled_from([BASE, FREE, HANDLE]))


def pose(R=None, shift=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if R is None else R
    matrix[:3, 3] = shift
    return matrix


def test_constraints_have_the_codes_of_the_survey():
    assert (BASE, FREE, HANDLE) == (0, 1, 2)


def test_transform_makes_a_quarter_turn_about_z_and_a_shift():
    X = np.array([[1.0, 0, 0], [0, 0, 5]])
    moved = transform(pose(rotation([0, 0, 1], np.pi / 2), [10, 20, 30]), X)
    assert moved == pytest.approx(np.array([[10, 21, 30], [10.0, 20, 35]]))


def test_transform_composes_poses():
    X = np.random.default_rng(0).normal(size=(20, 3))
    a, b = pose(rotation([1, 2, 3], 0.7), [1, 0, 2]), pose(rotation([-1, 0, 1], 2.0), [0, 3, 0])
    assert np.abs(transform(a, transform(b, X)) - transform(a @ b, X)).max() <= 1e-14


@given(labelled)
def test_constraints_use_every_labelling_or_refuse_it_with_the_right_sentence(labels):
    grip = np.arange(3.0 * len(labels)).reshape(-1, 3)
    has = {code: (labels == code).any() for code in (BASE, FREE, HANDLE)}
    if all(has.values()):
        assert next_paint_sentence(labels) is None
        held = constraints(labels, grip, [pose(shift=[100.0, 0.0, 0.0])])
        assert held.fixed.tolist() == [i for i, code in enumerate(labels) if code != FREE]
        assert held.handles[0].tolist() == [i for i, code in enumerate(labels) if code == HANDLE]
        expected = grip + np.where(labels[:, None] == HANDLE, [100.0, 0.0, 0.0], 0.0)
        assert np.array_equal(held.targets, expected[held.fixed])
        return
    sentence = next_paint_sentence(labels)
    expected = "base" if not has[BASE] else "handle" if not has[HANDLE] else "Everything is painted"
    assert expected in sentence
    with pytest.raises(InputError) as refused:
        constraints(labels, grip, [np.eye(4)])
    assert str(refused.value) == sentence


def test_constraints_keep_the_base_at_its_grip_bit_for_bit_and_write_to_nothing_given():
    rng = np.random.default_rng(0)
    labels, grip = np.array([HANDLE, BASE, FREE, HANDLE, BASE]), rng.normal(size=(5, 3))
    given_labels, given_grip = labels.copy(), grip.copy()
    held = constraints(labels, grip, [pose(rotation([1, 1, 0], 1.0), [1, 2, 3])])
    assert np.array_equal(held.targets[[1, 3]], grip[[1, 4]])
    held.targets[:] = 0.0
    assert np.array_equal(labels, given_labels)
    assert np.array_equal(grip, given_grip)


def test_constraints_do_not_round_a_grip_of_integers():
    held = constraints(np.array([BASE, FREE, HANDLE]), np.eye(3, dtype=int), [pose(shift=[0.5, 0, 0])])
    assert held.targets.tolist() == [[1.0, 0, 0], [0.5, 0, 1]]
