"""Sections against closed forms."""

import numpy as np
import pytest
from meshes import box, grid, soup, sphere

from apd_viewer.geometry.measuring.sections import plane_section


def prism(n=40, radius=1.5, height=3.0):
    """A closed prism over a regular polygon."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    V = np.vstack([np.column_stack([ring, np.full(n, z)]) for z in (0.0, height)])
    V = np.vstack([V, [[0, 0, 0], [0, 0, height]]])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    sides = np.vstack([np.column_stack([i, j, j + n]), np.column_stack([i, j + n, i + n])])
    floor, roof = np.column_stack([j, i, 0 * i + 2 * n]), np.column_stack([i + n, j + n, 0 * i + 2 * n + 1])
    return V, np.vstack([sides, floor, roof])


def test_plane_section_of_a_box_has_its_length_and_area_in_any_direction():
    V, F = box(2, 3, 4)
    for axis, (a, b) in enumerate(((3, 4), (2, 4), (2, 3))):
        normal = 5.0 * np.eye(3)[axis]
        for at in (0.5, 1.0):  # between vertices, and through them
            cut = plane_section(V, F, at * np.eye(3)[axis], normal)
            assert (cut.contours, cut.length, cut.area) == (
                1,
                pytest.approx(2 * (a + b)),
                pytest.approx(a * b),
            )
    slanted = plane_section(V, F, np.array([1.0, 1.5, 2.0]), np.array([1.0, 0.0, 1.0]))
    assert slanted.area == pytest.approx(2 * 2**0.5 * 3)
    assert slanted.length == pytest.approx(2 * (3 + 2 * 2**0.5))


def test_plane_section_of_a_cylinder_has_its_length_and_area():
    n, radius = 40, 1.5
    V, F = prism(n, radius)
    cut = plane_section(V, F, np.array([0.0, 0.0, 1.1]), np.array([0.0, 0.0, -1.0]))
    assert cut.length == pytest.approx(2 * n * radius * np.sin(np.pi / n))
    assert cut.area == pytest.approx(0.5 * n * radius**2 * np.sin(2 * np.pi / n))
    assert (V[F[cut.faces], 2].max(axis=1) >= 1.1).all()


def test_plane_section_of_a_sphere_has_its_length_and_area():
    V, F = sphere(4)
    for height in (0.0, 0.3, 0.8):
        radius = (1 - height**2) ** 0.5
        cut = plane_section(V, F, np.array([0.0, height, 0.0]), np.array([0.0, 1.0, 0.0]))
        assert cut.length == pytest.approx(2 * np.pi * radius, rel=6e-3)
        assert cut.area == pytest.approx(np.pi * radius**2, rel=1e-2)


def test_plane_section_counts_several_contours_and_leaves_out_a_cavity():
    V, F = box(1, 1, 1)
    W = np.vstack([V, V + [3.0, 0.0, 0.0], 4 * V + [10.0, -2.0, -2.0], V + [11.0, 0.0, 0.0]])
    G = np.vstack([F, F + 8, F + 16, F[:, ::-1] + 24])
    cut = plane_section(W, G, np.array([0.0, 0.0, 0.5]), np.array([0.0, 0.0, 1.0]))
    assert (cut.contours, cut.length) == (4, pytest.approx(4 + 4 + 16 + 4))
    assert cut.area == pytest.approx(1 + 1 + 16 - 1)


def test_plane_section_of_open_and_flipped_surfaces_has_a_length_only():
    V, F = grid(4, 4)
    across = plane_section(V, F, np.array([1.3, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    assert (across.contours, across.length) == (1, pytest.approx(4.0))
    assert np.isnan(across.area)
    V, F = box(2, 2, 2)
    sides = V[F][:, :, 2].min(axis=1) < V[F][:, :, 2].max(axis=1)
    F = F.copy()
    first = np.flatnonzero(sides)[0]
    F[first] = F[first, ::-1]
    height = V[F[first], 2].min() + 0.5
    cut = plane_section(V, F, np.array([0.0, 0.0, height]), np.array([0.0, 0.0, 1.0]))
    assert cut.length == pytest.approx(8.0)
    assert np.isnan(cut.area)


def test_plane_section_beside_the_surface_is_nothing():
    cut = plane_section(*box(1, 1, 1), np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, 1.0]))
    assert (cut.contours, cut.length, cut.area, len(cut.segments)) == (0, 0.0, 0.0, 0)


def test_plane_section_does_not_change_by_rigid_motions():
    V, F = sphere(2)
    rotation = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    point, normal, shift = np.array([0.1, 0.2, 0.3]), np.array([1.0, 2.0, -1.0]), np.array([5.0, -20.0, 3.0])
    here = plane_section(V, F, point, normal)
    there = plane_section(V @ rotation.T + shift, F, rotation @ point + shift, rotation @ normal)
    assert there.length == pytest.approx(here.length)
    assert there.area == pytest.approx(here.area)


def test_plane_section_has_the_volume_below_where_the_surface_is_closed_there():
    V, F = box(2, 3, 4)
    at, up = np.array([0.0, 0.0, 1.5]), np.array([0.0, 0.0, 1.0])
    assert plane_section(V, F, at, up).volume_below == pytest.approx(2 * 3 * 1.5)
    assert plane_section(V, F, at, -up).volume_below == pytest.approx(2 * 3 * 2.5)
    assert plane_section(V, F[:, ::-1], at, up).volume_below == pytest.approx(2 * 3 * 1.5)
    assert plane_section(V, F, 9 * up, up).volume_below == pytest.approx(24.0)
    assert plane_section(V, F, -9 * up, up).volume_below == 0.0
    lidless = F[~(V[F][:, :, 2] == 4).all(axis=1)]
    assert plane_section(V, lidless, at, up).volume_below == pytest.approx(2 * 3 * 1.5)
    assert np.isnan(plane_section(V, lidless, at, -up).volume_below)
    flipped = F.copy()
    flipped[0] = flipped[0][::-1]
    assert np.isnan([plane_section(V, flipped, at, way).volume_below for way in (up, -up)]).any()


def test_plane_section_joins_the_triangles_of_a_soup():
    V, F = box(2, 2, 2)
    whole, loose = (plane_section(*mesh, (1, 1, 0.5), (0, 0, 1)) for mesh in ((V, F), soup(V, F)))
    assert loose.contours == whole.contours == 1
    assert (loose.length, loose.area, loose.volume_below) == pytest.approx((8, 4, 2))


def test_plane_section_leaves_out_faces_with_a_corner_twice():
    V = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 2], [0, 1, 2.0]])
    cut = plane_section(V, np.array([[0, 1, 1], [1, 2, 3]]), (0, 0, 0.5), (0, 0, 1))
    assert (cut.contours, cut.length, len(cut.faces)) == (0, 0.0, 0)
