"""Pictures drawn in memory: of each pixel the nearest triangle, whatever the order and the place."""

import meshes
import numpy as np
import pytest

from apd_viewer.presentation import shape_picture as module
from apd_viewer.presentation.shape_picture import fragments, nearest_triangles, shape_picture

GREY = (200, 200, 200)


def spread(count, seed=0):
    """Triangles anywhere in a square of 24 x 24 pixels, (3 * count, 3) and (count, 3)."""
    X = np.random.default_rng(seed).uniform(0.0, 24.0, (3 * count, 3))
    return X, np.arange(3 * count).reshape(-1, 3)


def by_rays(X, F, width, height):
    """The same as nearest_triangles, a pixel and a triangle after the other."""
    found = np.full(width * height, -1)
    for pixel in range(width * height):
        p, best = np.array([pixel % width + 0.5, pixel // width + 0.5]), -np.inf
        for triangle, (a, b, c) in enumerate(X[F]):
            M = np.column_stack([b[:2] - a[:2], c[:2] - a[:2]])
            u, v = np.linalg.solve(M, p - a[:2])
            depth = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
            if min(u, v, 1.0 - u - v) >= 0.0 and depth > best:
                found[pixel], best = triangle, depth
    return found


def test_nearest_triangles_are_those_of_each_pixel():
    X, F = spread(40)
    found = nearest_triangles(X, F, 24, 24)
    assert len(np.unique(found)) > 10, "the test is blind"
    np.testing.assert_array_equal(found, by_rays(X, F, 24, 24))


def test_nearest_triangles_hide_none_of_so_many_that_they_come_in_portions():
    """Between the ones that cover pixels lie a million that are points."""
    X, F = spread(40)
    points = np.zeros((25_000, 3), dtype=int)
    many = np.concatenate([np.vstack([triangle[None], points]) for triangle in F])
    found = nearest_triangles(X, many, 24, 24)
    expected = by_rays(X, F, 24, 24)
    np.testing.assert_array_equal(found, np.where(expected < 0, -1, expected * (len(points) + 1)))


@pytest.mark.parametrize("side", [8, 1024])
def test_fragments_of_triangles_with_a_common_edge_share_no_pixel(side):
    """A square whose corners are on the middles of pixels, divided in two ways, is covered just once.

    The pixels of the larger one come in portions.
    """
    X = 0.5 + side * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]])
    for F in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]):
        pixels = np.concatenate([pixel for pixel, _, _ in fragments(X[np.array(F)], side + 2)])
        expected = np.arange(side)[:, None] * (side + 2) + np.arange(side)
        np.testing.assert_array_equal(np.sort(pixels), expected.ravel())


def test_shape_picture_does_not_depend_on_order_place_or_unit():
    V, F = meshes.sphere(2)
    V = V * [1.0, 2.0, 0.5]
    picture = shape_picture([V], F, [GREY], 64)
    assert picture.shape[0] == 64
    order = np.random.default_rng(1).permutation(len(F))
    for U, G in ((V, F[order]), (4.0 * V + [16.0, -8.0, 2.0], F), (V, F[:, ::-1])):
        other = shape_picture([U], G, [GREY], 64)
        assert np.abs(other.astype(int) - picture).max() <= 1


def test_shape_picture_from_elsewhere_is_that_of_the_shape_turned():
    V, F = meshes.box(1, 2, 3)
    R = meshes.rotation((1, 2, 3), 0.7)
    look, up = np.array([0.55, 0.28, 1.0]), np.array([0.0, 1.0, 0.0])
    there = shape_picture([V @ R.T], F, [GREY], 64, tuple(R @ look), tuple(R @ up))
    here = shape_picture([V], F, [GREY], 64, tuple(look), tuple(up))
    differ = np.abs(there.astype(int) - here).max(axis=2) > 2
    assert differ.mean() < 0.01  # pixels whose middle is on an edge


def test_shape_picture_of_a_sphere_covers_a_disc_and_is_lit():
    V, F = meshes.sphere(3)
    picture = shape_picture([V], F, [GREY], 128)
    covered = picture[..., 3].sum() / 255.0
    assert covered == pytest.approx(np.pi / 4 * (128 * 0.96) ** 2, rel=0.01)
    assert picture[..., 3].max() == 255
    assert picture[picture[..., 3] == 0].sum() == 0
    bright, dark = picture[50, 50, :3], picture[105, 85, :3]
    assert 200 >= bright.min() > dark.max() + 40


def test_shape_picture_hides_what_is_behind_what_is_in_front():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    V, F = np.vstack([square, square - [0, 0, 1]]), np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    colors = np.array([[255, 0, 0]] * 2 + [[0, 0, 255]] * 2, dtype=np.uint8)
    red = shape_picture([V], F, [colors], 32, view_direction=(0, 0, 1))[16, 16]
    blue = shape_picture([V], F, [colors], 32, view_direction=(0, 0, -1))[16, 16]
    assert red[0] > 200 > red[2] == 0
    assert blue[2] > 200 > blue[0] == 0


def test_shape_picture_has_one_scale_for_shapes_side_by_side():
    V, F = meshes.sphere(2)
    pair = shape_picture([V, 0.5 * V], F, [GREY, GREY], 64)
    left, right = np.hsplit(pair, 2)
    assert left.shape == (64, 64, 4)
    assert (right[..., 3] > 0).sum() == pytest.approx((left[..., 3] > 0).sum() / 4, rel=0.1)


def test_nearest_triangles_bound_the_work_on_a_heap_of_large_ones(monkeypatch):
    """Twelve layers of them are enough."""
    X, F = spread(5000)
    drawn = []

    def counted(corners, width):
        for part in fragments(corners, width):
            drawn.append(len(part[0]))
            yield part

    monkeypatch.setattr(module, "fragments", counted)
    nearest_triangles(X, F, 24, 24)
    most = 12 * 24 * 24
    assert 0 < sum(drawn) < 1.2 * most < sum(len(pixel) for pixel, _, _ in fragments(X[F], 24))


@pytest.mark.parametrize("V", [np.zeros((3, 3)), np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]])])
def test_shape_picture_of_a_shape_without_area_is_nothing(V):
    picture = shape_picture([V], np.array([[0, 1, 2]]), [GREY], 32)
    assert picture[..., 3].sum() == 0
