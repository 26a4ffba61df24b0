"""Calm parts: what they are, that they keep their area, and that nothing else changes."""

import numpy as np
import pytest
from meshes import character, rotation, tube

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals import calm_parts
from apd_viewer.geometry.goals.calm_parts import (
    calm_level_weights,
    calmness,
    calmness_from_flux,
    log_handle_flux,
)
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import FREE, NO_SOFT_CONSTRAINTS, SoftConstraints
from apd_viewer.geometry.solver.deformation import Deformation

V, F = character()
X, Y = V[:, 0], V[:, 1]
BASE = np.flatnonzero((Y > -0.3) & (Y < 1.0) & (np.abs(X) < 0.62))
HEAD = np.flatnonzero(Y > 2.75)
FIXED = np.concatenate([BASE, HEAD])
REST = RestMesh(V, F)
AREAS, MIDDLE = face_areas(V, F), V[F].mean(axis=1)
LIMBS = {
    "arm": (MIDDLE[:, 0] > 1.0) & (MIDDLE[:, 1] > 1.3),
    "other arm": (MIDDLE[:, 0] < -1.0) & (MIDDLE[:, 1] > 1.3),
    "legs": MIDDLE[:, 1] < -0.8,
}


def turned(axis, degrees, shift=(0.0, 0.0, 0.0), pivot=(0.0, 2.6, 0.0)):
    R = rotation(axis, np.radians(degrees))
    return np.vstack([V[BASE], (V[HEAD] - pivot) @ R.T + pivot + np.array(shift)])


GESTURES = {
    "turned": turned([0, 1, 0], 43),
    "nodding": turned([1, 0, 0], 40),
    "bent about the feet": turned([0, 0, 1], 25, pivot=(0.0, -2.0, 0.0)),
    "pulled": turned([0, 1, 0], 0, (0.0, 1.0, 0.0)),
}


def solver_of(**options):
    return Deformation(V, F, FIXED, handle=HEAD, rest=REST, **options)


def change(U, part):
    return face_areas(U, F)[part].sum() / AREAS[part].sum() - 1.0


@pytest.mark.parametrize("gesture", GESTURES)
def test_calm_parts_keep_the_area_of_limbs_and_all_goals_hold_in_every_frame(gesture):
    solver = solver_of()
    solver.aim(GESTURES[gesture])
    iterations = 0
    while not solver.settled:
        frame = solver.step()
        iterations += 1
        assert abs(frame.area_error) <= 1e-9
        assert len(solver.solver.progress.goal_values) > 1
        assert solver.missed_goals_sentence is None
        assert np.array_equal(frame.U[FIXED], GESTURES[gesture])
        assert iterations < 2000
    for part in LIMBS.values():
        assert abs(change(frame.U, part)) <= 3e-3


def test_deformation_without_calm_parts_shrinks_the_limbs():
    solver = solver_of(calm=False)
    solver.aim(GESTURES["pulled"])
    while not solver.settled:
        solver.iterate()
    assert change(solver.frame().U, LIMBS["legs"]) < -0.1


def test_calm_parts_change_nothing_where_nothing_is_calm():
    W, G = tube(24, 40)
    ends = np.flatnonzero((W[:, 2] == W[:, 2].min()) | (W[:, 2] == W[:, 2].max()))
    top = ends[W[ends, 2] > W[:, 2].mean()]
    targets = np.where(np.isin(ends, top)[:, None], W[ends] @ rotation([0, 0, 1], 1.0).T, W[ends])
    shapes = []
    for calm in (True, False):
        solver = Deformation(W, G, ends, handle=top, calm=calm)
        solver.aim(targets)
        for _ in range(50):
            solver.iterate()
        shapes.append(solver.frame().U)
    assert np.array_equal(*shapes)


@pytest.mark.parametrize("most", [10, pytest.param(42, marks=pytest.mark.night)])
def test_calm_parts_let_steps_of_two_degrees_move_no_vertex_by_a_jump(most):
    steps = {}
    for calm in (True, False):
        solver, shapes = solver_of(calm=calm), []
        for degrees in range(0, most, 2):
            solver.aim(turned([0, 1, 0], degrees))
            for _ in range(300):
                if solver.settled:
                    break
                solver.iterate()
            shapes.append(solver.frame().U)
        moved = np.linalg.norm(np.diff(shapes, axis=0), axis=2).max(axis=1)[1:]
        steps[calm] = moved.max() / np.median(moved)
    assert steps[True] <= max(1.15, 1.01 * steps[False])


@pytest.mark.parametrize(
    "asked",
    [
        {"area": 103.0},
        {"volume": 99.0},
        {"regions": [Region("arm", np.flatnonzero((X > 1.5) & (Y > 1.0)), 105.0)]},
        {"area": 98.0, "volume": 97.0, "regions": [Region("chest", np.flatnonzero((Y > 1) & (Y < 2)), 98.0)]},
    ],
    ids=["area", "volume", "region", "all"],
)
def test_calm_parts_let_other_goals_hold_beside_them(asked):
    solver = solver_of(**asked)
    solver.aim(GESTURES["nodding"])
    for _ in range(800):
        if solver.settled:
            break
        solver.iterate()
    assert solver.missed_goals_sentence is None
    assert len(solver.solver.progress.goal_values) > 1 + len(asked)
    legs = change(solver.frame().U, LIMBS["legs"])
    assert abs(legs - (asked.get("area", 100.0) / 100.0 - 1.0)) <= 5e-3


def test_calm_parts_give_way_where_the_total_cannot_be_kept_with_them_and_come_back():
    solver = solver_of()
    solver.aim(turned([0, 1, 0], 0, (0.0, 6.0, 0.0)))
    while not solver.settled:
        assert abs(solver.step().area_error) <= 1e-9
    frame = solver.frame()
    assert frame.converged
    assert frame.unreached.startswith("Calm parts give way in this pose")
    assert change(frame.U, LIMBS["legs"]) < -0.3
    solver.aim(GESTURES["nodding"])
    while not solver.settled:
        solver.iterate()
    assert solver.frame().unreached is None
    assert abs(change(solver.frame().U, LIMBS["legs"])) < 3e-3


def held():
    ids = np.unique(REST.weld.inverse[FIXED])
    return ids, np.isin(ids, REST.weld.inverse[HEAD]).astype(int)


def test_calm_level_weights_share_the_calm_vertices_among_them():
    ids, handle_of = held()
    x = log_handle_flux(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS)
    levels = calm_level_weights(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS)
    assert levels.min() >= 0.0
    inside = np.setdiff1d(ids, REST.solve_mesh.F[~np.isin(REST.solve_mesh.F, ids).all(axis=1)])
    assert len(inside) > 0
    assert not levels[:, inside].any()
    free = np.setdiff1d(np.arange(len(REST.solve_mesh.V)), ids)
    np.testing.assert_allclose(
        levels[:, free].sum(axis=0), np.clip((-0.5 - x[free]) / 0.5, 0.0, 1.0), rtol=0, atol=1e-12
    )
    assert calmness_from_flux(np.array([0.0, -0.5, -4.0, -9.0])) == pytest.approx([0.0, 0.0, 1.0, 1.0])


def test_calm_level_weights_keep_the_area_of_their_largest_part_apart_from_the_others():
    """The legs, which are connected below the base, and the arms."""
    levels = calm_level_weights(REST.solve_mesh, *held(), NO_SOFT_CONSTRAINTS)
    legs, arms = REST.solve_mesh.V[:, 1] < -0.8, np.abs(REST.solve_mesh.V[:, 0]) > 2.0
    last = levels[-2:]
    assert last[0][legs].min() == 1.0
    assert not last[0][arms].any()
    assert last[1][arms].any()
    assert not last[1][legs].any()


def test_log_handle_flux_of_a_bar_is_the_same_everywhere():
    W, G = tube(24, 40)
    z = W[:, 2]
    ids = np.flatnonzero((z == z.min()) | (z == z.max()))
    x = log_handle_flux(RestMesh(W, G).solve_mesh, ids, (z[ids] > z.mean()).astype(int), NO_SOFT_CONSTRAINTS)
    np.testing.assert_allclose(x, 0.0, atol=1e-9)


def test_log_handle_flux_lets_each_handle_reach_its_own_part():
    """An arm that is a handle too is as little calm as the neck."""
    ids = np.unique(np.append(REST.weld.inverse[FIXED], np.flatnonzero(REST.solve_mesh.V[:, 0] > 2.5)))
    base = REST.weld.inverse[BASE]
    number = np.where(np.isin(ids, base), 0, np.where(REST.solve_mesh.V[ids, 0] > 2.5, 2, 1))
    x, (alone, handle_of) = log_handle_flux(REST.solve_mesh, ids, number, NO_SOFT_CONSTRAINTS), held()
    arm = (REST.solve_mesh.V[:, 0] > 1.3) & (REST.solve_mesh.V[:, 0] < 2.3)
    assert x[arm].min() > -2.0
    assert log_handle_flux(REST.solve_mesh, alone, handle_of, NO_SOFT_CONSTRAINTS)[arm].max() < -2.0


def test_log_handle_flux_tells_that_what_a_handle_draws_softly_is_not_calm():
    ids, handle_of = held()
    x = REST.solve_mesh.V[:, 0]
    arm, before = np.flatnonzero((x > 1.5) & (x < 2.5)), np.flatnonzero((x > 1.2) & (x < 1.4))
    soft = SoftConstraints(
        arm, np.ones(len(arm)), np.full(len(arm), 100.0), np.zeros(len(arm), dtype=np.int64)
    )
    assert log_handle_flux(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS)[before].max() < -1.5
    assert log_handle_flux(REST.solve_mesh, ids, handle_of, soft)[before].min() > -0.5


def test_log_handle_flux_of_a_thinned_mesh_tells_about_the_same(monkeypatch):
    ids, handle_of = held()
    fine = calmness_from_flux(log_handle_flux(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS))
    monkeypatch.setattr(calm_parts, "LARGE", 100)
    thin = calmness_from_flux(log_handle_flux(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS))
    free = np.setdiff1d(np.arange(len(fine)), ids)
    assert np.abs(thin - fine)[free].mean() <= 0.02


@pytest.mark.parametrize("missing", ["base", "handle"])
def test_calm_level_weights_find_no_gesture_without_a_base_or_a_handle(missing):
    ids, handle_of = held()
    number = np.zeros_like(handle_of) if missing == "handle" else np.ones_like(handle_of)
    assert len(calm_level_weights(REST.solve_mesh, ids, number, NO_SOFT_CONSTRAINTS)) == 0


def test_calmness_is_shown_for_the_vertices_of_the_file():
    labels = np.full(len(V), FREE)
    labels[BASE], labels[HEAD] = 0, 2
    ids, handle_of = held()
    expected = calmness_from_flux(log_handle_flux(REST.solve_mesh, ids, handle_of, NO_SOFT_CONSTRAINTS))[
        REST.weld.inverse
    ]
    shown = calmness(Mesh(V, F), labels, NO_SOFT_CONSTRAINTS)
    assert np.isnan(shown[FIXED]).all()
    free = labels == FREE
    np.testing.assert_allclose(shown[free], expected[free], rtol=0, atol=1e-12)
    assert not calmness(Mesh(V, F), np.full(len(V), FREE), NO_SOFT_CONSTRAINTS).any(), "nothing is painted"
