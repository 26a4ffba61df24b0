"""Hinges that yield: energy by the closed form, forces, flow, and a ring that only yields."""

import numpy as np
import pytest
from meshes import grid, moved, rotation, tube

from apd_viewer import press
from apd_viewer.geometry.energy.hinges import Hinges, angles_and_gradients
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.plastic_hinges import PlasticHinges
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.verification.press_cases import hinged_load

RIGIDITY, POISSON, YIELD = 2.5, 0.3, 0.5
V, F = tube(12, 8, height=3.0, shear=0.6)


def angles_at(hinges, U):
    return angles_and_gradients(U, hinges.corners)[0]


def shaken(amount, seed):
    return V + amount * np.random.default_rng(seed).normal(size=V.shape)


@pytest.mark.parametrize("curvature", [0.3, 0.8, 2.0])
def test_plastic_hinges_take_the_energy_of_a_plate_that_yields(curvature):
    """On a cylinder, along which nothing curls: up to the yield curvature elastic, above linear."""
    X, triangles = grid(60, 12, 1 / 60, 1 / 12)
    U = (
        np.column_stack([np.sin(curvature * X[:, 0]), curvature * X[:, 1], np.cos(curvature * X[:, 0])])
        / curvature
    )
    hinges = PlasticHinges(X, triangles, RIGIDITY, 0.0, yield_curvature=YIELD)
    stored = min(curvature, YIELD)
    expected = RIGIDITY * stored * (curvature - 0.5 * stored)
    assert hinges.moments(angles_at(hinges, U))[0] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("hardening", [0.0, 0.1, 0.5])
def test_plastic_hinges_harden_along_a_bilinear_curve(hardening):
    """A strip is bent, released, bent back beyond its yield, and again: isotropic, in straight lines.

    The energy is the area under the curve, and what is dissipated the area less what springs back.
    """
    X, triangles = grid(60, 12, 1 / 60, 1 / 12)
    hinges = PlasticHinges(X, triangles, RIGIDITY, 0.0, yield_curvature=YIELD, hardening=hardening)
    rolled = angles_at(hinges, np.column_stack([np.sin(X[:, 0]), X[:, 1], np.cos(X[:, 0])]))
    ends, curvatures, moments, k, bound = (1.2, -0.9, 1.5), [0.0], [0.0], 0.0, YIELD
    for end in ends:
        sign = np.sign(end)
        at_yield = k - moments[-1] / RIGIDITY + sign * bound  # elastic up to the bound on that side
        assert sign * (end - at_yield) > 0.0, "it yields on this way"
        bound += hardening * abs(end - at_yield)
        curvatures += [at_yield, end]
        moments += [sign * RIGIDITY * (bound - hardening * abs(end - at_yield)), sign * RIGIDITY * bound]
        k = end
    work = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(curvatures) * (np.add(moments[1:], moments[:-1])))])
    for corner, (curvature, moment) in enumerate(zip(curvatures, moments, strict=True)):
        energy = hinges.moments(curvature * rolled)[0]
        around = [hinges.moments((curvature + side * 1e-6) * rolled)[0] for side in (-1, 1)]
        assert energy == pytest.approx(work[corner], rel=0.02, abs=1e-9)
        assert (around[1] - around[0]) / 2e-6 == pytest.approx(moment, rel=0.03, abs=1e-3)
        hinges.commit_flow(curvature * rolled)
        assert hinges.moments(curvature * rolled)[0] == pytest.approx(energy, rel=1e-12)
        kept = work[corner] - 0.5 * moment**2 / RIGIDITY
        assert hinges.dissipated_energy == pytest.approx(kept, rel=0.03, abs=1e-3)
    hinges.clear_flow()
    assert hinges.moments(YIELD * rolled)[0] == pytest.approx(0.5 * RIGIDITY * YIELD**2, rel=0.02)


def test_plastic_hinges_are_hinges_below_the_yield_curvature():
    plain = Hinges(V, F, RIGIDITY, POISSON)
    yielding = PlasticHinges(V, F, RIGIDITY, POISSON, yield_curvature=1e6)
    angles = angles_at(plain, shaken(0.05, 1))
    (E, moments), (E_yielding, yielding_moments) = plain.moments(angles), yielding.moments(angles)
    assert E_yielding == pytest.approx(E, rel=1e-12)
    assert yielding_moments == pytest.approx(moments, abs=1e-12 * np.abs(moments).max())
    assert yielding.stiffness_at(angles) is yielding.Q


@pytest.mark.parametrize("hardening", [0.0, 0.3])
def test_plastic_hinges_matrix_bounds_the_energy_from_above(hardening):
    """The matrix of a step is that of a quadratic that touches the energy, and is nowhere below it."""
    hinges = PlasticHinges(V, F, RIGIDITY, POISSON, yield_curvature=YIELD, hardening=hardening)
    rng, angles = np.random.default_rng(2), angles_at(hinges, shaken(0.1, 2))
    E, moments = hinges.moments(angles)
    matrix = hinges.stiffness_at(angles)
    assert (np.abs(matrix - hinges.Q) > 0.0).nnz > 0
    for size in (1e-3, 0.1, 0.3):
        way = size * rng.normal(size=len(angles))
        above = E + moments @ way + 0.5 * way @ (matrix @ way)
        assert hinges.moments(angles + way)[0] <= above + 1e-9 * E


@pytest.mark.parametrize("flowed", [False, True])
def test_plastic_hinges_moments_are_the_slope_of_the_energy(flowed):
    given = Material(thickness=0.05, poisson=POISSON, yield_curvature=YIELD, hardening=0.2)
    wall = WallSurface(SolveMesh(V, F), np.array([0, 5]), given)
    if flowed:
        wall.restart(shaken(0.05, 3))
        E = wall.energy
        wall.commit_creases()
        assert wall.energy == pytest.approx(E, rel=1e-12)
        assert wall.creases.dissipated_energy > 0.0
    U, step = shaken(0.05, 4), 1e-6
    way = np.random.default_rng(5).normal(size=V.shape)
    way[[0, 5]] = 0.0
    there, back = (wall.energy_after_local_step(U + sign * step * way) for sign in (1, -1))
    wall.restart(U)
    slope = 4.0 * float((wall.residual(U[[0, 5]]) * way[wall.free]).sum())
    assert (there - back) / (2 * step) == pytest.approx(slope, rel=1e-5)
    turned = moved(U, rotation([1, 2, 3], 1.2), [3, -2, 1])
    assert wall.energy_after_local_step(turned) == pytest.approx(wall.energy_after_local_step(U), rel=1e-9)


def test_plastic_hinges_remember_where_they_flowed():
    """At the shape of the flow a wall is at its yield moment; without flow again, as new."""
    hinges = PlasticHinges(V, F, RIGIDITY, POISSON, yield_curvature=YIELD)
    angles = angles_at(hinges, shaken(0.1, 6))
    E, moments = hinges.moments(angles)
    hinges.commit_flow(angles)
    E_after, moments_after = hinges.moments(angles)
    assert E_after == pytest.approx(E, rel=1e-12)
    assert moments_after == pytest.approx(moments, abs=1e-12 * np.abs(moments).max())
    assert np.abs(hinges.moments(hinges.rest)[1]).max() > 0.0
    hinges.clear_flow()
    assert hinges.moments(hinges.rest)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.night
def test_wall_that_hardens_keeps_less_of_a_press():
    """A ring opened again: with hardening it needs more load, and springs back further."""
    X, triangles = tube(48, 2, height=0.25, shear=0.5)
    given = {"method": "wall", "wall_thickness": 0.02, "poisson": 0.0, "yield_radius": 2.0, "release": True}
    soft, hard = (press(X, triangles, (1, 0, 0), 1.0, 3, hardening=each, **given) for each in (0.0, 0.3))
    assert hard.steps[-1].load > 1.1 * soft.steps[-1].load
    lost = [2.0 - np.ptp(found.U[:, 0]) for found in (soft, hard)]
    assert 0.05 < lost[1] < 0.9 * lost[0]


@pytest.mark.parametrize("shear", [pytest.param(0.25, marks=pytest.mark.night), 0.5])
def test_wall_presses_a_plastic_ring_by_the_load_of_theory(shear):
    """Four hinges form, and between them it is nearly rigid [DeRuntz & Hodge 1963]."""
    X, triangles = tube(192, 4, height=0.125, shear=shear)
    radius, thickness = 8.0, 0.02
    found = press(
        *(X, triangles, (1, 0, 0), 0.8, 6),
        method="wall",
        wall_thickness=thickness,
        poisson=0.0,
        yield_radius=radius,
    )
    moment = Material(thickness=thickness).plate_rigidity / radius * np.ptp(X[:, 2])
    for step in found.steps[2::2]:
        assert step.settled
        load = 0.5 * (step.load_low + step.load_high)
        assert load / moment == pytest.approx(hinged_load(step.deflection / 2.0), rel=0.03)
