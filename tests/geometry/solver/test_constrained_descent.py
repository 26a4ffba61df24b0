"""Goals met exactly at every iteration, handles where they were put, and a true minimum at the end."""

import numpy as np
import pytest
from meshes import box, ends, moved, rotation, soup, sphere, tube
from scipy.optimize import brentq

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy import elastic_surface as elastic_module
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goals import GoalMeasures, Region, make_goals
from apd_viewer.geometry.mesh.operators import area, volume
from apd_viewer.geometry.solver.constrained_descent import ConstrainedDescent
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform

MESHES = {"tube": tube(12, 14), "box": box(2, 2, 6), "soup": soup(*tube(8, 10))}
MOVES = {
    "twist": (rotation([0, 0, 1], 1.0), (0, 0, 0)),
    "twist further": (rotation([0, 0, 1], 2.1), (0, 0, 0)),
    "bend": (rotation([0, 1, 0], 1.57), (0.6, 0, -0.4)),
    "stretch": (np.eye(3), (0, 0, 0.45)),
    "crush": (np.eye(3), (0, 0, -0.45)),
    "shear": (np.eye(3), (0.6, 0, 0)),
}


def held(V, move):
    base, handle = ends(V)
    R, shift = MOVES[move]
    targets = np.vstack([V[base], moved(V[handle], R, np.array(shift) * np.ptp(V[:, 2]))])
    return np.concatenate([base, handle]), handle, targets


@pytest.mark.parametrize("method", ["exact", "local"])
@pytest.mark.parametrize("percent", [100.0, 90.0, 130.0])
@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("mesh", MESHES)
def test_deformation_has_the_exact_area_and_the_handle_in_place_at_every_frame(mesh, move, percent, method):
    V, F = MESHES[mesh]
    fixed, handle, targets = held(V, move)
    solver = Deformation(V, F, fixed, method=method, handle=handle, area=percent)
    solver.aim(targets)
    for k in range(20):
        frame = solver.step()
        assert np.array_equal(frame.U[fixed], targets)
        assert np.isfinite(frame.U).all()
        assert frame.handle_drift == 0.0
        assert k == 0 or abs(frame.area_error - (percent / 100 - 1)) <= 1e-9
        assert k == 0 or area(frame.U, F) == pytest.approx(percent / 100 * area(V, F), rel=1e-9)


@pytest.mark.parametrize("move", MOVES)
def test_constrained_descent_without_goals_is_the_plain_iteration(move):
    V, F = MESHES["box"]
    fixed, _, targets = held(V, move)
    rest = RestMesh(V, F)
    plain, method = (
        ElasticSurface(rest.solve_mesh, fixed),
        ConstrainedDescent(ElasticSurface(rest.solve_mesh, fixed)),
    )
    method.set_targets(targets)
    for _ in range(10):
        plain.local_step(plain.global_step(targets))
        method.iterate()
    assert np.array_equal(plain.U, method.progress.U)
    assert method.progress.has_met_goals


def kkt_residual(rest, method):
    """The part of the energy's gradient that the goals' gradients do not balance, relative to it."""
    surface = method.surface
    free = surface.free
    slope = 4 * surface.residual(method.held_positions).ravel()
    gradients = np.empty((len(method.goals), *surface.U.shape))
    GoalMeasures(method.goals).values_and_gradients(surface.U, gradients)
    G = gradients[:, free].reshape(len(gradients), -1).T
    multipliers = np.linalg.lstsq(G, slope, rcond=None)[0]
    return np.linalg.norm(slope - G @ multipliers) / np.linalg.norm(slope), multipliers


@pytest.mark.parametrize(
    ("mesh", "shift", "area_percent", "volume_percent"),
    [
        (tube(12, 28), 0.3, 100, None),
        (box(5, 5, 15), 0.1, 103, 100),
        (box(5, 5, 15), 0.1, None, 90),
        pytest.param(tube(36, 82), 0.3, 100, None, marks=pytest.mark.night),
        pytest.param(box(14, 14, 42), 0.1, 103, 100, marks=pytest.mark.night),
        pytest.param(box(14, 14, 42), 0.1, None, 90, marks=pytest.mark.night),
    ],
)
def test_constrained_descent_ends_where_the_conditions_of_karush_kuhn_and_tucker_hold(
    mesh, shift, area_percent, volume_percent
):
    V, F = mesh
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], V[handle] + [0, 0, shift * np.ptp(V[:, 2])]])
    rest = RestMesh(V, F)
    method = ConstrainedDescent(
        ElasticSurface(rest.solve_mesh, fixed), make_goals(rest, area_percent, volume_percent, [])
    )
    method.set_targets(targets)
    for _ in range(len(V)):
        method.iterate()
    assert method.progress.has_met_goals
    residual, multipliers = kkt_residual(rest, method)
    assert residual <= 1e-6
    assert 4 * method.multipliers == pytest.approx(multipliers, rel=1e-4)


def rest_scaled(rest, fixed, targets, iterations):
    """ARAP with its rest edges scaled by that s which gives the area at rest: the rival."""
    surface = ElasticSurface(rest.solve_mesh, fixed)
    still, s = surface.all_positions(-surface.solve(surface.held_contribution(targets)), targets), 1.0
    for _ in range(iterations):
        grown = surface.global_step(targets) - still
        excess = lambda s, grown=grown: area(still + s * grown, rest.F) - rest.area  # noqa: E731
        s = brentq(excess, 0.1, 2.0, xtol=1e-13)
        surface.local_step(still + s * grown)
    return surface.U


@pytest.mark.parametrize("move", ["twist", "bend", "stretch", "shear"])
def test_deform_by_exact_has_no_energy_above_that_of_rest_scaled_arap(move):
    V, F = MESHES["tube"]
    fixed, _, targets = held(V, move)
    rest = RestMesh(V, F)
    rival = rest_scaled(rest, fixed, targets, 500)
    result = deform(V, F, fixed, targets, "exact", 500)
    assert area(rival, F) == pytest.approx(result.area, rel=1e-9)
    assert result.energy <= rest.energy(rival) * (1 + 1e-9)
    assert result.energy >= deform(V, F, fixed, targets, "arap", 500).energy * (1 - 1e-9)


@pytest.mark.parametrize("move", MOVES)
def test_deform_meets_regions_and_a_volume_together(move):
    V, F = box(3, 3, 9)
    fixed, handle, targets = held(V, move)
    low, high = np.flatnonzero(V[:, 2] <= 4), np.flatnonzero(V[:, 2] >= 5)
    regions = [Region("low", low, 100.0), Region("high", high, 110.0), Region("seen", low)]
    inside = 100.0 if move not in ("stretch", "crush") else 120.0 if move == "stretch" else 80.0
    result = deform(V, F, fixed, targets, "arap", 80, handle=handle, volume=inside, regions=regions)
    at_rest = [area(V, F[np.isin(F, ids).all(axis=1)]) for ids in (low, high)]
    assert [part.name for part in result.regions] == ["low", "high", "seen"]
    found = [(part.area_rest, part.area, part.area_target) for part in result.regions]
    for expected, (_, now, target) in zip((at_rest[0], 1.1 * at_rest[1]), found[:2], strict=True):
        assert now == pytest.approx(expected, rel=1e-9)
        assert target == pytest.approx(expected, rel=1e-13)
    assert found[2] == (*found[0][:2], None)
    assert volume(result.U, F) == pytest.approx(inside / 100 * volume(V, F), rel=1e-9)
    assert np.array_equal(result.U[fixed], targets)


def test_deformation_keep_changes_goals_without_factoring(monkeypatch):
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "twist")
    solver = Deformation(V, F, fixed, handle=handle)
    monkeypatch.setattr(elastic_module, "LinearSolver", None)
    solver.aim(targets)
    for percent in (100.0, 120.0, 80.0, 100.0):
        solver.keep(area=percent)
        assert solver.step().iteration == 1
        assert solver.step().area_error == pytest.approx(percent / 100 - 1, abs=1e-9)
    solver.keep(area=105.0, volume=90.0)
    for _ in range(20):
        frame = solver.step()
    assert frame.area_error == pytest.approx(0.05, abs=1e-9)
    assert frame.volume == pytest.approx(0.9 * volume(V, F), rel=1e-9)


@pytest.mark.parametrize("move", ["stretch", "shear", "twist further"])
@pytest.mark.parametrize("mesh", ["tube", "box"])
def test_deform_tells_what_is_out_of_reach_in_a_sentence(mesh, move):
    V, F = MESHES[mesh]
    fixed, handle, targets = held(V, move)
    result = deform(V, F, fixed, targets, "exact", handle=handle, area=10.0, contact=False)
    assert not result.converged
    assert np.isfinite(result.U).all()
    assert np.array_equal(result.U[fixed], targets)
    reached = f"{100 * result.area / result.area_rest:.4g} %"
    words = f"Out of reach in this pose: the area is at {reached} instead of 10 %"
    assert any(warning.startswith(words) for warning in result.warnings)
    assert 0.1 < result.area / result.area_rest < 1.2
    assert np.abs(result.U).max() <= 2 * np.abs(targets).max() + 10


def test_deformation_keeps_the_best_shape_and_tries_another_wish_again():
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "stretch")
    solver = Deformation(V, F, fixed, handle=handle, area=10.0)
    solver.aim(targets)
    frames = [solver.step()]
    while not frames[-1].settled:
        frames.append(solver.step())
    assert frames[-1].unreached
    assert all(frame.unreached is None for frame in frames[:-1])
    assert frames[-1].area <= min(frame.area for frame in frames) * 1.011
    again = solver.step()
    assert np.array_equal(again.U, frames[-1].U)
    solver.keep(area=100.0)
    for _ in range(3):
        frame = solver.step()
    assert frame.unreached is None
    assert abs(frame.area_error) <= 1e-9


def test_deform_stays_finite_with_goals_that_contradict_each_other():
    """Nothing encloses more than a ball: a ball's area and volume cannot both stay when it is stretched."""
    V, F = sphere(3)
    base, handle = (np.flatnonzero(s * V[:, 2] > 0.8) for s in (-1, 1))
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], V[handle] + [0, 0, 0.3]])
    for wish in ((100, 100), (98, 100), (100, 103)):
        result = deform(V, F, fixed, targets, "exact", area=wish[0], volume=wish[1], handle=handle)
        assert not result.converged
        assert "Out of reach in this pose: the area is at" in result.warnings[-1]
        assert "the volume is at" in result.warnings[-1]
        assert np.abs(result.U).max() < 3
        assert result.area / result.area_rest == pytest.approx(wish[0] / 100, abs=0.1)
        assert result.volume / result.volume_rest == pytest.approx(wish[1] / 100, abs=0.1)
    met = deform(V, F, fixed, targets, "exact", 300, area=103, volume=100, handle=handle)
    assert met.area_error == pytest.approx(0.03, abs=1e-9)
    assert met.volume == pytest.approx(met.volume_rest, rel=1e-9)


def test_deform_cannot_change_a_wholly_held_region_which_spoils_nothing():
    V, F = box(2, 2, 6)
    fixed, handle, targets = held(V, "twist")
    lid = Region("lid", handle, 120.0)
    result = deform(V, F, fixed, targets, "exact", handle=handle, regions=[lid])
    assert not result.converged
    assert "“lid” is at 100 % instead of 120 %" in result.warnings[-1]
    assert "the area" not in result.warnings[-1]
    assert abs(result.area_error) <= 1e-9


def test_deformation_keeps_the_area_at_every_pose_of_a_drag():
    """Poses come one after another, a few iterations each, as while the hand moves."""
    V, F = MESHES["tube"]
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    solver = Deformation(V, F, fixed, handle=handle)
    for turn in np.linspace(0, 6.0, 60):
        targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], turn), [0, 0, np.sin(turn)])])
        solver.aim(targets)
        for _ in range(2):
            frame = solver.step()
            assert abs(frame.area_error) <= 1e-9
            assert np.array_equal(frame.U[fixed], targets)


def test_deform_by_paper_takes_another_area_but_no_other_goal():
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "twist")
    result = deform(V, F, fixed, targets, "paper", handle=handle, area=105.0)
    assert result.converged
    assert result.area_error == pytest.approx(0.05, abs=1.05e-3)
    for wish in ({"volume": 100.0}, {"regions": [Region("lid", handle, 100.0)]}):
        with pytest.raises(InputError, match="'paper' keeps only the total area"):
            deform(
                *MESHES["box"],
                *held(MESHES["box"][0], "twist")[::2],
                "paper",
                1,
                handle=held(MESHES["box"][0], "twist")[1],
                **wish,
            )


def test_deform_says_what_a_given_number_of_iterations_has_not_met():
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "stretch")
    result = deform(V, F, fixed, targets, "exact", 3, handle=handle, area=10.0)
    assert result.iterations == 3
    assert result.warnings[-1].startswith("Targets not met after 3 iterations: the area is at ")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"handle": 3}, "The handle must be an array of vertex IDs"),
        ({"handle": {1, 2}}, "The handle must be an array of vertex IDs"),
        ({"regions": None}, "regions must be a list"),
        ({"regions": Region("lid", np.arange(3))}, "regions must be a list"),
        ({"stiffness": True}, "stiffness must be a number"),
    ],
)
def test_deform_refuses_wrong_arguments_in_a_sentence(wrong, words):
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "twist")
    with pytest.raises(InputError, match=words):
        deform(V, F, fixed, targets, "exact", 1, **({"handle": handle} | wrong))


def test_deform_refuses_a_vertex_of_two_handles_and_targets_beyond_reason():
    V, F = MESHES["box"]
    fixed, handle, targets = held(V, "twist")
    with pytest.raises(InputError, match="A vertex belongs to two handles"):
        deform(V, F, fixed, targets, "exact", 1, handle=[handle, handle[:1]])
    with pytest.raises(InputError, match="A target position is too far"):
        deform(V, F, fixed, targets * 1e200, "exact", 1, handle=handle)
