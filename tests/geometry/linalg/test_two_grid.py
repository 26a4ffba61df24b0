"""Conjugate gradients with a coarse level, against scipy's direct solution."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array
from scipy.sparse.linalg import spsolve

from apd_viewer.geometry.goals.calm_parts import solve_two_grid


def laplacian(n: int) -> csr_array:
    """Of a square of n by n points, held along its border."""
    line = 2.0 * eye_array(n) - eye_array(n, k=1) - eye_array(n, k=-1)
    A = np.kron(line.toarray(), np.eye(n)) + np.kron(np.eye(n), line.toarray())
    return csr_array(A)


def pairs(n: int, c: int) -> csr_array:
    """Interpolation by the mean of the patch that a point is in; the last coarse unknown has none."""
    at = np.add.outer(np.arange(n) // 3 * c, np.arange(n) // 3).ravel()
    return csr_array((np.ones(n * n), (np.arange(n * n), at)), shape=(n * n, c * c + 1))


@pytest.mark.parametrize("held", [[], [0, 1, 2, 30, 200, 401]], ids=["all free", "some held"])
@pytest.mark.parametrize("springs", [0.0, 3.0], ids=["", "springs"])
def test_two_grid_comes_near_in_a_few_steps_and_nearer_in_more(held, springs):
    n = 24
    L, B = laplacian(n), np.random.default_rng(0).normal(size=(n * n, 2))
    free, stiff = np.ones(n * n, dtype=bool), np.zeros(n * n)
    free[held], stiff[100:120] = False, springs
    A = (L + diags_array(stiff)).tocsr()[free][:, free]
    exact = np.zeros_like(B)
    exact[free] = np.column_stack([spsolve(A.tocsc(), b) for b in B[free].T])
    P = pairs(n, n // 3)
    R, places = (P.T @ (L @ P)).tocsr(), np.zeros((P.shape[1], 3))
    errors = [
        np.abs(solve_two_grid(L, stiff, free, B, P, R, places, steps) - exact).max() for steps in (5, 10, 50)
    ]
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 1e-2 * np.abs(exact).max()
    assert errors[2] < 1e-8 * np.abs(exact).max()
