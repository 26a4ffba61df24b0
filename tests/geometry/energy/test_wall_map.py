"""Walls of several thicknesses: the same bits where all are alike, and rings by thin-ring theory."""

import pickle

import numpy as np
import pytest
from meshes import can, grid, tube
from scipy.integrate import quad

from apd_viewer import Convergence, Deformation, InputError, press, wall_map
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.energy.wall_map import WallMap, wall_map_of
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall

QUARTER = np.pi / 4


def pressed(thickness, **more):
    V, F = can(16)
    given = {"yield_radius": 0.5, "method": "wall", "poisson": 0.3, "wall_thickness": thickness}
    return press(V, F, (1, 0, 0), 1.8, 2, **given | more)


def walled(thickness, V, F, young=None, radius=None):
    return wall_map(V, F, thickness, young=young, yield_radius=radius)


@pytest.mark.parametrize(
    "kind",
    ["modulus", *(pytest.param(kind, marks=pytest.mark.night) for kind in ("vertices", "triangles"))],
)
def test_wall_map_of_one_wall_gives_its_bits(kind):
    V, F = can(16)
    one = pressed(0.03)
    same = np.full(len(V if kind == "vertices" else F), 0.03)
    if kind == "modulus":
        same = walled(same, V, F, np.full(len(F), 2.7e9), np.full(len(F), 0.1))
    same = pressed(same)
    assert np.array_equal(one.U, same.U)
    for step, other in zip(one.steps, same.steps, strict=True):
        assert (step.load, step.energy) == (other.load, other.energy)
    every_other = np.arange(len(F)) % 2
    for other in (np.where(every_other, 0.03, 0.031), walled(0.03, V, F, 1e9 * (1 + every_other))):
        assert not np.array_equal(one.U, pressed(other).U)


def ring_compliance(rigidity):
    """Way of two opposite loads on a ring of radius 1 towards each other, per load and width.

    By symmetry the moment is ``P / 2 (1 - sin s + c)``, s the angle from a load; that the section between
    the loads does not turn determines c [Timoshenko, Strength of Materials, thin rings].
    """

    def integral(of):
        return sum(
            quad(lambda s: of(s) / rigidity(s), *ends)[0] for ends in ((0, QUARTER), (QUARTER, 2 * QUARTER))
        )

    c = -integral(lambda s: 1.0 - np.sin(s)) / integral(np.ones_like)
    return integral(lambda s: (1.0 - np.sin(s) + c) ** 2)


@pytest.mark.parametrize(
    ("at_loads", "between", "soft"),
    [(0.02, 0.02, 1.0), (0.02, 0.03, 1.0), (0.03, 0.02, 1.0), (0.02, 0.02, 0.3), (0.02, 0.03, 0.3)],
)
def test_wall_map_bends_a_ring_as_thin_ring_theory_has_it(at_loads, between, soft):
    """The wall between the loads is of another thickness, or softer."""
    width, way = 0.25, 1e-3
    V, F = tube(192, 8, height=width, shear=0.5)
    angle = np.arctan2(*np.abs(V[F].mean(axis=1)[:, [1, 0]].T))
    thickness = np.where(angle < QUARTER, at_loads, between)
    modulus = np.where(angle < QUARTER, 2e9, soft * 2e9)
    mapped = walled(thickness, V, F, modulus)
    loaded = np.flatnonzero(np.abs(V[:, 1]) < 1e-9)
    solver = Deformation(
        *(V, F, loaded),
        handle=loaded,
        method="wall",
        wall_thickness=mapped,
        poisson=0.0,
        convergence=Convergence(energy_tolerance=1e-11, imperfection=0.0),
    )
    solver.aim(V[loaded] * [1.0 - 0.5 * way, 1.0, 1.0])
    while not solver.settled:
        frame = solver.step()
    per_young = Material(thickness=1.0).tensile_stiffness / (thickness * modulus).mean()
    ends = 2e9 * at_loads**3, soft * 2e9 * between**3
    compliance = ring_compliance(lambda s: per_young * ends[s >= QUARTER] / 12.0)
    assert frame.energy == pytest.approx(0.5 * way**2 / compliance * width, rel=0.01)


def test_wall_map_yields_at_the_strain_of_its_outer_fibres():
    """Rolled to a radius of 1, a wall yields where it is thicker than a yield radius of 1 has it."""
    V, F = grid(40, 8, 2 * np.pi / 40, 0.2)
    thick = V[F].mean(axis=1)[:, 1] > 0.8
    thickness = wall_map_of(np.where(thick, 0.03, 0.01), V, F)
    for radius, yields in ((0.6, ()), (1.0, (True,)), (2.5, (True, False))):
        material = Material(thickness=thickness, yield_curvature=1.0 / radius)
        surface = WallSurface(SolveMesh(V, F), np.array([0]), material)
        surface.restart(np.column_stack([np.sin(V[:, 0]), V[:, 1], 1.0 - np.cos(V[:, 0])]))
        surface.commit_creases()
        flow = np.abs(surface.creases.committed_flow.reshape(-1, 3)).max(axis=1)
        inside = np.abs(V[F].mean(axis=1)[:, 1] - 0.8) > 0.2
        for each in (True, False):
            assert (flow[inside & (thick == each)].mean() > 0.01) == (each in yields)


def test_wall_map_yields_at_its_own_radius():
    """Half of a strip bent onto a circle creases: its yield radius is larger, the thickness the same."""
    V, F = grid(40, 8, 2 * np.pi / 40, 0.2)
    early = V[F].mean(axis=1)[:, 1] > 0.8
    wall = walled(0.02, V, F, None, np.where(early, 3.0, 0.5))
    material = Material(thickness=wall, yield_curvature=1.0 / wall.yield_radius)
    assert material.yield_curvatures == pytest.approx(np.where(early, 1.0 / 3.0, 2.0), rel=1e-12)
    surface = WallSurface(SolveMesh(V, F), np.array([0]), material)
    surface.restart(np.column_stack([np.sin(V[:, 0]), V[:, 1], 1.0 - np.cos(V[:, 0])]))
    surface.commit_creases()
    flow = np.abs(surface.creases.committed_flow.reshape(-1, 3)).max(axis=1)
    inside = np.abs(V[F].mean(axis=1)[:, 1] - 0.8) > 0.2
    assert flow[inside & early].mean() > 0.01
    assert not flow[inside & ~early].any()


def test_wall_map_has_the_mean_stiffness_by_area():
    V, F = can(24)
    rng = np.random.default_rng(2)
    X = V[F]
    areas = np.linalg.norm(np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0]), axis=1)
    thickness, young = rng.uniform(0.1, 0.5, len(F)), rng.uniform(1e9, 4e9, len(F))
    wall = walled(thickness, V, F, young)
    assert wall * wall.young == pytest.approx(np.average(thickness * young, weights=areas), rel=1e-12)
    assert Wall(Unit.MILLIMETRE, wall, 1.38).grams(1.0) == Wall(Unit.MILLIMETRE, float(wall), 1.38).grams(1.0)


def test_wall_map_takes_numbers_of_vertices_and_of_triangles_alike():
    V, F = can(24)
    rng = np.random.default_rng(2)
    thickness, young, radius = (rng.uniform(0.1, 0.5, len(V)) for _ in range(3))
    one, other = (
        walled(*(each[F].mean(axis=1) if of_triangles else each for each in (thickness,)), V, F, *beside)
        for of_triangles, beside in (
            (False, (young, radius)),
            (True, (young[F].mean(axis=1), radius[F].mean(axis=1))),
        )
    )
    for wall in ("young", "yield_radius"):
        expected = getattr(other, wall).triangles
        assert getattr(one, wall).triangles == pytest.approx(expected, rel=1e-12)
    assert one.triangles == pytest.approx(other.triangles, rel=1e-12)
    for name, said in (("young", "Young's modulus"), ("yield_radius", "The yield radius")):
        for wrong in (np.ones(7), np.zeros(len(F)), "soft"):
            with pytest.raises(InputError, match=said):
                wall_map(V, F, 0.1, **{name: wrong})


def test_wall_map_weighs_the_sum_of_its_triangles():
    V, F = can(24)
    rng = np.random.default_rng(1)
    X = V[F]
    areas = 0.5 * np.linalg.norm(np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0]), axis=1)
    for count in (len(F), len(V)):
        values = rng.uniform(0.1, 0.5, count)
        each = values if count == len(F) else values[F].mean(axis=1)
        found = wall_map_of(values, V, F)
        assert values.flags.writeable
        grams = Wall(Unit.MILLIMETRE, found, 1.38).grams(float(areas.sum()))
        assert grams == pytest.approx(1.38e-3 * float((areas * each).sum()), rel=1e-12)


def test_wall_map_is_equal_to_one_with_the_same_thickness_everywhere():
    V, F = can(8)
    one, other = (wall_map_of(np.linspace(0.1, last, len(F)), V, F) for last in (0.2, 0.3))
    copy = pickle.loads(pickle.dumps(one))
    assert copy == one
    assert hash(copy) == hash(one)
    assert one != other
    assert one != float(one)
    assert one.scaled(2.0) == WallMap(2.0 * one, 2.0 * one.triangles)
    beside = walled(0.1, V, F, np.linspace(1e9, 2e9, len(F)), np.linspace(3.0, 4.0, len(F)))
    assert pickle.loads(pickle.dumps(beside)) == beside
    assert beside != walled(0.1, V, F, beside.young.triangles)
    assert beside.scaled(2.0).yield_radius == beside.yield_radius.scaled(2.0)
    assert beside.scaled(2.0).young == beside.young


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (np.full(7, 0.02), r"7 values, but the mesh has .* vertices and .* triangles"),
        (np.full((2, 2), 0.02), "wall_thickness must be a length"),
        (-1, r"greater than 0 everywhere; number 3 is -1"),
        (np.nan, "number 3 is nan"),
        (np.inf, "number 3 is inf"),
        (0.5, "A wall is thin"),
        (1e-9, "hardly stretches"),
        (["thick"] * 4, "real numbers"),
    ],
)
def test_wall_map_that_cannot_be_is_refused(given, said):
    V, F = can(8)
    if np.ndim(given) == 0:
        values = np.full(len(F), 0.02)
        values[3] = given
        given = values
    with pytest.raises(InputError, match=said):
        Deformation(V, F, [0], method="wall", wall_thickness=given)
