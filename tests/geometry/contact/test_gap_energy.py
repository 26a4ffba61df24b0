"""Energy of gaps: its derivatives by differences, and the laws of forces within a body."""

import numpy as np
import pytest

from apd_viewer.geometry.contact.distances import gap, gaps
from apd_viewer.geometry.contact.gap_energy import (
    gap_curvature,
    gap_energy,
    gap_gradient,
    gap_slope,
    gap_springs,
)

RANGE = 0.02


def some_pairs(seed=3, count=200, size=1.0):
    """Points, pairs of both kinds among them, and ranges that most of their gaps are within."""
    rng = np.random.default_rng(seed)
    U = size * rng.normal(size=(60, 3))
    pairs = np.array([rng.permutation(60)[:4] for _ in range(count)])
    edges = rng.random(count) < 0.5
    return U, pairs, edges, gaps(U, pairs, edges) * rng.uniform(0.8, 4.0, count)


def energy(U, pairs, edges, reach):
    found = gaps(U, pairs, edges)
    return sum(gap_energy(d, h) for d, h in zip(found, reach, strict=True) if d < h)


@pytest.mark.parametrize("s", [1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999])
def test_gap_slope_and_curvature_are_those_of_differences(s):
    d, step = s * RANGE, 1e-6 * s * RANGE
    slope = (gap_energy(d + step, RANGE) - gap_energy(d - step, RANGE)) / (2 * step)
    curvature = (gap_slope(d + step, RANGE) - gap_slope(d - step, RANGE)) / (2 * step)
    assert gap_slope(d, RANGE) == pytest.approx(slope, rel=1e-5, abs=1e-7 * RANGE)
    assert gap_curvature(d, RANGE) == pytest.approx(curvature, rel=1e-5, abs=1e-7)


def test_gap_energy_is_positive_falls_and_ends_twice_continuous_at_its_range():
    d = np.linspace(1e-9, 1.0, 500) * RANGE
    found = np.array([gap_energy(x, RANGE) for x in d])
    assert (np.diff(found) < 0).all()
    assert (found[:-1] > 0).all()
    for derivative, unit in ((gap_energy, RANGE**2), (gap_slope, RANGE), (gap_curvature, 1.0)):
        assert derivative(RANGE, RANGE) == 0.0
        assert abs(derivative(RANGE * (1 - 1e-7), RANGE)) < 1e-5 * unit


def test_gap_energy_grows_without_bound_where_a_gap_closes():
    assert gap_slope(1e-9 * RANGE, RANGE) < -1e8 * RANGE
    for derivative in (gap_energy, gap_slope, gap_curvature):
        assert np.isfinite(derivative(0.0, RANGE))


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_gap_energy_is_that_of_a_spring_per_unit_of_length(scale):
    assert gap_energy(0.3 * scale * RANGE, scale * RANGE) == pytest.approx(
        scale**2 * gap_energy(0.3 * RANGE, RANGE), rel=1e-12
    )


def test_gap_gradient_is_that_of_differences():
    U, pairs, edges, reach = some_pairs()
    g, touching, least = gap_gradient(U, pairs, edges, np.zeros(len(pairs)), reach, 0.0)
    found = gaps(U, pairs, edges)
    assert touching == (found < reach).sum()
    assert least == found[found < reach].min()
    rng = np.random.default_rng(4)
    for _ in range(10):
        way = rng.normal(size=U.shape)
        step = 1e-6
        there, back = (energy(U + s * way, pairs, edges, reach) for s in (step, -step))
        assert (g * way).sum() == pytest.approx((there - back) / (2 * step), rel=1e-5)


def test_gap_gradient_has_forces_within_a_surface_sum_to_none_and_turn_nothing():
    U, pairs, edges, reach = some_pairs()
    g, *_ = gap_gradient(U, pairs, edges, np.zeros(len(pairs)), reach, 0.0)
    size = np.abs(g).sum()
    assert np.abs(g.sum(axis=0)).max() <= 1e-13 * size
    assert np.abs(np.cross(U, g).sum(axis=0)).max() <= 1e-12 * size


def test_gap_gradient_takes_a_bound_above_the_range_at_its_word():
    U, pairs, edges, reach = some_pairs()
    low = np.where(np.arange(len(pairs)) % 2 == 0, reach, 0.0)
    some = low < reach
    g, touching, _ = gap_gradient(U, pairs, edges, low, reach, 0.0)
    alone, few, _ = gap_gradient(U, pairs[some], edges[some], low[some], reach[some], 0.0)
    assert np.array_equal(g, alone)
    assert touching == few > 0


def test_gap_springs_have_the_curvature_along_the_gap():
    U, pairs, edges, reach = some_pairs()
    k, w = gap_springs(U, pairs, edges, reach, np.inf, 0.0)
    found = gaps(U, pairs, edges)
    assert (k[found >= reach] == 0.0).all()
    for p in np.flatnonzero(found < reach)[:40]:
        X, step = U[pairs[p]], 1e-4 * found[p]
        normal, one = w[p] @ X / found[p], (np.arange(4) < (2 if edges[p] else 1))[:, None]
        there, here, back = (
            gap_energy(gap(X + s * one * normal, np.arange(4), edges[p])[0], reach[p])
            for s in (step, 0.0, -step)
        )
        assert k[p] == pytest.approx((there - 2 * here + back) / step**2, rel=1e-3, abs=1e-3)
    assert gap_springs(U, pairs, edges, reach, 0.5, 0.0)[0].max() == 0.5
