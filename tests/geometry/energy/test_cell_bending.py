"""The bending of the cells of Eq. 1 against their energy on exact cylinders."""

import numpy as np
import pytest
from meshes import grid, tube
from scipy.spatial import Delaunay

from apd_viewer.geometry.energy.cell_bending import cell_stiffness, load_excess
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.membrane import Membrane
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.methods import METHODS

SQUARE = 1.0


def rows(count, height, jitter=0.0):
    """Sheet in rows of triangles, ``height`` of an equilateral one's, or irregular."""
    h, k = SQUARE / count, np.arange(count + 1)
    x, y = np.meshgrid(k * h, k * h * height * 0.75**0.5)
    x = x + 0.5 * h * (k % 2)[:, None]
    X = np.column_stack([x.ravel(), y.ravel()])
    if jitter:
        X += np.random.default_rng(1).uniform(-jitter, jitter, X.shape) * h
        # Needles along the border are no sheet of any use.
        F = Delaunay(X).simplices
        F = F[(cotangents_of(X, F) > -2.0).all(axis=1)]
    else:
        F = Delaunay(X).simplices
    V = np.column_stack([X, np.zeros(len(X))])
    return V, F


def cotangents_of(X, F):
    sides = [X[F[:, (c + 1) % 3]] - X[F[:, c]] for c in range(3)]
    cross = np.abs(sides[0][:, 0] * sides[1][:, 1] - sides[0][:, 1] * sides[1][:, 0])
    dots = [-(sides[c] * sides[c - 1]).sum(axis=1) for c in range(3)]
    return np.stack(dots, axis=1) / cross[:, None]


SHEETS = {
    "equilateral": lambda count: rows(count, 1.0),
    "flattened": lambda count: rows(count, 0.66),
    "squares": lambda count: grid(count, count, SQUARE / count, SQUARE / count),
    "oblongs": lambda count: grid(count, count, SQUARE / count, 2.0 * SQUARE / count),
    "irregular": lambda count: rows(count, 1.0, 0.3),
}


def rolled(V, turn, curvature):
    """The sheet on a cylinder, without any stretch, bent along a direction."""
    x, y = V[:, 0] * np.cos(turn) + V[:, 1] * np.sin(turn), V[:, 1] * np.cos(turn) - V[:, 0] * np.sin(turn)
    return np.column_stack([np.sin(curvature * x), curvature * y, 1.0 - np.cos(curvature * x)]) / curvature


def bending_stiffness(V, F, curvature=0.1):
    """Of the cells: their energy less that of their strain, over ``A k^2``, mean of eight directions."""
    mesh, area = SolveMesh(V, F), face_areas(V, F).sum()
    strain, found = Membrane(V, mesh.all_triangles, 2.0, 0.0), []
    for turn in np.arange(8) * np.pi / 8.0:
        U = rolled(V, turn, curvature)
        strain.local_step(U)
        found.append((mesh.energy(U) - strain.energy) / (area * curvature) ** 2)
    return np.mean(found)


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize("count", [12, 24])
def test_cell_stiffness_is_what_the_cells_need_to_be_bent(sheet, count):
    V, F = SHEETS[sheet](count)
    assert cell_stiffness(V, F) == pytest.approx(bending_stiffness(V, F), rel=2e-3)


@pytest.mark.parametrize("sheet", SHEETS)
def test_cell_stiffness_is_the_same_of_a_sheet_turned_in_space_and_scaled(sheet):
    V, F = SHEETS[sheet](12)
    Q = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    assert cell_stiffness(30.0 * V @ Q.T + 5.0, F) == pytest.approx(cell_stiffness(V, F), rel=1e-9)


@pytest.mark.parametrize("around", [40, 80])
def test_cell_stiffness_of_equilateral_triangles_is_by_three_quarters_of_the_squared_edge(around):
    """D = 2 stiffness area = 0.75 h^2 on a tube whose ends are a few rows of many."""
    V, F = tube(around, round(3.0 * around / (2.0 * np.pi) / 0.75**0.5), height=3.0)
    rigidity = 2.0 * cell_stiffness(V, F) * face_areas(V, F).sum()
    assert rigidity == pytest.approx(0.75 * (2.0 * np.pi / around) ** 2, rel=0.03)


def test_load_excess_is_the_stiffness_of_the_cells_over_that_asked_for():
    exact, local = (METHODS[name].material(0.002, 20.0, 0.1) for name in ("exact", "local"))
    assert load_excess(exact, 0.001) == pytest.approx(0.5)
    assert load_excess(local, 0.001) == pytest.approx(0.05), "its cells have a tenth of the weight"
    assert load_excess(Material(), 0.001) is None
