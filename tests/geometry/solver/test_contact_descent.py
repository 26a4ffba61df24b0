"""Surfaces that do not pass through themselves: frames on the way and the last, by another library."""

from functools import cache

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import box, ends, grid, moved, rotation, sample_bottle, sphere, tube
from scipy.spatial.distance import pdist

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.distances import gaps
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.touching_surface import TouchingElasticSurface

Y, Z = np.eye(3)[1:]


@cache
def bottle():
    """A coarse bottle, its held vertices and its cap."""
    V, F, labels = sample_bottle(2.5)
    return V, F, np.flatnonzero(labels != 1), np.flatnonzero(labels == 2)


def bottle_at(R=None, shift=(0.0, 0.0, 0.0)):
    """Where the held vertices of the bottle are with its cap turned and shifted."""
    V, _, fixed, cap = bottle()
    U = V.copy()
    U[cap] = moved(V[cap], R, shift)
    return U[fixed]


TWIST = rotation(Y, np.radians(150.0))


def hairpin():
    """A strip bent around, its held arms, and the upper one of them."""
    V, F = grid(20, 6, 0.25, 0.25)
    x, R = V[:, 0], 1.0 / np.pi
    turn = np.pi * np.clip(x - 2.0, 0.0, 1.0)
    V = np.column_stack(
        [
            np.where(x < 2, x, np.where(x > 3, 5 - x, 2 + R * np.sin(turn))),
            V[:, 1] + 0.02 * x,
            -R * np.cos(turn),
        ]
    )
    upper = np.flatnonzero(x >= 3.1)
    return V, F, np.concatenate([np.flatnonzero(x <= 1.9), upper]), upper


def closed_hairpin():
    """Targets that lead its upper arm through the lower one."""
    V, _, fixed, upper = hairpin()
    U, pivot = V.copy(), np.array([2.0, 0.0, 1.0 / np.pi])
    U[upper] = (V[upper] - pivot) @ rotation(Y, -np.radians(40.0)).T + pivot
    return U[fixed]


def settle(solver, targets, most=1500, area_too=True, **more):
    """Iterate to the end; every third frame and the last are checked. That one, and how many there were."""
    checked = CrossingCheck(solver.rest.solve_mesh.V, solver.rest.solve_mesh.F)
    solver.aim(targets, **more)
    for count in range(most):
        if solver.settled:
            break
        frame = solver.step()
        assert count % 3 or not checked.crosses(frame.U), f"frame {count}"
        assert not area_too or abs(frame.area_error) <= 1e-9
    frame = solver.frame()
    assert not checked.crosses(frame.U)
    return frame, count


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"method": "local", "area": 100.0},
        pytest.param({"method": "arap", "area": 100.0}, marks=pytest.mark.night),
        pytest.param({"stiffness": 0.001}, marks=pytest.mark.night),
        pytest.param({"volume": 80.0}, marks=pytest.mark.night),
        pytest.param({"regions": [Region("label", np.arange(300, 700), 100.0)]}, marks=pytest.mark.night),
    ],
    ids=lambda asked: " ".join(asked) or "exact",
)
def test_contact_descent_has_no_frame_of_a_twist_beyond_touching_cross_itself(asked):
    V, F, fixed, cap = bottle()
    solver = Deformation(V, F, fixed, handle=cap, contact=True, **asked)
    targets = bottle_at(TWIST)
    most = 120 if "volume" in asked else 70
    frame, count = settle(solver, targets, most)
    assert frame.converged or count == most - 1
    assert frame.share_reached == 1.0
    assert np.array_equal(frame.U[fixed], targets)
    if "volume" in asked:
        assert volume(frame.U, F) == pytest.approx(0.8 * volume(V, F), rel=1e-8)


def test_contact_descent_pushes_a_bottle_together_without_crossing():
    V, F, fixed, cap = bottle()
    solver = Deformation(V, F, fixed, handle=cap, contact=True)
    checked, base = CrossingCheck(V, F), np.setdiff1d(fixed, cap)
    solver.aim(bottle_at(shift=-11.0 * Y))
    for count in range(160):
        frame = solver.step()
        assert count % 4 or not checked.crosses(frame.U)
        assert abs(frame.area_error) <= 1e-9
        assert np.array_equal(frame.U[base], V[base])
        assert np.allclose(pdist(frame.U[cap[::7]]), pdist(V[cap[::7]]), rtol=1e-12)
    assert frame.contact.pairs > 0


def test_deform_with_contact_gives_the_shapes_without_it_where_nothing_touches():
    V, F, fixed, cap = bottle()
    targets = bottle_at(rotation(Y, np.radians(60.0)))
    without, with_contact = (
        deform(V, F, fixed, targets, handle=cap, contact=contact) for contact in (False, True)
    )
    size = np.ptp(V, axis=0).max()
    assert with_contact.converged
    assert with_contact.energy == pytest.approx(without.energy, rel=1e-4)
    assert with_contact.volume == pytest.approx(without.volume, rel=1e-4)
    assert np.abs(with_contact.U - without.U).max() <= 1e-2 * size


@pytest.mark.parametrize("told", [True, False], ids=["handle", "no handle named"])
def test_contact_descent_stops_a_handle_says_so_and_lets_it_go_back(told):
    V, F, fixed, upper = hairpin()
    solver = Deformation(V, F, fixed, handle=upper if told else None, contact=True)
    solver.aim(closed_hairpin())
    while not solver.contact.is_stopped:
        solver.iterate()
    assert not solver.settled, "it has yet to converge where it is"
    frame, _ = settle(solver, closed_hairpin())
    assert solver.settled
    assert 0.2 < frame.share_reached < 0.9
    assert not frame.converged
    percent = int(100 * frame.share_reached)
    assert frame.unreached == f"Contact stops the handle at {percent} % of the path."
    assert np.allclose(pdist(frame.U[upper]), pdist(V[upper]), rtol=1e-12), "it is there as a whole"
    frame, _ = settle(solver, V[fixed])
    assert frame.converged
    assert frame.unreached is None
    assert frame.share_reached == 1.0
    assert np.abs(frame.U - V).max() <= 1e-3 * np.ptp(V, axis=0).max()


def test_touching_surface_follows_held_vertices_that_touch_it():
    """Shifted all alike, they take it along: springs pull from what moves, not back to where it was."""
    V, _, fixed, cap = bottle()
    solver = Deformation(*bottle()[:2], fixed, handle=cap, contact=True)
    solver.aim(bottle_at(shift=-0.5 * np.ptp(V[:, 1]) * Y))
    inside, held = solver.contact, np.isin(np.arange(len(V)), fixed)
    while inside.is_on_its_way:
        solver.iterate()
    surface, shift = TouchingElasticSurface(inside.surface, inside.contact), np.array([1.0, 2.0, 3.0])
    assert surface.renew_metric((), np.zeros(0))
    assert inside.contact.springs(surface.U)[~held][:, held].nnz > 0
    there = surface.following_positions(inside.held_positions, inside.held_positions + shift)
    assert np.allclose(there - surface.U[surface.free], shift, atol=1e-6)


def test_contact_energy_at_is_that_of_the_shape_even_after_a_refused_move():
    """Steps descend in the energy of where they are, not of where they have been."""
    V, F, fixed, upper = hairpin()
    solver = Deformation(V, F, fixed, handle=upper, contact=True)
    solver.aim(closed_hairpin())
    inside = solver.contact  # its gap energy is in no frame
    held = np.zeros(len(V), np.int64)
    held[fixed] = 1
    held[upper] = 2
    reach, stiffness = 1e-3 * solver.rest.diagonal, float(solver.rest.solve_mesh.L.diagonal().mean())
    fresh, seen = Contact(V, F, held, stiffness, reach), 0
    for step in range(150):
        solver.iterate()
        if step % 5 == 0 and inside.contact.touching_pairs:
            U = inside.progress.U
            fresh.start_at(U)
            seen += fresh.energy_at(U) > 0.0
            assert inside.contact.energy_at(inside.progress.U) == pytest.approx(fresh.energy_at(U), rel=1e-9)
    assert seen >= 5


def test_contact_descent_does_not_take_what_is_refused_for_the_end():
    """A shape that cannot be reached leaves the last one; the surface has not come to rest there."""
    V, F, fixed, cap = bottle()
    solver = Deformation(V, F, fixed, handle=cap, contact=True)
    frame, _ = settle(solver, bottle_at(TWIST))
    energy = frame.energy
    for _ in range(60):
        frame = solver.step()
    assert frame.energy == pytest.approx(energy, rel=1e-3)


def test_deform_without_contact_lets_the_same_twist_cross_itself():
    V, F, fixed, cap = bottle()
    result = deform(V, F, fixed, bottle_at(TWIST), handle=cap, contact=False)
    assert CrossingCheck(V, F).crosses(result.U)


@pytest.mark.parametrize(("scale", "away"), [(1e-6, 0.0), (1e3, 1e6)])
def test_contact_descent_depends_neither_on_the_unit_nor_on_the_origin(scale, away):
    V, F, fixed, upper = hairpin()
    shapes = []
    for unit, shift in ((1.0, 0.0), (scale, away)):
        solver = Deformation(unit * V + shift, F, fixed, handle=upper, contact=True)
        frame, _ = settle(solver, unit * closed_hairpin() + shift)
        shapes.append((frame.U - shift) / unit)
        assert 0.2 < frame.share_reached < 0.9
    assert np.abs(shapes[0] - shapes[1]).max() <= 0.02 * np.ptp(V, axis=0).max()


def two_spheres(apart, level=3):
    """Two balls, each with a base below; and the second one's lid."""
    V, F = sphere(level)
    W = np.vstack([V, V + [apart, 0.03, 0.02]])
    G = np.vstack([F, F + len(V)])
    low = W[:, 2] < -0.8
    high = (W[:, 2] > 0.8) & (np.arange(len(W)) >= len(V))
    return W, G, np.flatnonzero(low | high), np.flatnonzero(high)


def test_contact_descent_lets_what_crosses_at_rest_stay_and_nothing_else_cross():
    V, F, fixed, lid = two_spheres(1.7)
    rest = crossings(V, F)
    assert len(rest)
    solver = Deformation(V, F, fixed, handle=lid, contact=True)
    U = V.copy()
    U[lid] += [-0.8, 0.0, -0.6]
    exempt = solver.contact.contact.exempt_vertices
    checked = CrossingCheck(V, F, exempt)
    solver.aim(U[fixed])
    for count in range(100):
        frame = solver.step()
        if count % 5:
            continue
        assert not checked.crosses(frame.U)
        assert np.isin(F[crossings(frame.U, F)], exempt).any(axis=1).all()
    without = deform(V, F, fixed, U[fixed], handle=lid, contact=False)
    assert not np.isin(F[crossings(without.U, F)], exempt).any(axis=1).all()
    solver.aim(U[fixed], frame.U)
    assert np.abs(solver.step().U - frame.U).max() <= 0.1, "it may be entered again"


def test_contact_descent_lets_no_held_pieces_pass_through_each_other():
    V, F, fixed, lid = two_spheres(2.3, 2)
    solver = Deformation(V, F, fixed, handle=lid, contact=True)
    U = V.copy()
    U[lid] += [-1.2, 0.0, 0.0]
    frame, _ = settle(solver, U[fixed], most=300)
    without = deform(V, F, fixed, U[fixed], handle=lid, contact=False)
    assert CrossingCheck(V, F).crosses(without.U)
    assert np.ptp(frame.U, axis=0).max() > 1.0


def hairpin_with_ball(height):
    """The hairpin with a loose ball between its arms, as far from both as ``height`` tells."""
    V, F, fixed, upper = hairpin()
    ball, G = sphere(1)
    return np.vstack([V, 0.15 * ball + [0.2, 0.75, height]]), np.vstack([F, G + len(V)]), fixed, upper


def test_contact_descent_takes_a_loose_piece_far_away_along():
    V, F, fixed, upper = hairpin_with_ball(3.0)
    solver = Deformation(V, F, fixed, handle=upper, contact=True)
    frame, _ = settle(solver, closed_hairpin())
    ball = np.setdiff1d(np.arange(len(V)), np.unique(hairpin()[1]))
    assert np.allclose(pdist(frame.U[ball]), pdist(V[ball]), rtol=1e-9)
    assert frame.contact.exempt == len(ball)
    (warning, *_) = solver.warnings
    assert warning.endswith("Contact keeps them apart from all but the surface that they go along with.")


@cache
def share_reached_alone():
    """How far the hairpin closes."""
    V, F, fixed, upper = hairpin()
    frame, _ = settle(Deformation(V, F, fixed, handle=upper, contact=True), closed_hairpin())
    return frame.share_reached


@pytest.mark.parametrize("loose", ["go", "stay"])
@pytest.mark.parametrize("height", [-0.11, 0.11], ids=["on the lower arm", "below the upper one"])
def test_contact_descent_stops_at_a_loose_piece_in_the_way_which_passes_through_no_wall(height, loose):
    V, F, fixed, upper = hairpin_with_ball(height)
    without = deform(V, F, fixed, closed_hairpin(), handle=upper, loose=loose, contact=False)
    assert CrossingCheck(V, F).crosses(without.U)
    solver = Deformation(V, F, fixed, handle=upper, contact=True, loose=loose)
    frame, _ = settle(solver, closed_hairpin())
    assert 0.0 < frame.share_reached < share_reached_alone() - 0.1
    assert "Contact stops the handle" in frame.unreached


def test_loose_components_choose_lets_no_other_pieces_stay_where_no_free_way_may_lead():
    V, F, fixed, upper = hairpin_with_ball(-0.11)
    solver = Deformation(V, F, fixed, handle=upper, contact=True, loose="go")
    solver.loose.set_loose_motion("go")
    with pytest.raises(InputError, match="make another Deformation"):
        solver.loose.set_loose_motion("stay")


def test_contact_descent_lets_a_loose_piece_cross_the_wall_that_carries_it():
    """A button that is sunk into a wall, or lies close on it, does not stop the wall from bending."""
    V, F, fixed, cap = bottle()
    ball, G = sphere(1)
    at = V[np.argmin(np.abs(V - [3.2, 9.0, 0.0]).sum(axis=1))]
    sunk = Deformation(
        np.vstack([V, 0.4 * ball + at]), np.vstack([F, G + len(V)]), fixed, handle=cap, contact=True
    )
    alone = Deformation(V, F, fixed, handle=cap, contact=True)
    targets = bottle_at(rotation(Y, np.radians(40.0)))
    for solver in (sunk, alone):
        solver.aim(targets)
        while not solver.settled:
            frame = solver.step()
        assert frame.share_reached == 1.0
    assert sunk.frame().energy == pytest.approx(frame.energy, rel=1e-3)


def test_deform_walks_a_path_of_targets_and_tells_the_share_of_the_whole():
    V, F, fixed, upper = hairpin()
    aside = V.copy()
    aside[upper] += 0.4 * Y
    path = np.array([aside[fixed], V[fixed], closed_hairpin()])
    checked, seen = CrossingCheck(V, F), []

    def look(frame):
        seen.append(frame.U)
        assert not checked.crosses(frame.U)

    result = deform(V, F, fixed, path, handle=upper, contact=True, progress=look)
    direct = deform(V, F, fixed, path[-1], handle=upper, contact=True)
    assert direct.share_reached < 0.9
    assert result.share_reached == pytest.approx((2.0 + direct.share_reached) / 3.0, abs=0.02)
    assert f"at {int(100 * result.share_reached)} % of the path" in result.warnings[-1]
    assert not result.converged
    assert max(np.abs(U[fixed] - path[0]).max() < 1e-12 for U in seen), "the first point was reached"


def test_deform_walks_a_turn_beyond_a_half_by_its_way_points():
    V, F = tube(12, 24)
    low, high = ends(V)
    fixed, angles = np.concatenate([low, high]), np.radians([45, 90, 135, 180, 225])
    path = np.array([np.concatenate([V[low], moved(V[high], rotation(Z, a))]) for a in angles])
    result = deform(V, F, fixed, path, handle=high)
    at_once = deform(V, F, fixed, path[-1], handle=high)
    assert result.energy > 2.0 * at_once.energy, "at once it is a turn by 135 degrees the other way"
    assert (result.share_reached, result.converged) == (1.0, True)
    with pytest.raises(InputError, match="follow no path"):
        deform(V, F, fixed, path, iterations=5)


@pytest.mark.parametrize("thickness", [0.02, 0.1])
def test_contact_descent_keeps_walls_in_contact_about_the_thickness_apart(thickness):
    V, F, fixed, upper = hairpin()
    solver = Deformation(V, F, fixed, handle=upper, contact=True, thickness=thickness)
    frame, _ = settle(solver, closed_hairpin())
    assert frame.share_reached < 1.0
    T = F[np.isin(F, np.setdiff1d(fixed, upper)).all(axis=1)]
    pairs = np.array([(v, *t) for v in upper for t in T])
    least = gaps(frame.U, pairs, np.zeros(len(pairs), bool)).min()
    assert 0.0 < least <= thickness
    assert least >= 0.005 * thickness


def test_contact_descent_lets_two_handles_arrive_each_by_its_own_path():
    V, F = tube(16, 40)
    low, high = ends(V)
    middle = np.flatnonzero(np.abs(V[:, 2] - V[:, 2].mean()) < 0.2)
    fixed = np.concatenate([low, high, middle])
    solver = Deformation(V, F, fixed, handle=[high, middle], contact=True)
    U = V.copy()
    U[high] = moved(V[high], rotation(Z, 2.5))
    U[middle] = moved(V[middle], shift=(1.5, 0.0, -1.0))
    frame, _ = settle(solver, U[fixed], most=600)
    assert np.array_equal(frame.U[fixed], U[fixed])


@pytest.mark.parametrize("thickness", [0.0, -1.0, float("nan"), float("inf"), "thin"])
def test_deformation_refuses_a_thickness_that_is_no_length(thickness):
    V, F = box()
    with pytest.raises(InputError, match="thickness"):
        Deformation(V, F, np.arange(4), contact=True, thickness=thickness)


@pytest.mark.parametrize("method", ["paper", "sr-arap"])
def test_check_contact_refuses_methods_that_descend_in_no_energy(method):
    V, F = box()
    with pytest.raises(InputError, match="Contact needs"):
        Deformation(V, F, np.arange(4), handle=np.arange(2), method=method, contact=True)
    with pytest.raises(InputError, match="Contact needs"):
        deform(V, F, np.arange(4), V[:4], iterations=3, contact=True)


def test_contact_descent_is_not_locked_by_vertices_that_hang_on_an_edge_at_rest():
    """Two sheets side by side, one with twice as many vertices on the seam."""
    V, F = grid(4, 4)
    W, G = grid(8, 8, 0.5, 0.5)
    X, H = np.vstack([V, W + [4.0, 0.0, 0.0]]), np.vstack([F, G + len(V)])
    left, right = ends(X, 0)
    fixed = np.concatenate([left, right])
    solver = Deformation(X, H, fixed, handle=right, contact=True)
    U = X.copy()
    U[right] = moved(X[right], rotation([1.0, 0.0, 0.0], 0.5), (-0.5, 0.0, 1.0))
    solver.aim(U[fixed])
    for _ in range(60):
        frame = solver.step()
    assert frame.share_reached == 1.0
    assert np.array_equal(frame.U[fixed], U[fixed])
    solver.aim(U[fixed], frame.U)
    assert np.abs(solver.step().U - frame.U).max() <= 0.1


def test_deformation_share_reached_is_of_the_whole_way_however_often_it_is_aimed_anew():
    V, F = tube(24, 24)
    low, high = ends(V)
    fixed = np.concatenate([low, high])
    solver = Deformation(V, F, fixed, handle=high, contact=True)
    height = float(np.ptp(V[:, 2]))
    for share in (0.1, 0.2):
        targets = V[fixed].copy()
        targets[len(low) :, 2] -= share * height
        solver.aim(targets)
        solver.iterate()
    way = V[high, 2] - solver.frame().U[high, 2]
    assert solver.share_reached == pytest.approx(way.mean() / (0.2 * height), abs=1e-6)


def test_deformation_refuses_walls_as_thick_as_the_mesh():
    V, F = tube(12, 8)
    with pytest.raises(InputError, match="at most"):
        Deformation(V, F, ends(V)[0], contact=True, thickness=float(np.ptp(V)))


@pytest.mark.parametrize("percent", [pytest.param(20.0, marks=pytest.mark.night), 95.0])
def test_contact_descent_says_an_area_out_of_reach_and_meets_one_within_reach(percent):
    V, F = box(2, 2, 6)
    base, end = ends(V)
    fixed = np.concatenate([base, end])
    solver = Deformation(V, F, fixed, handle=end, contact=True)
    bent = np.concatenate([V[base], moved(V[end], rotation(Y, 0.6), (0.5, 0.0, -0.3))])
    settle(solver, bent)
    solver.keep(area=percent)
    frame, _ = settle(solver, bent, area_too=False)
    assert frame.settled
    assert (frame.unreached is None) == (percent > 50.0)
    assert (abs(frame.area_error - (percent / 100.0 - 1.0)) <= 1e-9) == (percent > 50.0)
