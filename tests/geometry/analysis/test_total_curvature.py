"""Total curvature against the theorem of Gauss and Bonnet."""

import numpy as np
import pytest
from meshes import box, cup, grid, sphere, tube
from scipy.spatial import Delaunay

from apd_viewer.geometry.mesh.operators import total_curvature


def irregular_half_tube(off, jitter=0.4):
    """Points on a cylinder, or a little ``off`` it, irregularly triangulated."""
    rng, k = np.random.default_rng(2), 25
    x, y = np.meshgrid(np.linspace(0.0, 3.0, k), np.linspace(0.0, 3.0, k))
    inside = np.zeros((k, k), dtype=bool)
    inside[1:-1, 1:-1] = True
    X = np.column_stack([x.ravel(), y.ravel()])
    X += np.where(inside.ravel()[:, None], rng.uniform(-jitter, jitter, X.shape) * 3.0 / k, 0.0)
    r = 1.0 + off * rng.normal(size=len(X))
    return np.column_stack([r * np.cos(X[:, 0]), r * np.sin(X[:, 0]), X[:, 1]]), Delaunay(X).simplices


def cone():
    angle, height = (x.ravel() for x in np.meshgrid(np.arange(24) * np.pi / 12, np.arange(1, 8)))
    V = np.column_stack([height * np.cos(angle), height * np.sin(angle), height])
    _, F = tube(24, 6)
    return V, F


@pytest.mark.parametrize("convex", [sphere(2), sphere(3), box(3, 4, 5)])
def test_total_curvature_of_convex_surfaces_is_that_of_a_sphere(convex):
    assert total_curvature(*convex) == pytest.approx(4.0 * np.pi, rel=1e-9)


def test_total_curvature_of_half_a_sphere_is_half():
    V, F = sphere(4)
    assert total_curvature(V, F[(V[F, 2] > -1e-9).all(axis=1)]) == pytest.approx(2.0 * np.pi, rel=0.06)


@pytest.mark.parametrize("unrolls", [grid(), tube(), tube(30, 9, shear=0.4), cone()])
def test_total_curvature_of_what_can_be_unrolled_is_none(unrolls):
    assert total_curvature(*unrolls) < 1e-9


@pytest.mark.parametrize("off", [0.0, 0.001, 0.003])
def test_total_curvature_of_noise_of_both_signs_is_none(off):
    assert total_curvature(*irregular_half_tube(off)) < 0.5


def test_total_curvature_of_bulges_is_not_taken_away_by_hollows():
    V, F = cup()
    assert total_curvature(V, F) >= 4.0 * np.pi - 1e-9
