"""Energy of a thin wall against closed forms, and its derivatives against differences."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import grid, rotation, sphere, tube
from scipy.sparse import bsr_array

from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.geometry.linalg.block_cholesky import BlockPattern
from apd_viewer.geometry.pose.constraints import SoftConstraints

MATERIAL = Material(thickness=0.05, poisson=0.3)


def wall(V, F, fixed=(), material=MATERIAL, **more):
    return WallSurface(SolveMesh(V, F), np.array(fixed, dtype=np.int64), material, **more)


def hessian(surface, tensions, pressure, share=1.0):
    pattern = surface.couplings
    pattern.sort_indices()
    start, column = pattern.indptr.astype(np.int64), pattern.indices.astype(np.int64)
    blocks = surface.blocks(
        BlockPattern(surface.rest.V[surface.free], start, column), tensions, pressure, share
    )
    return bsr_array((blocks, column, start)).tocsr()


def test_wall_surface_stretches_as_elasticity_has_it():
    """With free sides a sheet is as firm as Young's modulus times thickness; held ones add their part."""
    V, F = grid(4, 6)
    strain, poisson = 1e-5, MATERIAL.poisson
    for across, firm in ((-poisson * strain, 1.0), (0.0, 1.0 / (1.0 - poisson**2))):
        U = V * (1.0 + np.array([strain, across, 0.0]))
        expected = 0.5 * MATERIAL.tensile_stiffness * firm * strain**2 * 24.0
        assert wall(V, F).energy_after_local_step(U) == pytest.approx(expected, rel=1e-4)


def test_wall_surface_rolls_a_sheet_into_a_tube_for_the_energy_of_a_plate():
    V, F = grid(40, 6, 2 * np.pi / 40, 0.2)
    surface = wall(V, F)
    U = np.column_stack([np.sin(V[:, 0]), V[:, 1], 1.0 - np.cos(V[:, 0])])
    expected = 0.5 * MATERIAL.plate_rigidity * 2 * np.pi * 1.2
    # Chords are shorter than arcs, which stretches; what is free to curl at the sides gives way a little.
    assert surface.energy_after_local_step(U) * (1.0 - surface.stretching_fraction) == pytest.approx(
        expected, rel=0.06
    )


def uneven(V, F):
    """A tube as low as its triangles are flat, so that edges around are longer than others."""
    return V * [1.0, 1.0, 0.5], F


MESHES = {"tube": tube(8, 5), "uneven": uneven(*tube(8, 5)), "sheet": grid(4, 5), "sphere": sphere(1)}


@pytest.mark.parametrize("kind", ["plain", "relaxed", "mapped"])
@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_wall_surface_has_the_derivatives_of_its_energy_and_of_goals(mesh, kind):
    V, F = mesh
    fixed, rng = [0, 1, 2], np.random.default_rng(1)
    thickness = WallMap(0.05, 0.05 * rng.uniform(0.5, 2.0, len(F))) if kind == "mapped" else 0.05
    soft = SoftConstraints(np.array([5, 7]), np.ones(2), np.array([3.0, 2.0]), np.array([0, 0]))
    surface = wall(
        V, F, fixed, replace(MATERIAL, is_relaxed=kind == "relaxed", thickness=thickness), soft=soft
    )
    U = V + 0.05 * rng.normal(size=V.shape)
    targets = np.concatenate([U[fixed], V[[5, 7]] + 0.1])
    surface.restart(U)
    residual = surface.residual(targets)
    way, step = np.zeros_like(V), 1e-6
    way[surface.free] = rng.normal(size=(len(surface.free), 3))
    there, back = (surface.energy_after_local_step(U + sign * step * way) for sign in (1, -1))
    along = 4.0 * (residual * way[surface.free]).sum()
    assert along == pytest.approx((there - back) / (2 * step), rel=1e-6)

    surface.restart(U)
    tensions, pressure = rng.uniform(size=len(F)), 0.7

    def slope(X):
        corners = X[F]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        area, volume = np.zeros_like(X), np.zeros_like(X)
        edges = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
        np.add.at(area, F, 0.5 * tensions[:, None, None] * np.cross(normals[:, None], edges))
        np.add.at(volume, F, np.cross(corners[:, [1, 2, 0]], corners[:, [2, 0, 1]]) / 6.0)
        goals = 0.25 * (area + pressure * volume)[surface.free]
        return surface.residual_at(X, targets) + goals

    change = (slope(U + step * way) - slope(U - step * way)) / (2 * step)
    found = (hessian(surface, tensions, pressure) @ way[surface.free].ravel()).reshape(-1, 3)
    # Beside the energy the matrix has a shift of the whole that is too small to matter.
    assert np.abs(found - change).max() < 1e-5 * np.abs(change).max()


def test_wall_surface_with_uneven_edges_needs_no_energy_to_turn():
    """It rests curved, with hinges that are nearly shut: full turns of their angles count as none."""
    V, F = grid(6, 9, 0.1, 0.07)
    folded = np.column_stack([np.abs(V[:, 0] - 0.3), V[:, 1], 0.002 * (V[:, 0] > 0.31) + V[:, 1] ** 2])
    surface = wall(folded, F)
    assert surface.stretching.arcs.nnz > 0
    assert surface.energy_after_local_step(folded @ rotation([1, 2, 3], 2.0).T + 5.0) < 1e-20


def test_wall_surface_has_a_definite_matrix_without_what_may_be_indefinite():
    V, F = uneven(*tube(12, 8))
    surface = wall(V, F, [0, 1, 2])
    assert surface.stretching.arcs.nnz > 0
    surface.restart(V * [0.8, 0.9, 0.7] + 0.02 * np.random.default_rng(3).normal(size=V.shape))
    whole = np.linalg.eigvalsh(hessian(surface, np.zeros(len(F)), 0.0).toarray())
    safe = np.linalg.eigvalsh(hessian(surface, np.zeros(len(F)), 0.0, share=0.0).toarray())
    assert whole[0] < 0.0 < safe[0]


def test_wall_surface_with_a_tension_field_pulls_but_does_not_push():
    V, F = grid(4, 4)
    plain, relaxed = (wall(V, F, material=replace(MATERIAL, is_relaxed=on)) for on in (False, True))
    for share in (0.9, 1.1):
        U = V * [share, 1.0, 1.0]
        energies = [surface.energy_after_local_step(U) for surface in (plain, relaxed)]
        assert energies[1] == pytest.approx(energies[0] if share > 1.0 else 0.0, abs=1e-3 * energies[0])


def test_wall_surface_resists_the_collapse_of_a_triangle():
    """Without it a membrane in plane compression gives way from a compression of 42 % on."""
    V, F = grid(1, 1)
    surface = wall(V, F)
    energies = [surface.energy_after_local_step(V * [share, share, 1.0]) for share in (0.6, 0.4, 0.2, 0.05)]
    assert (np.diff(energies) > 0.0).all()
    share, step = 0.4, 1e-6
    surface.restart(V * [share, share, 1.0])
    slope = 4.0 * (surface.residual(V[:0]) * V[surface.free]).sum()
    there, back = (
        surface.energy_after_local_step(V * [share + k * step, share + k * step, 1.0]) for k in (1, -1)
    )
    assert slope == pytest.approx((there - back) / (2 * step), rel=1e-5)
