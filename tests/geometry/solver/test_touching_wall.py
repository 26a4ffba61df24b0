"""The thin wall as it is deformed: laws of theory, goals to the last digits, no wall through a wall."""

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import ends, grid, moved, rotation, sample_bottle, sphere, tube
from scipy.spatial import ConvexHull, Delaunay

import apd_viewer
from apd_viewer import Convergence, Deformation
from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.contact.contact_obstacles import plate, sphere as ball_obstacle
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints
from apd_viewer.geometry.solver.methods import check_wall_size
from apd_viewer.verification.press_cases import LIFT_OFF, flattened_load, flattened_volume
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


def irregular(ring):
    """A tube of the vertices of another one, all but the rims displaced, triangulated by Delaunay."""
    around, height = np.arctan2(ring[:, 1], ring[:, 0]), ring[:, 2].copy()
    edge = 2 * np.pi / (ring[:, 2] == 0.0).sum()
    inside = (height > 0.0) & (height < height.max())
    rng = np.random.default_rng(0)
    around += rng.uniform(-0.3 * edge, 0.3 * edge, len(ring))
    height[inside] += rng.uniform(-0.25 * edge, 0.25 * edge, inside.sum())
    turns = np.arange(-1, 2)[:, None] * 2 * np.pi
    flat = np.column_stack([(around + turns).ravel(), np.tile(height, 3)])
    T = Delaunay(flat).simplices
    A, B, C = (flat[T[:, k]] for k in range(3))
    up = (B[:, 0] - A[:, 0]) * (C[:, 1] - A[:, 1]) - (B[:, 1] - A[:, 1]) * (C[:, 0] - A[:, 0])
    T = np.where(up[:, None] > 0, T, T[:, ::-1])
    middle = flat[T].mean(axis=1)[:, 0]
    T = T[(np.abs(up) > 1e-3 * edge**2) & (middle >= 0.0) & (middle < 2 * np.pi)] % len(ring)
    return np.column_stack([np.cos(around), np.sin(around), height]), T


RINGS = {
    "even": lambda n: tube(n, 4),
    "flattened": lambda n: tube(n, 5, height=5 * 0.66 * 2 * np.pi / n),
    "flatter": lambda n: tube(n, 8, height=8 * 0.4 * 2 * np.pi / n),
    "irregular": lambda n: irregular(tube(n, 4)[0]),
}


def section(U, T):
    """Volume of a tube along z, but for turns about other axes, over its height."""
    X = U[T]
    normals = 0.5 * np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
    axis = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    middle = X.mean(axis=1) - U.mean(axis=0)
    return 0.5 * abs((middle * normals).sum() - ((middle @ axis) * (normals @ axis)).sum())


def test_press_flattens_a_thin_ring_with_the_load_of_theory():
    """At a radius of 100 thicknesses cells would carry 1.4 to 1.75 times as much, by how the rows lie."""
    check_ring(*RINGS["irregular"](60), 100, 1.0, 3, load=0.02, volume=0.005)


@pytest.mark.night
@pytest.mark.parametrize("kind", RINGS)
@pytest.mark.parametrize("slenderness", [30, 100, 300])
@pytest.mark.parametrize("around", [100, 200])
def test_press_flattens_thin_rings_to_three_tenths_with_the_load_of_theory(around, slenderness, kind):
    check_ring(*RINGS[kind](around), slenderness, 0.6, 7, load=0.01, volume=0.0025)


def check_ring(ring, T, slenderness, to, steps, load, volume):
    """Press a ring, and hold loads and volumes once it has lifted off flat against theory."""
    thickness, width = 1 / slenderness, np.ptp(ring[:, 2])
    how = {"method": "wall", "wall_thickness": thickness, "poisson": 0.0, "thickness": 0.001}
    found = apd_viewer.press(ring, T, X, to, steps, area=100, **how)
    rigidity = Material(thickness=thickness).plate_rigidity
    flat = [step for step in found.steps if np.ptp(step.U[:, 0]) < LIFT_OFF]
    # A ring that tips over between the plates is as wide as at rest again.
    assert len(flat) == (np.linspace(2.0, to, steps + 1) < LIFT_OFF).sum()
    for step in flat:
        gap = np.ptp(step.U[:, 0])
        for side in (step.load_low, step.load_high):
            assert side / (rigidity * width) == pytest.approx(flattened_load(gap), rel=load)
        assert section(step.U, T) / section(ring, T) == pytest.approx(flattened_volume(gap), rel=volume)
        assert step.settled
        assert abs(step.area_error) < 1e-8
        assert step.crossings == 0
    assert found.load_excess == 0.0


def ball_fine_at_its_poles(finest, largest=0.12, growth=1.1):
    """A unit sphere of rings about x, whose edges grow from the poles to the equator."""
    polar, edge = [0.0], finest
    while polar[-1] < np.pi / 2:
        polar.append(polar[-1] + np.sqrt(0.75) * edge)
        edge = min(largest, growth * edge)
    half = np.array(polar) * np.pi / 2 / polar[-1]
    polar = np.concatenate([half, np.pi - half[-2::-1]])
    between, rings = np.diff(polar) / np.sqrt(0.75), [[[1.0, 0.0, 0.0]]]
    for k, angle in enumerate(polar[1:-1], start=1):
        count = max(3, round(2 * np.pi * np.sin(angle) / between[k]))
        around = 2 * np.pi * (np.arange(count) + 0.5 * (k % 2)) / count
        across = np.sin(angle) * np.array([np.cos(around), np.sin(around)])
        rings.append(np.column_stack([np.full(count, np.cos(angle)), *across]))
    ball = np.vstack([*rings, [[-1.0, 0.0, 0.0]]])
    T = ConvexHull(ball).simplices.astype(int)
    outward = np.einsum("ij,ij->i", np.cross(ball[T[:, 1]], ball[T[:, 2]]), ball[T[:, 0]]) > 0.0
    return ball, np.where(outward[:, None], T, T[:, ::-1])


def shallow_slope(thickness, poisson=0.3):
    """Load over deflection of a unit sphere between two points [Reissner 1946], at Et = 4."""
    return 16.0 * thickness / np.sqrt(3.0 * (1.0 - poisson**2))


@pytest.mark.night
def test_press_meets_the_slope_of_a_sphere_between_plates():
    thickness = 1 / 200
    ball, T = ball_fine_at_its_poles(0.0044)
    how = {"method": "wall", "wall_thickness": thickness, "poisson": 0.3, "thickness": 1e-3 * thickness}
    tight = Convergence(energy_tolerance=1e-9)
    found = apd_viewer.press(ball, T, X, 2.0 - 0.045 * thickness, 3, convergence=tight, **how)
    assert all(step.settled for step in found.steps)
    deflections = [1.0 - 0.5 * np.ptp(step.U[:, 0]) for step in found.steps[1:]]
    for loads in ([getattr(step, name) for step in found.steps[1:]] for name in ("load_low", "load_high")):
        slopes = np.diff(loads) / np.diff(deflections)
        np.testing.assert_allclose(slopes, shallow_slope(thickness), rtol=0.03)


# Whole: the share of that slope by linear theory without the assumption that the dent is shallow, from the
# equations of Kirchhoff and Love about the axis by Ritz's method with quartic splines.
@pytest.mark.parametrize(
    ("slenderness", "whole"), [(20, 0.947), pytest.param(100, 0.985, marks=pytest.mark.night)]
)
def test_deformation_by_wall_meets_the_slope_of_a_whole_sphere_between_two_points(slenderness, whole):
    thickness = 1 / slenderness
    ball, T = ball_fine_at_its_poles(0.067 * np.sqrt(thickness))
    tips, deflection = np.array([0, len(ball) - 1]), 0.005 * thickness
    how = {"wall_thickness": thickness, "poisson": 0.3, "contact": False}
    tight = Convergence(energy_tolerance=1e-10, imperfection=0.0)
    solver = Deformation(ball, T, tips, handle=tips[1:], method="wall", convergence=tight, **how)
    solver.aim(ball[tips] * (1.0 - deflection))
    *_, frame = settle(solver)
    assert frame.energy / deflection**2 / shallow_slope(thickness) == pytest.approx(whole, rel=0.012)


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
@pytest.mark.parametrize("goals", [{"volume": "95%"}, {"volume": "101%"}, {"area": "97%"}, {"area": "104%"}])
def test_deformation_by_wall_meets_targets_where_nothing_moves(goals, contact):
    """At rest there is no energy, and every shape that meets the target has more."""
    ball, triangles = sphere(2)
    held = np.flatnonzero(ball[:, 2] < -0.8)
    solver = Deformation(ball, triangles, held, method="wall", wall_thickness=0.03, contact=contact, **goals)
    frame = list(settle(solver))[-1]
    assert frame.converged
    for name in goals:
        assert getattr(frame, name) == pytest.approx(solver.target(f"the {name}"), rel=1e-9)
    solver.keep()
    frame = list(settle(solver))[-1]
    assert np.abs(frame.U - ball).max() < 1e-2
    solver.keep(**goals)
    assert list(settle(solver))[-1].converged


@pytest.mark.parametrize("contact", [False, True])
def test_deformation_by_wall_moves_rigidly_with_what_holds_it(contact):
    solver = wall(contact=contact)
    W = moved(V, rotation([1, 2, 3], 0.9), (0.3, -0.2, 0.5))
    solver.aim(W[FIXED])
    *_, frame = settle(solver)
    np.testing.assert_allclose(frame.U, W, atol=1e-6)
    assert frame.energy < 1e-12


def test_deformation_by_wall_draws_what_is_soft_along():
    """Between two motions of the handle the energy never rises: it is that of the springs as they stand."""
    ids = np.setdiff1d(np.flatnonzero(V[:, 2] > 0.7 * V[:, 2].max()), FIXED)
    soft = SoftConstraints(ids, np.full(len(ids), 0.5), np.full(len(ids), 0.5), np.zeros(len(ids), int))
    W = V @ rotation([0, 0, 1], 0.5).T
    turned, drawn = np.vstack([V[BASE], W[HANDLE]]), []
    for springs in (soft, NO_SOFT_CONSTRAINTS):
        solver, frame = wall(contact=False, soft=springs), None
        solver.aim(turned, soft_targets=W[ids] if len(springs.ids) else None)
        for following in settle(solver):
            if frame is not None and following.share_reached == frame.share_reached:
                assert following.energy <= frame.energy * (1 + 1e-9)
            frame = following
        drawn.append(np.linalg.norm(frame.U[ids] - W[ids], axis=1).mean())
    assert drawn[0] < 0.7 * drawn[1]


def test_deformation_by_wall_stops_at_an_obstacle_that_bends_it():
    """Pressed in by more than twice as much, it may snap through and leave the plate."""
    ball, T = sphere(2)
    solver = Deformation(
        *(ball, T, np.flatnonzero(ball[:, 2] < -0.9)),
        method="wall",
        wall_thickness=0.02,
        contact=True,
        obstacles=[plate([0.0, 0.0, 1.05], [0.0, 0.0, -1.0], 3.0)],
    )
    solver.aim(ball[solver.fixed], shifts=[[0.0, 0.0, -0.12]])
    *_, frame = settle(solver)
    assert frame.U[:, 2].max() < 0.93
    assert frame.share_reached == 1.0
    assert frame.loads[0] @ [0.0, 0.0, 1.0] > 0.02


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


def test_deformation_by_wall_names_joints_of_more_than_two_sheets():
    flat, T = grid(4, 3)
    across = np.column_stack([flat[:, 0], np.full(len(flat), 1.0), flat[:, 1]])
    two, held = np.vstack([flat, across]), [0, 1, 2, 3]
    sheets = np.vstack([T, T + len(flat)])
    said = {method: Deformation(two, sheets, held, method=method).warnings for method in ("wall", "arap")}
    joints = "At 4 edges of more than two triangles the wall bends freely."
    assert joints in said["wall"]
    assert joints not in said["arap"]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"wall_thickness": 10.0}, "A wall is thin"),
        ({"wall_thickness": 1e-9}, "hardly stretches any more"),
        ({"plain": True}, "no plain iterations"),
        ({"yield_radius": 1.0}, "Creases and gas need contact"),
    ],
)
def test_deformation_by_wall_says_what_it_cannot(given, sentence):
    with pytest.raises(InputError, match=sentence):
        Deformation(V, F, FIXED, **{"handle": HANDLE, "method": "wall"} | given)


def test_check_wall_size_refuses_what_would_not_fit_into_memory():
    check_wall_size(100_000)
    with pytest.raises(InputError, match="at most 100,000 vertices"):
        check_wall_size(100_001)


def test_deformation_by_wall_follows_a_hand_that_does_not_wait():
    """Aimed anew before it has settled, the wall goes on, and is where the handle is soon."""
    solver = wall(contact=False)
    for turn in np.radians(np.arange(1, 31)):
        solver.aim(np.vstack([V[BASE], V[HANDLE] @ rotation([0, 0, 1], turn).T]))
        for _ in range(3):
            frame = solver.step()
    assert frame.share_reached > 0.8
    assert frame.energy < 10 * list(settle(solver))[-1].energy


def test_deformation_by_wall_follows_a_finger_that_does_not_wait():
    X, triangles, _ = sample_bottle(edge=3.0)
    base = np.flatnonzero(X[:, 1] < X[:, 1].min() + 0.5)
    finger = ball_obstacle([4.1, 11.0, 0.0], 0.8)
    given = {"wall_thickness": 0.03, "poisson": 0.38, "area": "100%", "contact": True}
    solver = Deformation(X, triangles, base, method="wall", obstacles=[finger], **given)
    energies = []
    for step in range(310):
        solver.aim(X[base], shifts=[[-min(0.05 * step, 2.5), 0.0, 0.0]])
        solver.iterate()
        energies.append(solver.contact.energy_in_contact)
        assert abs(solver.frame().area_error) < 1e-9
    assert solver.share_reached == 1.0
    *_, frame = settle(solver)
    assert frame.converged
    assert max(energies) < 30.0 * frame.energy


@pytest.mark.night
def test_touching_wall_does_not_slide_along_the_plates():
    """Nothing holds it there, and no force moves it: its mean stays where it was."""
    X, triangles, _ = sample_bottle(edge=3.0)
    width = np.ptp(X[:, 0])
    found = apd_viewer.press(
        X, triangles, (1, 0, 0), 0.75 * width, 4, method="wall", wall_thickness=0.03, poisson=0.38
    )
    assert all(step.settled for step in found.steps)
    assert np.abs((found.U - X).mean(axis=0)[1:]).max() < 1e-6 * width


@pytest.mark.night
@pytest.mark.parametrize("contact", [False, True])
def test_deformation_by_wall_comes_to_rest_behind_the_snap_of_a_cylinder(contact):
    """Pressed along its axis: with less energy than a cylinder that stays round, at a minimum."""
    slenderness, height = 100.0, 0.52
    X, triangles = tube(110, round(height / (np.sqrt(3.0) * np.pi / 110)), height=height)
    base, top = ends(X)
    material = Material(thickness=1.0 / slenderness, poisson=0.3)
    solver = Deformation(
        *(X, triangles, np.concatenate([base, top])),
        handle=top,
        method="wall",
        wall_thickness=1.0 / slenderness,
        poisson=0.3,
        contact=contact,
        convergence=Convergence(energy_tolerance=1e-9),
    )
    classical = 1.0 / (slenderness * np.sqrt(3.0 * (1.0 - 0.3**2)))
    for share in np.arange(0.8, 1.21, 0.05):
        solver.aim(X[solver.fixed] * [1.0, 1.0, 1.0 - share * classical])
        frame = list(settle(solver))[-1]
        round_energy = 0.5 * material.tensile_stiffness * (share * classical) ** 2 * 2.0 * np.pi * height
        if share < 0.92:
            assert frame.energy == pytest.approx(round_energy, rel=0.03)
        elif share > 1.12:
            assert frame.energy < 0.85 * round_energy
        assert frame.settled
        assert frame.stable
        assert not len(crossings(frame.U, solver.rest.F))
