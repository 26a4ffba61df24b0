"""The paper's method: an oracle for one round, and what must be true of the result."""

from dataclasses import replace

import numpy as np
import oracle
import pytest
from meshes import box, ends, moved, rotation, tube
from scipy.optimize import brentq

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goals import make_goals
from apd_viewer.geometry.mesh.operators import area, volume
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.li_hui import LiHui

TUBE = tube(12, 14)
MOVES = {
    "twist": (rotation([0, 0, 1], 1.5), (0, 0, 0)),
    "bend": (rotation([0, 1, 0], 0.8), (0.3, 0, -0.1)),
    "stretch": (np.eye(3), (0, 0, 0.5)),
    "crush": (np.eye(3), (0, 0, -0.4)),
}


def ends_moved(V, R, shift):
    base, handle = ends(V)
    targets = np.vstack([V[base], moved(V[handle], R, np.array(shift) * np.ptp(V[:, 2]))])
    return np.concatenate([base, handle]), handle, targets


@pytest.mark.parametrize("iterations", [1, 4, 20, 45])
@pytest.mark.parametrize("move", MOVES)
def test_li_hui_gives_every_shape_as_the_paper_would_end_with_it(move, iterations):
    V, F = tube(9, 8, height=3.0, shear=0.6)
    fixed, handle, targets = ends_moved(V, *MOVES[move])
    base = np.setdiff1d(fixed, handle)
    expected, h = oracle.paper(V, F, base, handle, targets[len(base) :], iterations)
    result = deform(V, F, fixed, targets, "paper", iterations, handle=handle)
    assert np.abs(result.U - expected).max() <= 1e-10 * np.linalg.norm(np.ptp(V, axis=0))
    asked = targets[len(base) :].mean(axis=0)
    assert result.handle_drift == pytest.approx(np.linalg.norm(h.mean(axis=0) - asked), abs=1e-12)


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("mesh", [TUBE, box(2, 2, 6)], ids=["tube", "box"])
def test_li_hui_lets_the_base_stay_and_the_handle_move_as_one_by_the_drift(mesh, move):
    V, F = mesh
    fixed, handle, targets = ends_moved(V, *MOVES[move])
    base = np.setdiff1d(fixed, handle)
    solver = Deformation(V, F, fixed, method="paper", handle=handle)
    solver.aim(targets)
    for _ in range(50):  # over two ends of rounds
        frame = solver.step()
        assert np.array_equal(frame.U[base], targets[: len(base)])
        shift = frame.U[handle] - targets[len(base) :]
        assert np.abs(shift - shift[0]).max() <= 1e-13 * np.ptp(V)
        assert frame.handle_drift == pytest.approx(np.linalg.norm(shift[0]), abs=1e-12)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("move", MOVES)
def test_li_hui_keeps_the_area_to_the_tolerance_at_the_end(move, tolerance):
    V, F = TUBE
    fixed, handle, targets = ends_moved(V, *MOVES[move])
    result = deform(V, F, fixed, targets, "paper", tolerance=tolerance, handle=handle)
    assert result.method == "paper"
    assert result.converged
    assert abs(result.area_error) <= tolerance
    assert result.area == pytest.approx(area(result.U, F), rel=1e-14)
    assert result.area_rest == pytest.approx(area(V, F), rel=1e-14)
    assert result.area_error == pytest.approx(result.area / result.area_rest - 1, rel=1e-9)


@pytest.mark.parametrize("move", MOVES)
def test_li_hui_keeps_the_area_better_than_arap(move):
    V, F = TUBE
    fixed, handle, targets = ends_moved(V, *MOVES[move])
    arap, paper = (Deformation(V, F, fixed, method=m, handle=handle) for m in ("arap", "paper"))
    arap.aim(targets)
    paper.aim(targets)
    for n in range(60):
        loss, kept = arap.step().area_error, paper.step().area_error
        if n >= 5:
            assert abs(kept) < abs(loss)


def test_li_hui_hardly_moves_the_handle_by_a_rotation_but_does_by_a_stretch():
    """Eq. 8 takes a stretch of half the height back nearly whole; drifts as parts of the height."""
    V, F = TUBE
    height = np.ptp(V[:, 2])
    drift = {}
    for move in ("twist", "stretch"):
        fixed, handle, targets = ends_moved(V, *MOVES[move])
        drift[move] = deform(V, F, fixed, targets, "paper", handle=handle).handle_drift / height
    assert drift["twist"] < 0.05
    assert drift["stretch"] > 0.4


def test_deform_by_arap_has_no_drift():
    V, F = TUBE
    fixed, handle, targets = ends_moved(V, *MOVES["stretch"])
    assert deform(V, F, fixed, targets, "arap", 5, handle=handle).handle_drift == 0.0
    assert deform(V, F, fixed, targets, "arap", 5).handle_drift == 0.0


def test_li_hui_changes_nothing_by_its_blend_where_arap_has_settled_at_the_rest_area():
    """With s = 1 the corrected positions are the shape itself, and it satisfies L u = b."""
    V, F = tube(9, 10)
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    mesh = RestMesh(V, F)
    rest = mesh.solve_mesh

    def settled(lift):
        targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], 1.0), [0, 0, lift])])
        arap = ElasticSurface(rest, fixed)
        for _ in range(400):
            arap.local_step(arap.global_step(targets))
        return arap, targets

    lift = brentq(lambda lift: area(settled(lift)[0].U, F) - area(V, F), -1.0, 1.0, xtol=1e-13)
    arap, targets = settled(lift)
    assert rest.energy(arap.U) > 0.1
    (goal,) = make_goals(mesh, 100.0, None, ())
    method = LiHui(arap, np.isin(fixed, handle).astype(int), (replace(goal, tolerance=1e-3),))
    method.set_targets(targets)
    method.step()
    assert method.progress.has_met_goals
    assert np.abs(method.held_positions - targets).max() <= 1e-9
    assert np.abs(method.progress.U - arap.U).max() <= 1e-9


def test_li_hui_needs_no_more_iterations_for_a_wider_tolerance():
    V, F = TUBE
    fixed, handle, targets = ends_moved(V, *MOVES["stretch"])
    counts = [
        deform(V, F, fixed, targets, "paper", tolerance=t, handle=handle).iterations
        for t in (1e-4, 1e-3, 1e-1)
    ]
    assert counts == sorted(counts, reverse=True)


def test_deformation_tolerance_can_be_changed_without_factoring_again():
    V, F = TUBE
    fixed, handle, targets = ends_moved(V, *MOVES["stretch"])
    solver = Deformation(V, F, fixed, method="paper", handle=handle, tolerance=1e-1)
    solver.tolerance = 1e-4
    assert solver.tolerance == 1e-4
    solver.aim(targets)
    frames = [solver.step()]
    while not frames[-1].converged:
        frames.append(solver.step())
    expected = deform(V, F, fixed, targets, "paper", tolerance=1e-4, handle=handle)
    assert len(frames) == expected.iterations
    assert np.array_equal(frames[-1].U, expected.U)


def test_deform_lets_the_volume_fall_though_the_area_stays():
    V, F = box(2, 2, 6)
    fixed, handle, targets = ends_moved(V, *MOVES["twist"])
    result = deform(V, F, fixed, targets, handle=handle)
    assert abs(result.area_error) <= 1e-3
    assert result.volume_rest == pytest.approx(24.0, rel=1e-13)
    assert result.volume == pytest.approx(volume(result.U, F), rel=1e-13)
    assert 0 < result.volume < 0.98 * result.volume_rest


@pytest.mark.parametrize("collapsed", [0.0, 1e-200])
def test_deformation_answers_a_shape_without_any_area_and_does_not_crash(collapsed):
    V, F = np.eye(3), np.array([[0, 1, 2]])
    solver = Deformation(V, F, [0, 1], handle=[1])
    solver.aim(np.full((2, 3), collapsed))
    for _ in range(3):
        frame = solver.step()
        assert np.isfinite(frame.U).all()
        assert not frame.converged
