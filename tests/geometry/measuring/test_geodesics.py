"""Geodesics against closed forms and an exact algorithm of libigl."""

import igl
import numpy as np
import pytest
from meshes import box, grid, soup, sphere

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.geodesics import geodesic_path, path_length
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions

MIDDLE = (1 / 3, 1 / 3, 1 / 3)


def bumpy(seed=0):
    """A plate with steep hills: shortest paths go around them."""
    V, F = grid(14, 14)
    rng = np.random.default_rng(seed)
    V[:, 2] = sum(3.0 * np.exp(-((V[:, :2] - c) ** 2).sum(axis=1) / 2) for c in rng.uniform(0, 14, (7, 2)))
    return V, F


def tube(n=24, rings=9, radius=2.0, height=5.0):
    """An open tube of n flat strips: unrolled it is a rectangle."""
    V, F = grid(n, rings)
    angle = 2 * np.pi * V[:, 0] / n
    V = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), V[:, 1] / rings * height])
    ids = np.arange(len(V))
    ids[-(rings + 1) :] = ids[: rings + 1]
    return V[: -(rings + 1)], ids[F]


def length(V, F, start, end):
    return path_length(geodesic_path(V, F, start, end))


def test_geodesic_path_is_straight_on_a_plate():
    V, F = grid(5, 4)
    a, b = SurfacePoint(0, MIDDLE), SurfacePoint(33, (0.2, 0.7, 0.1))
    ends = point_positions([a, b], V, F)
    path = geodesic_path(V, F, a, b)
    assert np.allclose(path[[0, -1]], ends)
    assert path_length(path) == pytest.approx(np.linalg.norm(ends[1] - ends[0]), rel=1e-12)


def test_geodesic_path_follows_great_circles_of_a_sphere():
    """The polyhedron inside a sphere is shorter by the square of its edges' length."""
    for subdivisions, share in ((3, 6e-3), (4, 1.5e-3), (5, 4e-4)):
        V, F = sphere(subdivisions)
        for b in (1, 7, 11):
            exact = np.arccos(np.clip(V[0] @ V[b], -1.0, 1.0))
            assert (1 - share) * exact <= length(V, F, 0, b) <= exact


def test_geodesic_path_is_straight_on_an_unrolled_cylinder():
    n, rings, radius, height = 24, 9, 2.0, 5.0
    V, F = tube(n, rings, radius, height)
    strip = 2 * radius * np.sin(np.pi / n)
    for steps, up in ((3, 9), (11, 4), (7, 7)):
        expected = np.hypot(steps * strip, up * height / rings)
        assert length(V, F, 0, steps * (rings + 1) + up) == pytest.approx(expected, rel=1e-12)


def test_geodesic_path_goes_around_the_corner_of_a_box():
    V, F = box(2, 2, 6)
    a, b = (int(np.argmin(np.linalg.norm(V - p, axis=1))) for p in ((1, 0, 3), (2, 1, 5)))
    assert length(V, F, a, b) == pytest.approx(np.hypot(2.0, 2.0), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_geodesic_path_is_as_exact_as_libigl(seed):
    V, F = bumpy(seed)
    none = np.empty(0, dtype=np.int64)
    for a, b in ((0, 224), (14, 210), (3, 221), (112, 40)):
        exact = igl.exact_geodesic(V, F, np.array([a]), none, np.array([b]), none)[0]
        assert length(V, F, a, b) == pytest.approx(exact, rel=1e-9)


def test_geodesic_path_between_inner_points_is_that_of_a_mesh_that_has_them():
    V, F = bumpy()
    a, b = SurfacePoint(20, (0.5, 0.3, 0.2)), SurfacePoint(300, (0.1, 0.1, 0.8))
    W = np.vstack([V, point_positions([a, b], V, F)])
    G = np.delete(F, [20, 300], axis=0)
    for k, face in ((len(V), 20), (len(V) + 1, 300)):
        i, j, m = F[face]
        G = np.vstack([G, [[i, j, k], [j, m, k], [m, i, k]]])
    none = np.empty(0, dtype=np.int64)
    exact = igl.exact_geodesic(W, G, np.array([len(V)]), none, np.array([len(V) + 1]), none)[0]
    assert length(V, F, a, b) == pytest.approx(exact, rel=1e-9)


def test_geodesic_path_is_as_long_after_rigid_motions_and_in_either_order():
    V, F = bumpy(1)
    rotation = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    a, b = SurfacePoint(20, (0.5, 0.3, 0.2)), SurfacePoint(301, MIDDLE)
    moved = V @ rotation.T + [30.0, -4.0, 7.0]
    there = length(V, F, a, b)
    assert length(moved, F, a, b) == pytest.approx(there, rel=1e-9)
    assert length(V, F, b, a) == pytest.approx(there, rel=1e-9)


def test_geodesic_path_is_no_shorter_than_a_line():
    V, F = bumpy(2)
    rng = np.random.default_rng(5)
    for _ in range(8):
        faces, weights = rng.integers(0, len(F), 2), rng.dirichlet([1, 1, 1], 2)
        a, b = (SurfacePoint(int(f), tuple(w)) for f, w in zip(faces, weights, strict=True))
        p, q = point_positions([a, b], V, F)
        assert length(V, F, a, b) >= np.linalg.norm(p - q) * (1 - 1e-12)


def test_geodesic_path_joins_points_on_edges_and_in_one_triangle():
    V, F = grid(4, 4)
    on_edge = SurfacePoint(0, (0.5, 0.5, 0.0))
    far = SurfacePoint(30, (0.0, 0.5, 0.5))
    p, q = point_positions([on_edge, far], V, F)
    assert length(V, F, on_edge, far) == pytest.approx(np.linalg.norm(p - q), rel=1e-9)
    assert length(V, F, SurfacePoint(3, MIDDLE), SurfacePoint(3, (1.0, 0.0, 0.0))) > 0.0
    assert length(V, F, 5, 5) == 0.0


def test_geodesic_path_is_not_hurt_by_flipped_faces_crowded_edges_and_bow_ties():
    V, F = grid(6, 6)
    F = F.copy()
    F[::3] = F[::3, ::-1]
    fin = np.vstack([V, [[3.0, 0.5, 2.0]]])
    crowded = np.vstack([F, [[0, 1, len(V)]]])
    straight = np.linalg.norm(V[48] - V[0])
    assert length(V, F, 0, 48) == pytest.approx(straight, rel=1e-9)
    assert length(fin, crowded, 0, 48) == pytest.approx(straight, rel=1e-9)
    bow_tie = np.array([[0, 1, 2], [2, 3, 4]])
    corners = np.array([[0, 0, 0], [0, 1, 0], [1, 0.5, 0], [2, 1, 0], [2, 0, 0]], dtype=float)
    with pytest.raises(InputError, match=r"joins the points|separate parts"):
        geodesic_path(corners, bow_tie, 0, 3)


def test_geodesic_path_ends_where_lengths_round():
    """A fan far from the origin, whose flips undo each other for ever; no path is shorter than its chord."""
    count, (i, j) = 20_000, (1802, 4827)
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0.1 * np.sin(3 * turn)])
    V, at = np.vstack([[0.0, 0.0, 0.0], rim]) + 1000.0, 1 + np.arange(count)
    F = np.column_stack([0 * at, at, np.roll(at, -1)])
    path = geodesic_path(V, F, i, j)
    chord = np.linalg.norm(V[i] - V[j])
    assert chord * (1.0 - 1e-12) <= path_length(path) < 2.0
    assert np.array_equal(path[[0, -1]], V[[i, j]])


def test_geodesic_path_refuses_separate_parts_in_a_sentence():
    V, F = grid(1, 1)
    two = np.vstack([V, V + [5.0, 0.0, 0.0]])
    with pytest.raises(InputError, match="separate parts"):
        geodesic_path(two, np.vstack([F, F + 4]), 0, 5)


def test_geodesic_path_crosses_the_seams_of_a_soup():
    V, F = box(2, 2, 2)
    W, G = soup(V, F)
    far = np.flatnonzero((W == 2.0).all(axis=1))
    start = np.flatnonzero((W == 0.0).all(axis=1))[0]
    assert path_length(geodesic_path(W, G, int(start), int(far[-1]))) == pytest.approx(20**0.5)
