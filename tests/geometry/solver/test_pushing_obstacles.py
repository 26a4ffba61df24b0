"""Obstacles that a deformation meets: nothing is entered, and loads are slopes of the energy."""

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import box, ends, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact_obstacles import capsule, plate, sphere
from apd_viewer.geometry.contact.obstacle_pairs import clearance
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.geometry.pose.transforms import fitted_motion
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.plate_press import PlatePress

X, Y, Z = np.eye(3)
NOBODY = np.zeros((0, 3))
STIFF = {"stiffness": 0.001, "contact": True}


def held_tube():
    """A tube around z, its held ends, and the upper one."""
    V, F = tube(16, 16)
    low, high = ends(V)
    return V, F, np.concatenate([low, high]), high


def beside(kind):
    """Obstacle to the right of the tube at half its height."""
    V = held_tube()[0]
    middle = 0.5 * np.ptp(V[:, 2]) * Z
    return {
        "sphere": sphere(middle + 1.5 * X, 0.4),
        "plate": plate(middle + 1.1 * X, -X - 0.2 * Z, 10.0),
        "cylinder": capsule(middle + 1.4 * X - Y, middle + 1.4 * X + Y, 0.3),
    }[kind]


def settle(solver, obstacles, most=2500):
    """Iterate to the end; every fifth frame and the last are looked at, by another library too."""
    check, F = CrossingCheck(solver.rest.solve_mesh.V, solver.rest.solve_mesh.F), solver.rest.F
    for count in range(most + 1):
        if not solver.settled and count % 5:
            solver.iterate()
            continue
        frame = solver.frame() if solver.settled or count == most else solver.step()
        assert not check.crosses(frame.U)
        assert abs(frame.area_error) <= 1e-9
        for obstacle, shift in zip(obstacles, frame.shifts, strict=True):
            assert clearance(obstacle, shift, frame.U, F) > 0.0
            assert obstacle.distances_and_directions(obstacle.points + shift, frame.U)[0].min() > 0.0
        if solver.settled:
            break
    return frame


def test_obstacles_press_a_shape_as_well_that_was_at_rest_between_them():
    """Searches for a shape that already stands tell nothing of those after the plates have moved."""
    V, F = box(2, 2, 5)
    # Within reach of contact by rounding errors.
    near = 1e-3 * (1 - 1e-12) * np.linalg.norm(np.ptp(V, axis=0))
    plates = [plate([-near, 1.0, 2.5], X, 5.0), plate([2.0 + near, 1.0, 2.5], -X, 5.0)]
    pressed = []
    for iterations_before in 0, 300:
        solver = Deformation(V, F, [], contact=True, obstacles=plates)
        for _ in range(iterations_before):
            solver.iterate()
        solver.aim(NOBODY, shifts=np.array([0.05 * X, 0 * X]))
        frame = settle(solver, plates)
        assert frame.settled
        assert frame.share_reached == 1.0
        assert frame.loads[:, 0].sum() == pytest.approx(0.0, abs=1e-3 * frame.loads[1, 0])
        pressed.append((frame.energy, frame.loads[1, 0]))
    assert pressed[1] == pytest.approx(pressed[0], rel=0.01)


@pytest.mark.parametrize("method", ["exact", "wall"])
def test_deformation_follows_an_obstacle_that_does_not_wait(method):
    """Aimed anew at each step, as a finger that is dragged, it dents the tube all the same."""
    V, F, fixed, handle = held_tube()
    finger = [beside("sphere")]
    thin = {"wall_thickness": 0.02} if method == "wall" else {}
    solver = Deformation(V, F, fixed, handle=handle, method=method, contact=True, obstacles=finger, **thin)
    check = CrossingCheck(solver.rest.solve_mesh.V, solver.rest.solve_mesh.F)
    for k in range(1, 251):
        solver.aim(V[fixed], shifts=-min(0.01 * k, 1.0) * X[None])
        frame = solver.step()
    assert not check.crosses(frame.U)
    assert frame.shifts[0, 0] < -0.6


@pytest.mark.parametrize("method", ["exact", "arap"])
def test_contact_descent_does_not_let_a_dragged_obstacle_wait_where_it_touches_first(method):
    V, F, fixed, handle = held_tube()
    solver = Deformation(
        V, F, fixed, handle=handle, method=method, contact=True, obstacles=[beside("sphere")]
    )
    reached = [0.0]
    while len(reached) < 40:
        solver.aim(V[fixed], shifts=-0.01 * len(reached) * X[None])
        reached.append(-solver.step().shifts[0, 0])
    free = next(k for k, way in enumerate(reached) if way < 0.01 * k - 1e-9)
    assert 5 < free < 15, "it touches after some way"
    assert reached[free + 15] > reached[free]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_deformation_moves_handles_and_obstacles_together_and_enters_nothing(kind, seed):
    """Whatever the last bits of the targets: an obstacle that waits for its triangle may stop anywhere."""
    V, F, fixed, high = held_tube()
    obstacles = [beside(kind)]
    solver = Deformation(V, F, fixed, handle=high, obstacles=obstacles, **STIFF)
    targets = V.copy()
    targets[high] += 0.4 * Y - 0.3 * Z + 1e-12 * np.random.default_rng(seed).standard_normal(3)
    solver.aim(targets[fixed], shifts=[-0.7 * X])
    frame = settle(solver, obstacles, most=600)
    assert frame.converged
    assert np.array_equal(frame.U[fixed], targets[fixed])
    assert np.array_equal(frame.shifts, [-0.7 * X])
    assert frame.loads[0, 0] > 0.1
    solver.aim(V[fixed])
    back = settle(solver, obstacles)
    assert back.share_reached == 1.0
    assert np.array_equal(back.shifts, [0.0 * X])
    assert np.abs(back.loads).max() <= 1e-6
    assert np.abs(back.U - V).max() <= 1e-2


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_deformation_tells_loads_that_are_the_slopes_of_the_energy(kind):
    V, F, fixed, _ = held_tube()
    solver = Deformation(V, F, fixed, obstacles=[beside(kind)], **STIFF)
    found, h = [], 0.01
    for way in (0.7 - h, 0.7, 0.7 + h):
        solver.aim(V[fixed], shifts=[-way * X])
        while not solver.settled:
            solver.iterate()
        inside = solver.contact
        found.append(
            (inside.energy + inside.contact.energy_at(inside.progress.U), solver.frame().loads[0, 0])
        )
    (before, _), (_, load), (after, _) = found
    assert load == pytest.approx((after - before) / (2.0 * h), rel=0.01)


def test_deformation_has_the_shape_without_obstacles_where_none_is_in_the_way():
    V, F, fixed, high = held_tube()
    targets = V.copy()
    targets[high] += 0.3 * Y
    shapes = []
    for obstacles in ([], [sphere([9.0, 0.0, 0.0], 1.0)]):
        solver = Deformation(V, F, fixed, handle=high, obstacles=obstacles, **STIFF)
        solver.aim(targets[fixed], shifts=np.tile(0.5 * X, (len(obstacles), 1)))
        shapes.append(settle(solver, obstacles))
    assert np.abs(shapes[0].U - shapes[1].U).max() <= 1e-3
    assert not shapes[1].loads.any()
    assert np.array_equal(shapes[1].shifts, [[0.5, 0.0, 0.0]])


def test_deformation_between_two_plates_is_a_press():
    """With nothing held: the same loads, and no turn of the whole."""
    V, F = tube(16, 16)
    rest = RestMesh(V, F)
    press = PlatePress(rest, X, 1.6, 2, stiffness=0.001)
    steps, way = list(press.steps()), press.travel
    places = rest.centre + np.outer([way.low, way.high], X)
    plates = [plate(place, side * X, rest.diagonal) for place, side in zip(places, (1.0, -1.0), strict=True)]
    solver = Deformation(V, F, [], obstacles=plates, **STIFF)
    whole = 0.5 * press.travel.length
    for k, step in enumerate(steps[1:], start=1):
        solver.aim(NOBODY, shifts=k / 2 * whole * np.array([X, -X]))
        frame = settle(solver, plates)
        assert frame.converged
        assert -frame.loads[0, 0] == pytest.approx(step.load_low, rel=0.01)
        assert frame.loads[1, 0] == pytest.approx(step.load_high, rel=0.01)
        assert solver.contact.energy_in_contact == pytest.approx(step.energy, rel=0.01)


@pytest.mark.night
def test_deformation_of_what_nothing_holds_slides_and_does_not_turn_as_a_whole():
    """A sphere that pushes beside the centre would turn it."""
    V, F = tube(16, 16)
    height = np.ptp(V[:, 2])
    obstacles = [sphere([1.5, 0.0, 0.8 * height], 0.4)]
    solver = Deformation(V, F, [], obstacles=obstacles, **STIFF)
    solver.aim(NOBODY, shifts=[-0.8 * X])
    frame = settle(solver, obstacles)
    assert frame.share_reached == 1.0
    turn = fitted_motion(V, frame.U)[:3, :3]
    assert np.degrees(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))) <= 2.0
    assert (frame.U - V).mean(axis=0)[0] < -0.3


def test_deformation_stops_an_obstacle_that_meets_what_is_held_and_says_so():
    V, F, _, _ = held_tube()
    obstacles = [beside("sphere")]
    held = np.flatnonzero(V[:, 0] > -0.9)
    solver = Deformation(V, F, held, obstacles=obstacles, **STIFF)
    solver.aim(V[held], shifts=[-1.0 * X])
    frame = settle(solver, obstacles)
    assert 0.05 < frame.share_reached < 0.15
    assert np.allclose(frame.shifts, [-frame.share_reached * X])
    assert frame.unreached == f"Contact stops the obstacle at {int(100 * frame.share_reached)} % of the path."
    assert not frame.converged


def test_deformation_aim_goes_on_from_a_shape_with_obstacles_where_they_were():
    V, F, fixed, _ = held_tube()
    obstacles = [beside("sphere")]
    first = Deformation(V, F, fixed, obstacles=obstacles, **STIFF)
    first.aim(V[fixed], shifts=[-0.7 * X])
    frame = settle(first, obstacles)
    for begin in (frame.shifts, None):
        other = Deformation(V, F, fixed, obstacles=obstacles, **STIFF)
        other.aim(V[fixed], frame.U, shifts=[-0.7 * X], begin=begin)
        again = settle(other, obstacles)
        assert again.energy == pytest.approx(frame.energy, rel=1e-3)
        assert again.loads[0, 0] == pytest.approx(frame.loads[0, 0], rel=0.01)
    other.aim(V[fixed], frame.U, shifts=[-0.9 * X], begin=[-0.7 * X])
    assert np.array_equal(settle(other, obstacles).shifts, [-0.9 * X])


def test_deformation_does_not_begin_from_a_shape_that_an_obstacle_intersects():
    V, F, fixed, _ = held_tube()
    obstacles = [beside("sphere")]
    solver = Deformation(V, F, fixed, obstacles=obstacles, **STIFF)
    solver.aim(V[fixed], V, shifts=[-0.7 * X], begin=[-0.7 * X])
    frame = settle(solver, obstacles)
    assert frame.share_reached == 1.0, "it began at its place"
    solver = Deformation(V, F, fixed, obstacles=[sphere(V[100], 0.2)], **STIFF)
    with pytest.raises(InputError, match="intersects the initial shape"):
        solver.iterate()


def test_deformation_surround_needs_no_other_factor_for_other_obstacles():
    V, F, fixed, _ = held_tube()
    made = []

    def factored(matrix, _):
        made.append(matrix)
        return LinearSolver(matrix())

    solver = Deformation(V, F, fixed, obstacles=[beside("sphere")], factored=factored, **STIFF)
    before = len(made)
    solver.replace_obstacles([beside("cylinder")])
    solver.aim(V[fixed], V, shifts=[-0.6 * X])
    frame = settle(solver, [beside("cylinder")])
    assert len(made) == before
    fresh = Deformation(V, F, fixed, obstacles=[beside("cylinder")], **STIFF)
    fresh.aim(V[fixed], shifts=[-0.6 * X])
    assert frame.loads[0, 0] == pytest.approx(settle(fresh, [beside("cylinder")]).loads[0, 0], rel=0.01)


def test_deform_takes_obstacles_along_a_path_in_equal_parts():
    V, F, fixed, high = held_tube()
    aside = V.copy()
    aside[high] += 0.2 * Y
    seen = []
    result = deform(
        V,
        F,
        fixed,
        np.array([aside[fixed], V[fixed]]),
        handle=high,
        obstacles=[beside("sphere")],
        shifts=[-0.6 * X],
        progress=lambda frame: seen.append(frame.shifts[0, 0]),
        **STIFF,
    )
    assert np.array_equal(result.shifts, [-0.6 * X])
    assert -0.3 in np.round(seen, 9)
    assert result.loads[0, 0] > 0.1


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"contact": False, "obstacles": [sphere([9, 0, 0], 1.0)]}, "Obstacles need contact"),
        ({"contact": True}, "No vertices are held"),
        ({"contact": True, "method": "paper", "obstacles": [sphere([9, 0, 0], 1.0)]}, "method"),
    ],
)
def test_deformation_refuses_obstacles_that_cannot_be(more, words):
    V, F = tube(8, 4)
    with pytest.raises(InputError, match=words):
        Deformation(V, F, [], **more)


@pytest.mark.parametrize("shifts", [[[0, 0, 1], [0, 0, 1]], [[0, 0, np.nan]], [0, 0, 1]])
def test_deformation_aim_takes_only_one_shift_for_each_obstacle(shifts):
    V, F = tube(8, 4)
    solver = Deformation(V, F, [], contact=True, obstacles=[sphere([9, 0, 0], 1.0)])
    with pytest.raises(InputError, match="one for each obstacle"):
        solver.aim(NOBODY, shifts=shifts)


def pushed_and_let_go(**settings):
    """Half a tube's width pushed in at its side by a cylinder that goes back again; both frames."""
    V, F, fixed, _ = held_tube()
    obstacles = [capsule(1.5 * Z + 1.35 * X - 2.0 * Y, 1.5 * Z + 1.35 * X + 2.0 * Y, 0.3)]
    solver = Deformation(V, F, fixed, method="arap", obstacles=obstacles, **STIFF | settings)
    frames = []
    for shift in (-0.5 * X, 0.0 * X):
        solver.aim(V[fixed], shifts=[shift])
        for _ in range(2500):
            if solver.settled:
                break
            solver.iterate()
        assert solver.settled
        frames.append(solver.frame())
    return solver, frames


def test_deformation_keeps_a_crease_that_an_obstacle_has_bent_and_begins_without_at_rest():
    V = held_tube()[0]
    (_, (_, free)), (solver, (pushed, creased)) = pushed_and_let_go(), pushed_and_let_go(yield_radius=2.0)
    assert np.abs(free.U - V).max() < 1e-3
    assert 0.05 < np.abs(creased.U - V).max() < np.abs(pushed.U - V).max()
    solver.aim(V[solver.fixed], V, shifts=[0.0 * X])
    assert np.abs(solver.step().U - V).max() < 1e-9


@pytest.mark.night
def test_deformation_lets_go_of_less_volume_with_gas_that_it_encloses():
    (solver, (free, _)), (_, (gas, _)) = pushed_and_let_go(), pushed_and_let_go(gas=20.0)
    lost = [1.0 - frame.volume_capped / solver.rest.volume_capped for frame in (free, gas)]
    assert 0.0 < lost[1] < 0.5 * lost[0]


@pytest.mark.parametrize("given", [{"gas": 1.0}, {"yield_radius": 1.0, "stiffness": 0.01}])
def test_deformation_refuses_creases_and_gas_without_contact(given):
    V, F, fixed, _ = held_tube()
    with pytest.raises(InputError, match="need contact"):
        Deformation(V, F, fixed, **given)
