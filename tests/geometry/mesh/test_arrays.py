"""Distinct integers and boxes of arrays, against NumPy's own."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from apd_viewer.geometry.mesh.arrays import bounding_box, distinct_keys, extents, used_vertices

KINDS = (np.int32, np.int64, np.uint32, np.uint8)
shapes = st.one_of(st.tuples(st.integers(0, 9), st.just(3)), st.tuples(st.integers(0, 9)))


@given(st.data(), st.sampled_from(KINDS), shapes)
def test_used_vertices_are_the_distinct_integers(data, kind, shape):
    F = data.draw(arrays(kind, shape, elements=st.integers(0, 100)))
    np.testing.assert_array_equal(used_vertices(F), np.unique(F))


@given(arrays(np.int64, st.integers(0, 20), elements=st.integers(-(2**62), 2**62)))
def test_distinct_keys_are_the_distinct_integers(keys):
    before = keys.copy()
    np.testing.assert_array_equal(distinct_keys(keys), np.unique(keys))
    np.testing.assert_array_equal(keys, before)


@pytest.mark.parametrize("order", ["C", "F"])
def test_bounding_box_and_extents_are_the_lowest_and_highest_coordinates(order):
    points = np.asarray(np.random.default_rng(0).normal(size=(20, 3)), order=order)
    low, high = bounding_box(points)
    np.testing.assert_array_equal(low, points.min(axis=0))
    np.testing.assert_array_equal(high, points.max(axis=0))
    np.testing.assert_array_equal(extents(points), np.ptp(points, axis=0))
