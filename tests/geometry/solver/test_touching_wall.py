"""The thin wall as it is deformed: laws of theory, goals to the last digits, no wall through a wall."""

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import ends, grid, moved, rotation, sphere, tube

import apd_viewer
from apd_viewer import Convergence, Deformation
from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact_obstacles import plate
from apd_viewer.geometry.energy.material import Material
from apd_viewer.verification.press_cases import flattened_load
from apd_viewer.verification.shape_cases import elastica_sag

X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
V, F = tube(16, 14)
BASE, HANDLE = ends(V)
FIXED = np.concatenate([BASE, HANDLE])


def settle(solver, most=3000):
    """Frames of a deformation until it has settled."""
    for _ in range(most):
        yield solver.step()
        if solver.settled:
            return
    pytest.fail("it does not come to rest")


def wall(**given):
    return Deformation(V, F, FIXED, handle=HANDLE, method="wall", wall_thickness=0.03, **given)


def test_deformation_bends_a_strip_as_the_elastica_has_it():
    flat, T = grid(30, 3, 1 / 30, 1 / 30)
    rows = np.arange(len(flat)).reshape(31, -1)
    held, targets = rows[[0, -1]].ravel(), flat[rows[[0, -1]].ravel()] * [0.5, 1.0, 1.0]
    how = {"handle": rows[-1], "wall_thickness": 1 / 300, "poisson": 0.0, "contact": False}
    found = apd_viewer.deform(
        flat, T, held, targets, "wall", convergence=Convergence(energy_tolerance=1e-9), **how
    )
    assert found.converged
    assert found.stable
    sag = np.abs(found.U[rows[15], 2]).mean()
    assert sag == pytest.approx(elastica_sag(0.5), rel=1.5e-3)


@pytest.mark.parametrize("shear", [0.0, 0.35])
def test_press_flattens_a_thin_ring_with_the_load_of_theory(shear):
    """At a radius of 100 thicknesses cells would carry 1.4 to 1.75 times as much, by how the rows lie."""
    ring, T = tube(60, 3, shear=shear)
    width = np.ptp(ring[:, 2])
    how = {"method": "wall", "wall_thickness": 0.01, "poisson": 0.0, "thickness": 0.001}
    found = apd_viewer.press(ring, T, X, 1.0, 3, area=100, **how)
    last, rigidity = found.steps[-1], Material(thickness=0.01).plate_rigidity
    gap = np.ptp(last.U[:, 0])
    for load in (last.load_low, last.load_high):
        assert load / (rigidity * width) == pytest.approx(flattened_load(gap), rel=0.01)
    assert abs(last.area_error) < 1e-8
    assert last.crossings == 0
    assert found.load_excess == 0.0


def test_deformation_by_wall_keeps_goals_and_handles_in_every_frame():
    solver = wall(area=100, volume=None, contact=True)
    turned = np.vstack([V[BASE], V[HANDLE] @ rotation([0, 0, 1], 0.7).T])
    solver.aim(turned)
    for frame in settle(solver):
        assert abs(frame.area_error) < 1e-8
        assert not CrossingCheck(V, F).crosses(frame.U)
    assert frame.share_reached == 1.0
    np.testing.assert_array_equal(frame.U[FIXED], turned)


@pytest.mark.parametrize("contact", [False, True])
def test_deformation_by_wall_moves_rigidly_with_what_holds_it(contact):
    solver = wall(contact=contact)
    W = moved(V, rotation([1, 2, 3], 0.9), (0.3, -0.2, 0.5))
    solver.aim(W[FIXED])
    *_, frame = settle(solver)
    np.testing.assert_allclose(frame.U, W, atol=1e-6)
    assert frame.energy < 1e-12


def test_deformation_by_wall_stops_at_an_obstacle_that_bends_it():
    ball, T = sphere(2)
    solver = Deformation(
        *(ball, T, np.flatnonzero(ball[:, 2] < -0.9)),
        method="wall",
        wall_thickness=0.02,
        contact=True,
        obstacles=[plate([0.0, 0.0, 1.05], [0.0, 0.0, -1.0], 3.0)],
    )
    solver.aim(ball[solver.fixed], shifts=[[0.0, 0.0, -0.3]])
    *_, frame = settle(solver)
    assert frame.U[:, 2].max() < 0.75
    assert frame.share_reached == 1.0
    assert frame.loads[0] @ [0.0, 0.0, 1.0] > 0.0


def test_deformation_approaches_a_very_thin_wall_by_thicker_ones():
    """A sheet curls up around a roll: as thin as it gets, its triangles hardly stretch."""
    flat, T = grid(16, 4, 1 / 16, 1 / 16)
    rows = np.arange(len(flat)).reshape(17, -1)
    held = rows[[0, -1]].ravel()
    targets = flat[held] * [0.6, 1.0, 1.0]
    changes = []
    for thickness in (0.05, 2e-5):
        how = {"handle": rows[-1], "wall_thickness": thickness, "contact": False}
        found = apd_viewer.deform(flat, T, held, targets, "wall", **how)
        assert found.converged
        changes.append(found.local_change)
    assert changes[1] < 1e-3 * changes[0]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"wall_thickness": 10.0}, "A wall is thin"),
        ({"wall_thickness": 1e-9}, "hardly stretches any more"),
        ({"plain": True}, "no plain iterations"),
        ({"yield_radius": 1.0, "contact": True, "stiffness": 0.1}, "keeps no creases"),
    ],
)
def test_deformation_by_wall_says_what_it_cannot(given, sentence):
    with pytest.raises(InputError, match=sentence):
        Deformation(V, F, FIXED, **{"handle": HANDLE, "method": "wall"} | given)
