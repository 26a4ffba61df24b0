"""Linear buckling analysis: against Euler's strip and the classical cylinder."""

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.solver.linear_buckling import classical_load

STRIP = meshes.grid(10, 40, 0.025, 0.025)


def test_buckling_modes_of_a_strip_are_those_of_euler():
    """The lowest is half a sine wave; the plates have closed by load times length over E t width then."""
    V, F = STRIP
    thickness, width, length = 0.01, *np.ptp(V[:, :2], axis=0)
    rigidity = Material(thickness=thickness).plate_rigidity
    modes = apd_viewer.buckling_modes(V, F, (0, 1, 0), thickness, poisson=0.0, held=True)
    assert modes.loads[0] == pytest.approx(np.pi**2 * rigidity * width / length**2, rel=0.01)
    assert modes.deflections[0] == pytest.approx(modes.loads[0] * length / (4.0 * width), rel=1e-3)
    wave = np.sin(np.pi * (V[:, 1] - V[:, 1].min()) / length)
    assert abs(modes.shapes[0, :, 2]) == pytest.approx(wave, abs=0.01)
    assert np.all(np.diff(modes.loads) >= 0.0)


@pytest.mark.parametrize(("poisson", "held"), [(0.0, True), (0.3, True)])
def test_buckling_modes_of_a_cylinder_begin_at_the_classical_load(poisson, held):
    V, F = meshes.tube(80, 40, height=2.0)
    wall = Material(thickness=0.03, poisson=poisson)
    modes = apd_viewer.buckling_modes(V, F, (0, 0, 1), 0.03, 2, poisson=poisson, held=held)
    assert modes.loads == pytest.approx(classical_load(wall), rel=0.03)


def test_buckling_modes_of_a_tube_with_sliding_ends_begin_at_half_the_classical_load():
    """Its rims bend in and out freely, and there it buckles first."""
    V, F = meshes.tube(80, 40, height=2.0)
    wall = Material(thickness=0.03, poisson=0.3)
    modes = apd_viewer.buckling_modes(V, F, (0, 0, 1), 0.03, 2, poisson=0.3)
    assert 0.4 < modes.loads[0] / classical_load(wall) < 0.6
    away = np.linalg.norm(modes.shapes[0], axis=1)
    assert abs(V[away > 0.9, 2] - 1.0).min() > 0.7


def test_buckling_modes_turn_and_move_with_the_mesh():
    V, F = STRIP
    R, shift = meshes.rotation((1, 2, 3), 0.7), np.array([30.0, -20.0, 10.0])
    plain = apd_viewer.buckling_modes(V, F, (0, 1, 0), 0.01, 1, held=True)
    moved = apd_viewer.buckling_modes(V @ R.T + shift, F, R @ (0, 1, 0), 0.01, 1, held=True)
    assert moved.loads == pytest.approx(plain.loads, rel=1e-4)
    turned = plain.shapes[0] @ R.T
    assert abs(np.einsum("ij,ij->", moved.shapes[0], turned)) == pytest.approx((turned**2).sum(), rel=1e-3)


def test_buckling_modes_keep_the_sides_of_a_seam_together_and_loose_vertices_at_rest():
    V, F = STRIP
    X, triangles = meshes.soup(V, F)
    X = np.vstack([X, [[0.0, 5.0, 0.0]]])
    welded = apd_viewer.buckling_modes(X, triangles, (0, 1, 0), 0.01, 1, held=True, weld=True)
    plain = apd_viewer.buckling_modes(V, F, (0, 1, 0), 0.01, 1, held=True)
    assert welded.loads == pytest.approx(plain.loads, rel=1e-4)
    corners = welded.shapes[0][triangles].reshape(-1, 3)
    assert abs(abs(corners) - abs(plain.shapes[0][F].reshape(-1, 3))).max() < 1e-4
    sides = np.sort(F.ravel(), kind="stable"), np.argsort(F.ravel(), kind="stable")
    joined = np.flatnonzero(np.diff(sides[0]) == 0)
    assert np.array_equal(corners[sides[1][joined]], corners[sides[1][joined + 1]])
    assert not welded.shapes[0, -1].any()


def test_buckling_modes_of_a_wall_distribution_buckle_where_it_is_thin():
    """A strip of half the thickness over half its length carries less than a whole one, and more than
    one as thin everywhere."""
    V, F = STRIP
    thickness = np.where(V[F].mean(axis=1)[:, 1] < V[:, 1].mean(), 0.005, 0.01)

    def force(given, mean):
        """Per Young's modulus: loads are of a wall as stiff as 4 on average."""
        return apd_viewer.buckling_modes(V, F, (0, 1, 0), given, 1, held=True, poisson=0.0).loads[0] * mean

    thin, thick = force(0.005, 0.005), force(0.01, 0.01)
    assert 1.1 * thin < force(thickness, 0.0075) < 0.5 * thick


def test_buckling_modes_of_a_flat_mesh_across_are_refused():
    with pytest.raises(InputError, match="flat along this direction"):
        apd_viewer.buckling_modes(*STRIP, (0, 0, 1), 0.01)
