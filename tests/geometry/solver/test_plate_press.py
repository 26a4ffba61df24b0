"""Meshes between plates and fingers: nothing crosses, loads are the slope of the energy."""

from functools import cache

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import rotation, sample_bottle, sphere, tube

from apd_viewer import Convergence, press
from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact_obstacles import capsule, plate
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.operators import vertex_areas
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.plate_press import PlatePress

X, Y, Z = np.eye(3)
# 0.1 MPa in half a litre, relative to the stretching stiffness of 0.3 mm of PET and the area of the bottle.
AIR = 0.005
STIFF = {"stiffness": 0.001}
IN_CONTACT = {"contact": True, "calm": False, **STIFF}


@cache
def ball():
    return RestMesh(*sphere(2))


def settled(solver, most=4000):
    """Frame of the shape at rest."""
    for _ in range(most):
        if solver.settled:
            return solver.frame()
        solver.iterate()
    raise AssertionError(f"not settled in {most} iterations")


def pressed_to(plates, share):
    plates.set_target(share)
    return settled(plates.solver)


def slope(plates, share, h):
    """Slope of the energy over the travel, by differences of ``h`` of it."""
    energies = []
    for side in (-h, h):
        pressed_to(plates, share + side)
        energies.append(plates.solver.contact.energy_in_contact)
    return (energies[1] - energies[0]) / (2.0 * h * plates.travel.length)


def test_plate_press_crosses_nothing_on_the_way_and_keeps_the_area():
    """Every frame of a sphere pressed to a fifth of its height, free between the plates."""
    rest = ball()
    plates, crosses = PlatePress(rest, Z, 0.4, 4, **STIFF), CrossingCheck(rest.V, rest.F)
    solver, frames, least = plates.solver, 0, []
    for share in (0.25, 0.5, 0.75, 1.0):
        plates.set_target(share)
        while not solver.settled:
            solver.iterate()
            frames += 1
            if frames % 5:
                continue
            frame = solver.frame()
            U, reach = frame.U, plates.travel_fraction * (plates.travel.first_distance - 0.4) / 2
            assert not crosses.crosses(U)
            assert abs(frame.area_error) <= 1e-9
            assert U[:, 2].min() > -plates.travel.first_distance / 2 + reach
            assert U[:, 2].max() < plates.travel.first_distance / 2 - reach
        least.append(np.ptp(solver.frame().U[:, 2]))
    assert least[-1] < 0.4
    assert plates.travel_fraction == 1.0


def test_plate_press_loads_of_both_plates_are_the_slope_of_the_energy():
    """At rest, by differences of the energy of plates a little nearer and farther."""
    plates = PlatePress(ball(), Z, 1.5, 2, **STIFF)
    h = 2e-3
    for share in (0.5, 1.0 - h):
        low, high = pressed_to(plates, share).loads @ Z
        assert high == pytest.approx(-low, rel=0.01)
        assert 0.5 * (high - low) == pytest.approx(slope(plates, share, h), rel=0.01)


def bottle_press(edge, to, steps, **given):
    """Plates at the sample bottle, a wall of PET of 0.3 mm."""
    V, F, _ = sample_bottle(edge=edge)
    given = {"method": "wall", "wall_thickness": 0.03, "poisson": 0.38} | given
    return PlatePress(RestMesh(V, F), X, to * np.ptp(V[:, 0]), steps, **given)


@pytest.mark.parametrize(
    ("gas", "area"),
    [
        (None, None),
        pytest.param(AIR, None, marks=pytest.mark.night),
        pytest.param(None, "100%", marks=pytest.mark.night),
        pytest.param(AIR, "100%", marks=pytest.mark.night),
    ],
)
def test_plate_press_by_wall_has_loads_that_are_the_slope_of_the_energy_at_a_point(gas, area):
    plates = bottle_press(2.5, 0.95, 1, gas=gas, area=area, convergence=Convergence(energy_tolerance=1e-11))
    share, h = 0.8, 5e-3
    low, high = pressed_to(plates, share).loads @ X
    assert high == pytest.approx(-low, rel=0.005)
    assert 0.5 * (high - low) == pytest.approx(slope(plates, share, h), rel=0.01)


@pytest.mark.night
def test_plate_press_with_gas_carries_what_a_held_volume_does():
    """The gas law at the volume that is left gives the pressure; a volume that is held needs the same."""
    *_, empty = bottle_press(2.5, 0.95, 2).steps()
    plates = bottle_press(2.5, 0.95, 2, gas=AIR)
    *_, filled = plates.steps()
    ratio = filled.volume / plates.solver.rest.volume
    *_, held = bottle_press(2.5, 0.95, 2, volume=f"{100.0 * ratio:.12g}%").steps()
    assert held.volume == pytest.approx(filled.volume, rel=1e-9)
    gains = [step.load_low - empty.load_low for step in (filled, held)]
    assert gains[0] > 0.0
    assert gains[1] == pytest.approx(gains[0], rel=1e-4)


@pytest.mark.parametrize("method", ["exact", pytest.param("wall", marks=pytest.mark.night)])
def test_press_reaches_another_volume_before_the_plates_move(method):
    V, F, _ = sample_bottle(edge=2.5)
    stiff = {"stiffness": 0.001} if method == "exact" else {"wall_thickness": 0.03}
    found = press(V, F, X, 0.95 * np.ptp(V[:, 0]), 1, method=method, volume="95%", **stiff)
    assert found.steps[-1].settled
    assert found.steps[-1].volume == pytest.approx(0.95 * found.steps[0].volume, rel=1e-9)


def test_press_does_not_depend_on_the_direction():
    """A turned mesh pressed along the turned axis gives the same curve."""
    V, F = tube(16, 12)
    R = rotation((1.0, 2.0, -0.5), 0.7)
    meshes, wall = ((V, X), (V @ R.T + 5.0, R @ X)), 0.005
    found = [press(W, F, axis, 1.4, 3, stiffness=0.001, thickness=wall) for W, axis in meshes]
    loads = [[step.load_low for step in run.steps[1:]] for run in found]
    assert np.allclose(loads[0], loads[1], rtol=2e-3)
    assert found[0].steps[-1].distance == pytest.approx(1.4)
    assert [step.crossings for step in found[0].steps] == [0] * 4


@pytest.mark.night
def test_press_lets_a_tall_tube_yield_and_not_topple():
    """Without friction it would lie down between the plates and carry nothing."""
    V, F = tube(32, 20)
    axis = np.eye(3)[int(np.argmax(np.ptp(V, axis=0)))]
    height = np.ptp(V @ axis)
    found = press(V, F, axis, 0.85 * height, 8, stiffness=0.001)
    loads = [0.5 * (step.load_low + step.load_high) for step in found.steps]
    assert found.curve.yield_load is not None
    assert max(loads) == found.curve.yield_load
    assert loads[-1] > 0.5 * found.curve.yield_load
    assert not found.stopped
    assert all(step.settled and step.crossings == 0 for step in found.steps)


@pytest.mark.night
def test_plate_press_does_not_turn_what_lies_askew_however_it_is_pushed_along():
    """A tilted egg, whose plates turn it: otherwise loads would not be the slope of the energy."""
    V, F = sphere(2)
    V = V * (0.6, 0.6, 1.2) @ rotation(Y, np.radians(60.0)).T
    plates = PlatePress(RestMesh(V, F), Z, 0.9, 2, **STIFF)
    m = vertex_areas(V, F)
    away, moments = V - m @ V / m.sum(), []
    for share in (0.5, 1.0):
        frame = pressed_to(plates, share)
        moments.append(np.cross(away, m[:, None] * frame.U).sum(axis=0))
    low, high = frame.loads
    assert low[2] < -1.0
    assert high[2] > 1.0
    # It is turned back by Newton's method, which leaves up to 2e-8.
    assert np.abs(moments).max() <= 1e-7 * m.sum()


def test_press_keeps_the_area_without_pushing_against_the_plates():
    """The way that the projection takes yields to the plates; else each step would be cut short."""
    V, F = tube(32, 20)
    axis = np.eye(3)[int(np.argmax(np.ptp(V, axis=0)))]
    found = press(V, F, axis, 0.97 * np.ptp(V @ axis), 2, stiffness=0.001)
    assert found.steps[-1].settled
    # As far as a shape at rest balances: 0.2 to 1.2 in a thousand, by what the kernels are compiled for.
    assert found.steps[-1].load_low == pytest.approx(found.steps[-1].load_high, rel=2e-3)
    assert found.steps[-1].iterations < 300  # 725 by a way found without the plates


@pytest.mark.night
def test_press_lets_contact_stop_no_plates_that_have_room():
    """A coarse ball: its corners are pushed by the plates one by one."""
    V, F = sphere(2)
    found = press(V, F, Z, 0.6, 6, stiffness=0.01)
    assert not found.stopped
    assert found.steps[-1].distance == pytest.approx(0.6)
    assert all(step.settled for step in found.steps)


def test_deformation_lets_a_held_base_take_what_the_plates_do_not_balance():
    V, F = sphere(3)
    base = np.flatnonzero(V[:, 2] < -0.8)
    rest = RestMesh(V, F)
    lid = plate([0, 0, 1.0 + 1e-3 * rest.diagonal], -Z, rest.diagonal)
    solver = Deformation(V, F, base, obstacles=[lid], **IN_CONTACT)
    solver.aim(V[base], shifts=[[0, 0, -0.5]])
    frame = settled(solver)
    assert np.array_equal(frame.U[base], V[base])
    assert frame.loads[0] @ Z > 0.0
    assert frame.U[:, 2].max() < 0.5 + 2e-3 * rest.diagonal


def test_deformation_closes_five_fingers_on_a_tube():
    """A fist: four capsules and a thumb; no vertex inside of them, no wall through a wall, in any frame."""
    V, F = tube(32, 30)
    rest, r = RestMesh(V, F), 0.25
    extent = np.abs(V).max(axis=0)
    axis = int(np.argmax(np.ptp(V, axis=0)))
    along, across, side = np.eye(3)[axis], np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
    middle = 0.5 * (V.min(axis=0) + V.max(axis=0))
    out = extent[(axis + 1) % 3] + r + 2e-3 * rest.diagonal
    places = [out * across + k * 0.55 * along for k in (-1.5, -0.5, 0.5, 1.5)] + [-out * across]
    ways = [-across] * 4 + [across]
    fingers = [capsule(middle + p - 3.0 * side, middle + p + 3.0 * side, r) for p in places]
    shifts = 0.35 * np.array(ways)
    solver, crosses = Deformation(V, F, [], obstacles=fingers, **IN_CONTACT), CrossingCheck(V, F)
    solver.aim(np.zeros((0, 3)), shifts=shifts)
    count = 0
    while not solver.settled and count < 1500:
        solver.iterate()
        count += 1
        if count % 10 == 0:
            frame = solver.frame()
            U = frame.U
            assert not crosses.crosses(U)
            for finger, shift in zip(fingers, frame.shifts, strict=True):
                assert finger.distances_and_directions(finger.points + shift, U)[0].min() > 0.0
    assert solver.share_reached == 1.0
    assert solver.contact.load_imbalance < 0.01
    assert all(load @ way < 0.0 for load, way in zip(solver.frame().loads, ways, strict=True))


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"to": 3.0}, "The plates start"),
        ({"to": 0.0}, "The plates start"),
        ({"to": float("nan")}, "The plates start"),
        ({"axis": (0, 0, 0)}, "direction"),
        ({"axis": (1, 0)}, "direction"),
        ({"steps": 0}, "steps must be"),
        ({"steps": 2.5}, "steps must be"),
        ({"iterations": 0}, "iterations must be"),
        ({"method": "paper"}, "choose one of"),
        ({"thickness": -1.0}, "thickness"),
        ({"thickness": 10.0}, "thickness"),
        ({"fixed": [99_999]}, "does not exist"),
        ({"stiffness": -1.0}, "stiffness"),
    ],
)
def test_press_refuses_bad_input_in_one_sentence(asked, words):
    V, F = sphere(2)
    asked = {"axis": (1, 0, 0), "to": 1.0, **asked}
    with pytest.raises(InputError, match=words):
        press(V, F, asked.pop("axis"), asked.pop("to"), asked.pop("steps", 2), **asked)


def test_deformation_rests_with_the_loads_of_its_gaps():
    """A plate that comes by small steps blocks none of them; its load is the slope of the energy still."""
    V, F = sphere(3)
    base = np.flatnonzero(V[:, 2] < -0.8)
    rest = RestMesh(V, F)
    reach = 1e-3 * rest.diagonal
    lid = plate([0, 0, 1.0 + 2.0 * reach], -Z, rest.diagonal)
    solver = Deformation(V, F, base, obstacles=[lid], **IN_CONTACT)
    found = {}
    for steps in (1, 8):
        U = V
        for k in range(1, steps + 1):
            solver.aim(V[base], U, shifts=[[0, 0, -1.6 * reach * k / steps]])
            frame = settled(solver)
            U = frame.U
        found[steps] = frame.loads[0] @ Z
        assert frame.converged
        assert U[:, 2].max() < 1.0
    assert found[8] == pytest.approx(found[1], rel=0.05)
