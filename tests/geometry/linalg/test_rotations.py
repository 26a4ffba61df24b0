"""The local step against numpy's singular value decomposition, on a million matrices by night."""

import numpy as np
import pytest
from numba import njit

from apd_viewer.geometry.linalg.rotations import (
    LANES,
    ROWS,
    fit_lanes,
    load_rotation,
    quaternion_to_matrix,
    store_rotation,
)

COUNT = 20_000
EYE = np.array([1.0, 0.0, 0.0, 0.0])


@njit
def fit_rotations(S, q, R):
    """The rotations that maximise ``tr(R^T S)``, from ``q`` (n, 4) and into it, and as matrices."""
    X, scratch = np.zeros(ROWS * LANES), np.empty((3, 4, 4))
    for first in range(0, len(S), LANES):
        count = min(LANES, len(S) - first)
        for i in range(count):
            for a in range(3):
                for b in range(3):
                    X[(3 * a + b) * LANES + i] = S[first + i, a, b]
            load_rotation(X, i, q[first + i])
        fit_lanes(X, scratch)
        for i in range(count):
            store_rotation(X, i, q[first + i])
            quaternion_to_matrix(q[first + i], R[first + i])


def random_rotations(rng, count):
    q = rng.normal(size=(count, 4))
    return from_quaternions(q / np.linalg.norm(q, axis=1, keepdims=True))


def from_quaternions(q):
    w, x, y, z = q.T
    K = np.zeros((len(q), 3, 3))
    K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -z, y, -x
    K -= K.transpose(0, 2, 1)
    return np.eye(3) + 2 * w[:, None, None] * K + 2 * K @ K


def with_singular_values(rng, s):
    """Matrices A diag(s) B^T with rotations A and B; the sign of the determinant is that of prod(s)."""
    A, B = random_rotations(rng, len(s)), random_rotations(rng, len(s))
    return (A * s[:, None, :]) @ B.transpose(0, 2, 1)


def gaussian(rng):
    return rng.normal(size=(COUNT, 3, 3))


def reflected(rng):
    s = np.sort(rng.uniform(0.0, 1.0, (COUNT, 3)), axis=1)[:, ::-1] * [1, 1, -1]
    return with_singular_values(rng, s)


def nearly_ambiguous(rng):
    """The second and the negated third singular value agree to 1 to 15 digits."""
    s = rng.uniform(0.1, 1.0, (COUNT, 3))
    s[:, 0] += 1.0
    s[:, 2] = -s[:, 1] * (1.0 - 10.0 ** rng.uniform(-15, -1, COUNT))
    return with_singular_values(rng, s)


def repeated_singular_values(rng):
    s = rng.uniform(0.1, 1.0, (COUNT, 3))
    kind = rng.integers(5, size=COUNT)
    s[kind == 0] = s[kind == 0][:, [0, 0, 0]]
    s[kind == 1] = s[kind == 1][:, [0, 0, 1]]
    s[kind == 2] = s[kind == 2][:, [0, 1, 1]]
    s[kind == 3] = s[kind == 3][:, [0, 0, 0]] * [1, 1, -1]
    s[kind == 4] = s[kind == 4][:, [0, 1, 1]] * [1, 1, -1]
    return with_singular_values(rng, s)


def rank_two(rng):
    """Also exactly flat ones, as at the vertices of a plane sheet: a column is zero."""
    S = with_singular_values(rng, rng.uniform(0.0, 1.0, (COUNT, 3)) * [1, 1, 0])
    S[: COUNT // 4] = rng.normal(size=(COUNT // 4, 3, 3)) * [1, 1, 0]
    return S


def rank_one(rng):
    S = rng.normal(size=(COUNT, 3, 1)) * rng.normal(size=(COUNT, 1, 3))
    S[: COUNT // 4] *= [1, 0, 0]
    return S


def tiny_and_huge(rng):
    return rng.normal(size=(COUNT, 3, 3)) * 10.0 ** rng.uniform(-150, 150, (COUNT, 1, 1))


def near_a_rotation(rng):
    """What a deformation meets most of the time: positive definite times a rotation."""
    s = rng.uniform(0.5, 2.0, (COUNT, 3))
    return with_singular_values(rng, s) + 1e-3 * rng.normal(size=(COUNT, 3, 3))


def exactly_symmetric(rng):
    """Diagonal and axis-aligned matrices, signs and zeros included: the corners of the case analysis."""
    s = rng.integers(-2, 3, (COUNT, 3)).astype(float)
    S = np.zeros((COUNT, 3, 3))
    for row, column in enumerate(np.argsort(rng.uniform(size=(COUNT, 3)), axis=1).T):
        S[np.arange(COUNT), row, column] = s[:, row]
    return S


def largest_trace(S):
    """The maximum of tr(R^T S) over the rotations, a maximiser, and the relative gap that makes it unique."""
    A, s, Bt = np.linalg.svd(S)
    sign = np.where(np.linalg.det(A @ Bt) < 0, -1.0, 1.0)
    A[:, :, 2] *= sign[:, None]
    gap = np.divide(s[:, 1] + sign * s[:, 2], s[:, 0], out=np.zeros(len(s)), where=s[:, 0] > 0)
    return s[:, 0] + s[:, 1] + sign * s[:, 2], A @ Bt, gap


def starts(rng, kind):
    if kind == "identity":
        return np.tile(EYE, (COUNT, 1))
    q = rng.normal(size=(COUNT, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


FAMILIES = [
    gaussian,
    reflected,
    nearly_ambiguous,
    repeated_singular_values,
    rank_two,
    rank_one,
    tiny_and_huge,
    near_a_rotation,
    exactly_symmetric,
]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.night) for k in range(1, 7))])
def test_fit_lanes_reaches_the_largest_trace_from_any_start(family, seed):
    rng = np.random.default_rng([FAMILIES.index(family), seed])
    S = family(rng)
    best, best_R, gap = largest_trace(S)
    identity, anywhere = starts(rng, "identity"), starts(rng, "random")
    for q in (identity, anywhere, identity):  # the last one is warm: it starts from the previous answer
        R = np.full((COUNT, 3, 3), np.nan)
        fit_rotations(S, q, R)
        trace = (R * S).sum(axis=(1, 2))
        assert (best - trace <= 1e-9 * best).all()
        assert np.abs(R.transpose(0, 2, 1) @ R - np.eye(3)).max() <= 1e-12
        assert np.abs(np.linalg.det(R) - 1.0).max() <= 1e-12
        assert np.abs(from_quaternions(q) - R).max() <= 1e-12
        # As exact as the maximiser is well-conditioned: its error is rounding divided by the relative gap.
        assert (np.abs(R - best_R).max(axis=(1, 2)) * gap).max() <= 1e-13


def test_fit_lanes_does_not_change_the_answer_by_a_warm_start():
    S = gaussian(np.random.default_rng(9))
    cold, warm = np.tile(EYE, (COUNT, 1)), np.tile(EYE, (COUNT, 1))
    R, again = np.empty((COUNT, 3, 3)), np.empty((COUNT, 3, 3))
    fit_rotations(S, cold, R)
    fit_rotations(S + 1e-2 * gaussian(np.random.default_rng(10)), warm, again)
    fit_rotations(S, warm, again)
    gap = largest_trace(S)[2]
    assert (np.abs(R - again).max(axis=(1, 2)) * gap).max() <= 1e-13


def test_fit_lanes_keeps_the_rotation_it_starts_from_where_all_is_zero():
    q = starts(np.random.default_rng(0), "random")[:100]
    R, before = np.empty((100, 3, 3)), q.copy()
    fit_rotations(np.zeros((100, 3, 3)), q, R)
    assert np.array_equal(q, before)
    assert np.abs(R - from_quaternions(before)).max() <= 1e-12


@pytest.mark.parametrize("scale", [1e-320, 1e-300, 1e300])
def test_fit_lanes_still_gives_a_rotation_at_the_ends_of_the_number_range(scale):
    S = scale * np.random.default_rng(1).uniform(-1, 1, (1000, 3, 3))
    q, R = np.tile(EYE, (1000, 1)), np.empty((1000, 3, 3))
    fit_rotations(S, q, R)
    assert np.abs(R.transpose(0, 2, 1) @ R - np.eye(3)).max() <= 1e-12


def test_fit_lanes_finds_a_rotation_to_be_its_own_nearest():
    expected = random_rotations(np.random.default_rng(2), 1000)
    q, R = np.tile(EYE, (1000, 1)), np.empty((1000, 3, 3))
    fit_rotations(expected.copy(), q, R)
    assert np.abs(R - expected).max() <= 1e-14


def test_fit_lanes_finds_half_turns_from_the_identity():
    """There the gradient vanishes at the start although the trace is at its minimum or a saddle."""
    S = np.array([np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]), np.diag([-1.0, -1, 1])]) * [3.0, 2.0, 1.0]
    q, R = np.tile(EYE, (3, 1)), np.empty((3, 3, 3))
    fit_rotations(S, q, R)
    assert np.abs(R - np.sign(S)).max() <= 1e-14
