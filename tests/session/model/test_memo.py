"""What is found out once for the very same arrays."""

import gc

import numpy as np
import pytest
from meshes import box, ends

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model import memo
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.model.state import initial_state


@pytest.fixture
def counted():
    """A function that is remembered, and the arguments of its calls."""
    calls = []

    @memo.memoised
    def total(X, Y, factor):
        calls.append((len(X), len(Y), factor))
        return factor * (X.sum() + Y.sum())

    return total, calls


def test_memoised_looks_at_the_very_same_arrays_once(counted):
    total, calls = counted
    X, Y = np.ones(3), np.ones(4)
    assert [total(X, Y, 2), total(X, Y, 2), total(X, Y, 3), total(X, Y, 2)] == [14, 14, 21, 14]
    assert calls == [(3, 4, 2), (3, 4, 3)]
    assert total(X.copy(), Y, 2) == 14
    assert len(calls) == 3


def test_memoised_forgets_what_was_found_with_the_first_array_that_goes(counted):
    total, calls = counted
    Y = np.ones(1)
    for n in range(50):  # some of them at the place in memory of one that is gone
        assert total(np.full(1, float(n)), Y, 1) == n + 1
    gc.collect()
    assert len(calls) == 50
    assert total.__closure__ is not None
    known = next(cell.cell_contents for cell in total.__closure__ if isinstance(cell.cell_contents, dict))
    assert known == {}


@pytest.fixture
def said():
    """A bar with base, handle and a region."""
    document = initial_state(Mesh(*box(2, 2, 6))).document
    base, top = ends(document.mesh.V)
    document = document.with_region(0, NamedRegion("low", 100.0)).with_region_number(base, 1)
    return document.with_label(base, BASE).with_label(top, HANDLE)


def test_memo_counts_nothing_again_in_a_drag(said):
    moved = said.with_pose(0, 2.0 * np.eye(4)).with_pose(0, 3.0 * np.eye(4))
    assert moved.label_counts is said.label_counts
    assert moved.centre(0) is said.centre(0)
    assert moved.rest_areas is said.rest_areas


def test_memo_finds_again_after_a_stroke_only_what_follows_from_it(said):
    painted = said.with_label(np.flatnonzero(said.labels == FREE)[:1], HANDLE)
    assert painted.label_counts[HANDLE] == said.label_counts[HANDLE] + 1
    assert painted.rest_areas is said.rest_areas
    held = painted.labels == HANDLE
    np.testing.assert_allclose(painted.centre(0), painted.initial_positions[held].mean(axis=0))
    np.testing.assert_array_equal(painted.label_counts, np.bincount(painted.labels, minlength=256))


def test_centre_is_none_for_a_handle_without_vertices(said):
    assert said.centre(1) is None
