"""Sums and maxima over rows, by threads."""

import numpy as np
import pytest

from apd_viewer.geometry.linalg.parallel_ops import largest_difference, largest_displacement


@pytest.mark.parametrize("n", [1, 7, 5_000])
def test_largest_displacement_is_that_of_the_farthest_point(n):
    A, B = np.random.default_rng(n).normal(size=(2, n, 3))
    assert largest_displacement(A, B) == pytest.approx(np.linalg.norm(A - B, axis=1).max(), rel=1e-15)
    assert largest_difference(A, B) == np.abs(A - B).max()
    assert largest_displacement(A, A) == 0.0
