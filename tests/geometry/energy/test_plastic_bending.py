"""Bending that yields: its forces, what springs back, and what stays."""

import numpy as np
import pytest
from meshes import grid, moved, rotation, tube

from apd_viewer.geometry.contact.contact_obstacles import sphere
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.plastic_bending import CreasedCells
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.solver.deformation import Deformation

FAR = [sphere([1e3, 0.0, 0.0], 1.0)]
FREE = {"contact": True, "obstacles": FAR}
WALLS = {"arap": {"method": "arap", "stiffness": 0.01}, "wall": {"method": "wall", "poisson": 0.0}}
V, F = tube(12, 8, height=3.0, shear=0.6)
HELD = np.array([0, 5])


def surface(yield_curvature=np.inf):
    return ElasticSurface(SolveMesh(V, F), HELD, Material(bending=0.01, yield_curvature=yield_curvature))


def at_rest_with(elastic, U):
    """The surface at ``U`` with rotations and flow that belong to each other."""
    elastic.restart(U)
    for _ in range(60):
        elastic.local_step(U)
    return elastic.energy


def shaken(amount, seed=3):
    return V + amount * np.random.default_rng(seed).normal(size=V.shape)


def strip(count, length=4.0, width=0.6):
    """Flat strip of nearly equilateral triangles along x."""
    rows = round(width / (length / count * 0.75**0.5))
    flat, triangles = grid(count, rows, 1.0, 1.0)
    X = np.column_stack(
        [(flat[:, 0] - 0.5 * flat[:, 1]) * length / count, flat[:, 1] * width / rows, flat[:, 2]]
    )
    return X - X.mean(axis=0), triangles


def bent(X, angle, length=4.0):
    k = angle / length
    return np.column_stack([np.sin(k * X[:, 0]) / k, X[:, 1], (1.0 - np.cos(k * X[:, 0])) / k])


def angle_of(X, U, length=4.0):
    """Angle of a bent strip by the directions of two parts of it, 0.6 of its length apart."""
    directions = []
    for at in (-0.3, 0.3):
        near = np.abs(X[:, 0] / length - at) < 0.1
        along = np.column_stack([X[near, :2], np.ones(near.sum())])
        directions.append(np.linalg.lstsq(along, U[near], rcond=None)[0][0])
    a, b = directions
    return np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b) / 0.6


def test_plastic_bending_changes_nothing_below_the_yield_curvature():
    """Energy and forces are those of walls that do not yield."""
    U, targets = shaken(0.02), V[HELD]
    plain, yielding = surface(), surface(1e6)
    assert at_rest_with(yielding, U) == pytest.approx(at_rest_with(plain, U), rel=1e-12)
    assert yielding.residual(targets) == pytest.approx(plain.residual(targets), abs=1e-12)
    yielding.commit_creases()
    assert yielding.energy == pytest.approx(plain.energy, rel=1e-12)


@pytest.mark.parametrize("kept", [False, True])
def test_plastic_bending_forces_are_the_slope_of_the_energy(kept):
    """While it flows, with and without creases from before."""
    elastic = surface(0.5)
    if kept:
        at_rest_with(elastic, shaken(0.05))
        elastic.commit_creases()
    U, h = shaken(0.05, seed=4), 1e-5
    way = np.random.default_rng(5).normal(size=V.shape)
    way[HELD] = 0.0
    ends = [at_rest_with(elastic, U + side * h * way) for side in (-1, 1)]
    at_rest_with(elastic, U)
    slope = 4.0 * float((elastic.residual(U[HELD]) * way[elastic.free]).sum())
    assert (ends[1] - ends[0]) / (2 * h) == pytest.approx(slope, rel=1e-4)


def test_commit_creases_changes_no_energy_but_the_forces():
    """What flow has taken is counted, and a shape that yields is drawn back less."""
    elastic, U = surface(0.5), shaken(0.1)
    E = at_rest_with(elastic, U)
    before = np.linalg.norm(elastic.residual(U[HELD]))
    elastic.commit_creases()
    assert elastic.energy == pytest.approx(E, rel=1e-12)
    assert 0.0 < elastic.material.bending * elastic.creases.dissipated_energy < E
    at_rest_with(elastic, U)
    assert np.linalg.norm(elastic.residual(U[HELD])) <= before


def test_commit_creases_knows_no_place_and_no_turn():
    """The energy is the same wherever the creased shape is, and however it is turned."""
    elastic, U = surface(0.5), shaken(0.1)
    at_rest_with(elastic, U)
    elastic.commit_creases()
    E = at_rest_with(elastic, shaken(0.1, seed=9))
    turned = moved(shaken(0.1, seed=9), rotation([1, 2, 3], 1.2), [3, -2, 1])
    assert at_rest_with(elastic, turned) == pytest.approx(E, rel=1e-9)


@pytest.mark.parametrize("wall", WALLS.values(), ids=WALLS)
@pytest.mark.parametrize("count", [40, pytest.param(80, marks=pytest.mark.night)])
@pytest.mark.parametrize(("angle", "yields"), [(90, 30), (150, 45)])
def test_plastic_bending_lets_a_bent_strip_keep_all_but_the_angle_of_yield(count, angle, yields, wall):
    """Two resolutions; a strip that is bent less springs back to flat."""
    X, triangles = strip(count)
    radius = 4.0 / np.radians(yields)
    for by, left in ((angle, angle - yields), (0.9 * yields, 0.0)):
        start = bent(X, np.radians(by))
        free = Deformation(X, triangles, [], **FREE, **wall, yield_radius=radius)
        free.aim(np.zeros((0, 3)), start)
        while not free.settled:
            free.iterate()
        assert np.degrees(angle_of(X, free.frame().U)) == pytest.approx(left, abs=0.02 * (angle - yields))


def test_creased_cells_leave_out_triangles_with_a_corner_twice():
    """Welding leaves such triangles; their edges have the creases of the others there."""
    V, F = grid(3, 3)
    rng = np.random.default_rng(0)
    flow, (a, b, _) = rng.normal(size=(len(F), 3, 3, 3)), F[-1]
    last = F[(len(V) - 1 == F).any(axis=1)][0].max()
    G, more = np.vstack([F, [[a, a, b], [last, last, last]]]), np.concatenate([flow, np.ones((2, 3, 3, 3))])
    q, U = np.tile([1.0, 0.0, 0.0, 0.0], (len(V), 1)), V + 0.1 * rng.normal(size=V.shape)
    alone, beside = (
        CreasedCells(SolveMesh(V, faces), np.ones(len(V), dtype=bool), of_faces).energy(U, q)
        for faces, of_faces in ((F, flow), (G, more))
    )
    assert beside == pytest.approx(alone, rel=1e-12)
