"""Distances of vertices, triangles and edges: against exact arithmetic and another library."""

from fractions import Fraction
from itertools import combinations

import ipctk
import numpy as np
import pytest
from meshes import rotation

from apd_viewer.geometry.contact.distances import edge_edge, gap, gaps, vertex_triangle

PAIR = np.arange(4)


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def on_segment(p, a, b):
    """Squared distance of a point from a segment, in rational numbers."""
    u, r = minus(b, a), minus(p, a)
    length = dot(u, u)
    t = min(max(dot(u, r) / length, Fraction(0)), Fraction(1)) if length else Fraction(0)
    away = minus(r, [t * x for x in u])
    return dot(away, away)


def nearest_within(r, u, v, within):
    """Squared length of ``r - s u - t v`` at its minimum, if that is ``within``; else none."""
    uu, vv, uv, ur, vr = dot(u, u), dot(v, v), dot(u, v), dot(u, r), dot(v, r)
    across = uu * vv - uv * uv
    if across == 0:
        return []
    s, t = (vv * ur - uv * vr) / across, (uu * vr - uv * ur) / across
    if not within(s, t):
        return []
    away = [x - s * y - t * z for x, y, z in zip(r, u, v, strict=True)]
    return [dot(away, away)]


def exact(X, edges):
    """The distance in exact arithmetic, rounded once."""
    a, b, c, d = ([Fraction(float(x)) for x in p] for p in X)
    if edges:
        found = [on_segment(a, c, d), on_segment(b, c, d), on_segment(c, a, b), on_segment(d, a, b)]
        found += nearest_within(
            minus(c, a), minus(b, a), minus(c, d), lambda s, t: 0 <= s <= 1 and 0 <= t <= 1
        )
    else:
        found = [on_segment(a, *ends) for ends in combinations((b, c, d), 2)]
        found += nearest_within(
            minus(a, b), minus(c, b), minus(d, b), lambda s, t: s >= 0 and t >= 0 and s + t <= 1
        )
    return float(min(found)) ** 0.5


def spread(rng):
    """Four points anywhere."""
    return rng.normal(size=(4, 3))


def needle(rng):
    """A needle, or two edges nearly in line, and something near its middle."""
    X = rng.normal(size=(4, 3))
    X[3] = X[2] + 10.0 ** rng.uniform(-12, -2) * rng.normal(size=3)
    X[0] = X[1:].mean(axis=0) + 10.0 ** rng.uniform(-6, 0) * rng.normal(size=3)
    return X


def sliver(rng):
    """Three points nearly on a line, one between the others."""
    X = rng.normal(size=(4, 3))
    X[3] = X[1] + rng.uniform(0, 1) * (X[2] - X[1]) + 10.0 ** rng.uniform(-12, -2) * rng.normal(size=3)
    X[0] = rng.dirichlet(np.ones(3)) @ X[1:] + 10.0 ** rng.uniform(-6, 0) * rng.normal(size=3)
    return X[rng.permutation(4)] if rng.random() < 0.3 else X


def nearly_parallel(rng):
    """Two edges nearly parallel that cross one above the other."""
    along, angle = rng.normal(size=3), 10.0 ** rng.uniform(-9, -1)
    across = np.cross(along, rng.normal(size=3))
    up = np.cross(along, across)
    above = 10.0 ** rng.uniform(-7, -1) * up / np.linalg.norm(up)
    other = along + angle * across
    s, t = rng.uniform(-0.2, 1.2, 2)
    return np.array([-s * along, (1 - s) * along, above - t * other, above + (1 - t) * other])


def parallel(rng):
    """Two parallel edges, beside each other or one behind the other."""
    along, shift = rng.normal(size=3), rng.normal(size=3) * 10.0 ** rng.uniform(-4, 0)
    return np.array([0 * along, along, shift, shift + rng.uniform(-2, 2) * along])


def coincident(rng):
    """Points some of which are the same."""
    X = rng.normal(size=(4, 3))
    X[rng.integers(4)] = X[rng.integers(4)]
    X[rng.integers(4)] = X[rng.integers(4)]
    return X


def without_area(rng):
    """A triangle whose corners are on a line, or an edge that is a point."""
    X = rng.integers(-3, 4, (4, 3)).astype(float)
    X[3] = 2 * X[2] - X[1]
    return X


KINDS = (spread, needle, sliver, nearly_parallel, parallel, coincident, without_area)


@pytest.mark.parametrize("edges", [False, True], ids=["vertex-triangle", "edge-edge"])
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_gap_is_the_distance_of_exact_arithmetic(kind, edges):
    rng = np.random.default_rng(7)
    for _ in range(100):
        X = kind(rng)
        size = np.ptp(X, axis=0).max() + 1e-300
        assert abs(gap(X, PAIR, edges)[0] - exact(X, edges)) <= 2e-8 * size


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("edges", [False, True])
def test_gap_grows_with_the_mesh(edges, scale):
    rng = np.random.default_rng(8)
    for kind in KINDS:
        X = kind(rng)
        away = gap(X, PAIR, edges)[0]
        assert gap(scale * X, PAIR, edges)[0] == pytest.approx(scale * away, rel=1e-7, abs=1e-8 * scale)


@pytest.mark.parametrize("edges", [False, True])
def test_gap_far_from_the_origin_misses_by_no_more_than_the_rounding_of_the_coordinates(edges):
    rng = np.random.default_rng(9)
    for _ in range(100):
        X = spread(rng) + np.array([1e5, -3e5, 2e5])
        assert gap(X, PAIR, edges)[0] == pytest.approx(exact(X, edges), abs=1e-12)


@pytest.mark.parametrize("edges", [False, True])
def test_gap_weights_say_where_the_parts_are_nearest(edges):
    rng = np.random.default_rng(10)
    for kind in KINDS:
        for _ in range(100):
            X = kind(rng)
            d, *w = gap(X, PAIR, edges)
            w = np.array(w)
            first = 2 if edges else 1
            assert w[:first].sum() == pytest.approx(1.0, abs=1e-15)
            assert w[first:].sum() == pytest.approx(-1.0, abs=1e-15)
            assert (w[:first] >= 0).all()
            assert (w[first:] <= 0).all()
            size = np.ptp(X, axis=0).max() + 1e-300
            assert np.linalg.norm(w @ X) == pytest.approx(d, rel=1e-9, abs=1e-14 * size)


def test_vertex_triangle_and_edge_edge_agree_with_another_library():
    rng = np.random.default_rng(11)
    for _ in range(100):
        X = rng.normal(size=(4, 3))
        assert vertex_triangle(X, *PAIR)[0] == pytest.approx(ipctk.point_triangle_distance(*X), rel=1e-9)
        assert edge_edge(X, *PAIR)[0] == pytest.approx(ipctk.edge_edge_distance(*X), rel=1e-9)


def test_gaps_are_unchanged_by_a_rigid_motion_and_the_order_of_the_parts():
    rng = np.random.default_rng(12)
    X, R = rng.normal(size=(40, 3)), rotation([1.0, 2.0, -1.0], 1.1)
    pairs = np.array([rng.permutation(40)[:4] for _ in range(200)])
    edges = rng.random(200) < 0.5
    found = gaps(X, pairs, edges)
    assert np.allclose(gaps(X @ R.T + 3.0, pairs, edges), found, rtol=1e-10, atol=1e-14)
    other = np.where(edges[:, None], pairs[:, [3, 2, 0, 1]], pairs[:, [0, 3, 1, 2]])
    assert np.allclose(gaps(X, other, edges), found, rtol=1e-12, atol=1e-14)
