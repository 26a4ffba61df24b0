"""Shapes that a coarse surface carries a fine one along to, for as long as the fine one has no factor."""

from types import SimpleNamespace

import numpy as np
import pytest
from meshes import box, rotation, tube
from remote_factor_double import Elsewhere

from apd_viewer.geometry.energy import solve_mesh
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import GoalMeasures, Region, make_goals
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.solver import coarse_level, multilevel
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.restarts import prepare_previews

AROUND = 48
V, F = tube(AROUND, 72, height=4.0)
FIXED = np.flatnonzero((V[:, 2] < 0.4) | (V[:, 2] > 3.6))
HANDLE = V[FIXED, 2] > 2.0


@pytest.fixture
def factor(monkeypatch):
    monkeypatch.setattr(Elsewhere, "there", False)
    return Elsewhere


def targets(angle, shift=(0.1, 0.0, 0.2)):
    X = V[FIXED].copy()
    X[HANDLE] = X[HANDLE] @ rotation([0, 0, 1], angle).T + shift
    return X


def until_the_coarse_one_is_done(solver, limit=500):
    for _ in range(limit):
        if not solver.ready:
            return
        solver.iterate()
    raise AssertionError("the coarse surface did not come to rest")


ASKED = {
    "area": {"area": 100.0},
    "volume": {"area": None, "volume": 98.0},
    "all": {"area": 100.0, "volume": 96.0, "regions": [Region("half", np.flatnonzero(V[:, 0] > 0), 101.0)]},
}


@pytest.mark.parametrize("asked", ASKED)
def test_coarse_preview_always_holds_what_is_asked(asked, factor):
    caps = {"area": (V, F), "volume": closed(), "all": closed()}[asked]
    solver = Deformation(*caps, FIXED, method="arap", factored=factor, **ASKED[asked])
    wished = ASKED[asked]
    goals = make_goals(solver.rest, wished["area"], wished.get("volume"), wished.get("regions", ()))
    for k in range(1, 12):
        solver.aim(targets(0.04 * k, (0, 0, 0)))
        solver.iterate()
        method = solver.solver
        assert method.progress.is_iterate_hidden, "it is none of its own shapes"
        assert method.progress.has_met_goals
        assert np.array_equal(method.progress.U[FIXED], targets(0.04 * k, (0, 0, 0)))
        for goal in goals:
            assert abs(goal.relative_deviation(GoalMeasures((goal,)).values(method.progress.U)[0])) <= (
                1e-9 if asked == "all" else 1e-10
            )
        assert not solver.frame().settled


def closed():
    """The tube with its ends closed by fans around the first vertex of each ring."""
    top, ring = len(V) - AROUND, np.arange(1, AROUND - 1)
    low = np.column_stack([np.zeros_like(ring), ring + 1, ring])
    return V, np.vstack([F, low, top + low[:, ::-1]])


def test_coarse_preview_shows_a_motion_of_the_whole_as_it_is(factor):
    solver = Deformation(V, F, FIXED, factored=factor)
    R, shift = rotation([1, 2, 3], 1.1), [3.0, -1.0, 0.5]
    solver.aim(V[FIXED] @ R.T + shift)
    until_the_coarse_one_is_done(solver)
    assert np.abs(solver.frame().U - (V @ R.T + shift)).max() <= 1e-4 * solver.rest.diagonal


def test_coarse_preview_begins_at_the_shape_that_was_there(factor):
    """Details that only the fine surface knows are not lost by touching the handle."""
    bumpy = V + 0.002 * np.random.default_rng(0).normal(size=V.shape)
    solver = Deformation(bumpy, F, FIXED, factored=factor)
    held = bumpy[FIXED].copy()
    held[HANDLE] += [1e-7, 0.0, 0.0]
    solver.aim(held)
    solver.iterate()
    assert np.abs(solver.frame().U - bumpy).max() <= 1e-6
    solver.aim(bumpy[FIXED])
    until_the_coarse_one_is_done(solver)
    assert np.abs(solver.frame().U - bumpy).max() <= 1e-6


@pytest.mark.parametrize(
    "method",
    [pytest.param("arap", marks=pytest.mark.night), "exact", pytest.param("local", marks=pytest.mark.night)],
)
def test_coarse_preview_lets_the_deformation_end_where_it_would_without_and_nothing_jumps(method, factor):
    asked = targets(0.5)
    plain = Deformation(V, F, FIXED, method=method, stiffness=1e-3)
    solver = Deformation(V, F, FIXED, method=method, stiffness=1e-3, factored=factor)
    for deformation in (plain, solver):
        deformation.aim(asked)
    until_the_coarse_one_is_done(solver)
    preview = solver.frame().U
    factor.there = True
    assert solver.ready
    first = solver.step()
    assert not solver.solver.progress.is_iterate_hidden
    diagonal = solver.rest.diagonal
    assert np.abs(first.U - preview).max() <= 0.01 * diagonal
    normals = [vertex_normals(U, solver.rest.solve_mesh.F) for U in (preview, first.U)]
    apart = np.degrees(np.arccos(np.clip((normals[0] * normals[1]).sum(axis=1), -1.0, 1.0)))
    assert np.percentile(apart, 90) <= 3.0
    while not (settled := solver.step()).settled:
        pass
    while not (alone := plain.step()).settled:
        pass
    assert np.abs(settled.U - preview).max() <= 0.02 * diagonal
    energies = [solver.rest.energy(frame.U) for frame in (settled, alone)]
    assert energies[0] == pytest.approx(energies[1], rel=1e-3)


def test_coarse_preview_follows_a_hand_that_moves_on_from_the_last_full_shape(factor):
    factor.there = True
    solver = Deformation(V, F, FIXED, factored=factor)
    solver.aim(targets(0.3))
    while not (rest := solver.step()).settled:
        pass
    for shift in (0.25, 0.3, 0.25, 0.2):
        solver.aim(targets(0.3, (0.1, 0.0, shift)))
        solver.iterate()
        assert solver.solver.progress.is_iterate_hidden
    while not (frame := solver.step()).settled:
        pass
    assert np.abs(frame.U - rest.U).max() <= 5e-3 * solver.rest.diagonal


def test_deformation_keep_meets_other_goals_in_the_middle_of_a_preview(factor):
    solver = Deformation(V, F, FIXED, factored=factor)
    solver.aim(targets(0.3))
    solver.iterate()
    solver.keep(area=103.0)
    frame = solver.step()
    assert frame.area == pytest.approx(1.03 * solver.rest.area, rel=1e-10)
    factor.there = True
    while not (frame := solver.step()).settled:
        assert frame.area == pytest.approx(1.03 * solver.rest.area, rel=1e-10)
    assert frame.converged


def test_deformation_aim_takes_another_start_in_the_middle_of_a_preview(factor):
    solver = Deformation(V, F, FIXED, factored=factor)
    solver.aim(targets(0.8))
    for _ in range(5):
        solver.iterate()
    solver.aim(V[FIXED], U=V)
    assert np.abs(solver.step().U - V).max() <= 1e-9 * solver.rest.diagonal


@pytest.mark.parametrize("method", ["paper", "sr-arap"])
def test_deformation_waits_for_the_factor_where_it_follows_no_coarse_surface(method, factor):
    handle = FIXED[HANDLE]
    solver = Deformation(V, F, FIXED, method=method, handle=handle, factored=factor)
    solver.aim(targets(0.3))
    assert not solver.ready
    factor.there = True
    assert solver.ready
    solver.step()


def test_preview_forecast_is_foretold_while_the_factor_is_missing(factor, monkeypatch):
    solver = Deformation(V, F, FIXED, stiffness=1e-3, factored=factor)
    solver.aim(targets(0.3))
    until_the_coarse_one_is_done(solver)
    expected, before = solver.solver.inner.forecast, solver.frame().seconds_left
    assert before > expected.descent_seconds > 0.0
    monkeypatch.setattr(Elsewhere, "seconds", 0.5 * expected.factor_seconds)
    solver.solver.inner.step()
    half = 0.5 * expected.factor_seconds + expected.descent_seconds
    assert solver.frame().seconds_left == pytest.approx(half, abs=0.05)


def test_preview_forecast_foretells_the_descent_by_its_own_pace(factor, monkeypatch):
    solver, now = Deformation(V, F, FIXED, stiffness=1e-3, factored=factor), 0.0
    monkeypatch.setattr(multilevel, "time", SimpleNamespace(monotonic=lambda: now))
    solver.aim(targets(0.3))
    until_the_coarse_one_is_done(solver)
    factor.there, expected = True, solver.solver.inner.forecast.iterations
    for done in range(1, 6):
        solver.iterate()
        pace = 2.0 * (done - 1) / done
        assert solver.frame().seconds_left == pytest.approx((expected - done) * pace)
        now += 2.0


def test_preview_forecast_is_not_foretold_while_the_coarse_surface_converges(factor):
    solver = Deformation(V, F, FIXED, stiffness=1e-3, factored=factor)
    solver.aim(targets(2.5))
    assert solver.step().seconds_left is None


@pytest.mark.parametrize(
    ("method", "angle"),
    [
        ("exact", 1.0),
        ("local", 0.3),
        *(
            pytest.param(*others, marks=pytest.mark.night)
            for others in (("exact", 0.3), ("local", 1.0), ("arap", 0.3), ("arap", 1.0))
        ),
    ],
)
def test_coarse_preview_goes_the_whole_way_of_the_handle_with_contact(factor, method, angle):
    """Each part of the way is gone as soon as the coarse surface has come to rest at the last."""
    solver = Deformation(V, F, FIXED, method=method, stiffness=1e-3, factored=factor, contact=True)
    solver.aim(targets(angle, (0, 0, 0)))
    until_the_coarse_one_is_done(solver)
    frame = solver.frame()
    assert frame.share_reached == 1.0
    assert np.array_equal(frame.U[FIXED], targets(angle, (0, 0, 0)))
    assert not frame.settled


def test_coarse_preview_that_contact_refuses_is_followed_by_others_without_the_factor(factor):
    """Contact itself cannot do without it: it would answer nobody for as long as that takes."""
    box_, faces = box(20, 20, 40)
    fixed, top = np.flatnonzero(np.isin(box_[:, 2], (0, 40))), box_[:, 2] == 40
    solver = Deformation(box_, faces, fixed, factored=factor, contact=True)
    for k in range(1, 11):
        asked = box_.copy()
        asked[top] = (asked[top] - (1, 1, 6)) @ rotation((0, 1, 0), 0.05 * k).T + (1, 1, 6)
        solver.aim(asked[fixed])
        solver.iterate()
    until_the_coarse_one_is_done(solver)
    assert solver.frame().share_reached == 1.0


@pytest.mark.parametrize(("angle", "is_foretold"), [(0.02, True), (2.0, False)])
def test_preview_forecast_is_foretold_with_contact_once_the_held_vertices_have_arrived(
    factor, angle, is_foretold
):
    solver = Deformation(V, F, FIXED, stiffness=1e-3, factored=factor, contact=True)
    solver.aim(targets(angle, (0, 0, 0)))
    until_the_coarse_one_is_done(solver)
    assert np.array_equal(solver.frame().U[FIXED], targets(angle, (0, 0, 0))) == is_foretold
    assert (solver.frame().seconds_left is not None) == is_foretold


def test_preview_forecast_is_not_foretold_where_nothing_is_waited_for():
    solver = Deformation(V, F, FIXED)
    solver.aim(targets(0.3))
    assert solver.step().seconds_left is None


@pytest.fixture
def prolongations(monkeypatch):
    """Interpolations to fine surfaces that are computed."""
    found, plain = [], coarse_level.Prolongation
    for module in (coarse_level, solve_mesh):
        monkeypatch.setattr(module, "Prolongation", lambda *given: found.append(given) or plain(*given))
    return found


def test_coarse_preview_prepared_ahead_is_the_same_and_waits_for_less(factor, prolongations):
    shapes, computed = [], []
    for is_ahead in (False, True):
        solver = Deformation(V, F, FIXED, factored=factor)
        if is_ahead:
            prepare_previews(solver.solver)
        prolongations.clear()
        solver.aim(targets(0.3))
        solver.iterate()
        shapes.append(solver.frame().U)
        computed.append(len(prolongations))
    assert np.array_equal(*shapes)
    assert computed == [1, 0]


def test_coarse_preview_is_not_prepared_where_there_is_none(prolongations):
    prepare_previews(Deformation(V, F, FIXED).solver)
    assert not prolongations


@pytest.mark.parametrize("width", [0.05, 0.3, 10.0])
def test_collar_smooths_the_free_vertices_within_its_width_of_held_ones(width):
    surface = ElasticSurface(SolveMesh(V, F), FIXED)
    U = V + np.random.default_rng(0).normal(scale=0.01, size=V.shape)
    U[FIXED] = V[FIXED]
    moved = (coarse_level.Collar(surface, width).smoothed_positions(U) != U).any(axis=1)
    is_border = np.isin(np.arange(len(V)), F[np.isin(F, FIXED).any(axis=1)])
    border = V[np.intersect1d(np.flatnonzero(is_border), FIXED)]
    nearest = np.linalg.norm(V[:, None] - border, axis=2).min(axis=1)
    assert np.array_equal(moved, surface.is_free & (nearest < width))
