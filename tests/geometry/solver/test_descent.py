"""Quasi-Newton steps among the shapes that meet the goals: they fall, they end where nothing pulls."""

import numpy as np
import pytest
from meshes import box, ends, moved, rotation, sample_bottle, sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goal_projection import GoalProjection
from apd_viewer.geometry.goals.goals import GoalMeasures, Region, make_goals
from apd_viewer.geometry.linalg.lbfgs import LbfgsMemory
from apd_viewer.geometry.solver.constrained_descent import ConstrainedDescent
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.quasi_newton_descent import QuasiNewtonDescent

MESHES = {"tube": tube(16, 20), "box": box(3, 3, 8), "sphere": sphere(3)}
MATERIALS = {
    "arap": Material(),
    "stiff": Material(bending=1e-2),
    "local": Material(0.1, 0.1, 20.0),
}


def twisted(V, angle=1.8):
    base, handle = ends(V)
    return np.concatenate([base, handle]), np.vstack(
        [V[base], moved(V[handle], rotation([0, 0, 1], angle), [0.2, 0, 0.3])]
    )


def some_goals(rest, kind):
    upper = np.flatnonzero(rest.V[:, 2] > np.median(rest.V[:, 2]))
    if kind == "area":
        return make_goals(rest, 100.0, None, ())
    if kind == "area, region":
        return make_goals(rest, 103.0, None, (Region("upper", upper, 101.0),))
    return ()


@pytest.mark.parametrize("kind", ["nothing", "area", "area, region"])
@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("mesh", MESHES)
def test_constrained_descent_lowers_the_energy_and_keeps_the_goals_met(mesh, material, kind):
    V, F = MESHES[mesh]
    rest, (fixed, targets) = RestMesh(V, F), twisted(V)
    order = np.argsort(fixed)
    surface = ElasticSurface(rest.solve_mesh, fixed[order], MATERIALS[material])
    method = ConstrainedDescent(surface, some_goals(rest, kind))
    method.set_targets(targets[order])
    method.step()
    assert method.progress.has_met_goals
    goals = np.array([goal.target for goal in method.goals])
    before, missed_before = surface.energy, goals - method.progress.goal_values
    for _ in range(60):
        method.step()
        assert method.progress.has_met_goals
        assert np.array_equal(method.progress.U[fixed[order]], targets[order])
        # Goals are met to 1e-10: the energies are compared as if they were met exactly.
        missed = goals - method.progress.goal_values
        spared = 4.0 * method.multipliers @ (missed_before - missed)
        assert surface.energy <= (before + spared) * (1 + 1e-14)
        before, missed_before = surface.energy, missed
        if method.progress.converged:
            break


def test_quasi_newton_descent_ends_at_a_minimum_however_soft_its_metric_is(monkeypatch):
    """A first step a hundred thousand times too long is no minimum."""
    V, F = MESHES["box"]
    rest, (fixed, targets) = RestMesh(V, F), twisted(V, 0.3)
    order = np.argsort(fixed)
    surface = ElasticSurface(rest.solve_mesh, fixed[order])
    surface.local_step(surface.global_step(targets[order]))
    monkeypatch.setattr(ElasticSurface, "solve", lambda self, b: 1e5 * self.factor.solve(b))
    descent, before = QuasiNewtonDescent(surface, GoalProjection(surface, ())), surface.energy
    assert descent.step(targets[order])
    assert descent.energy < before


@pytest.mark.parametrize("method", ["arap", "exact", "local"])
@pytest.mark.parametrize("mesh", MESHES)
def test_deform_ends_lower_than_plain_iterations_and_sooner(mesh, method):
    V, F = MESHES[mesh]
    fixed, targets = twisted(V)
    fast = deform(V, F, fixed, targets, method)
    solver = Deformation(V, F, fixed, method=method)
    plain = deform(V, F, fixed, targets, method, iterations=2 * fast.iterations)
    assert fast.converged

    def energy(U):
        solver.aim(targets, U=U)
        return solver.solver.surface.energy

    assert energy(fast.U) <= energy(plain.U) * (1 + 1e-7)


@pytest.mark.parametrize("kind", ["nothing", "area", "area, region"])
def test_constrained_descent_ends_where_nothing_pulls_but_the_goals(kind):
    V, F = MESHES["box"]
    rest, (fixed, targets) = RestMesh(V, F), twisted(V, 0.6)
    order = np.argsort(fixed)
    surface = ElasticSurface(rest.solve_mesh, fixed[order])
    method = ConstrainedDescent(surface, some_goals(rest, kind))
    method.set_targets(targets[order])
    for _ in range(200):
        method.step()
    free, h = surface.free, 1e-6
    goals = some_goals(rest, kind)
    g = np.zeros((len(goals), *V.shape))
    GoalMeasures(goals).values_and_gradients(method.progress.U, g)
    # By differences of Eq. 1 itself, along random directions from which those of the goals are taken out.
    rng = np.random.default_rng(0)
    for _ in range(3):
        way = np.zeros_like(V)
        way[free] = rng.normal(size=(len(free), 3))
        if len(goals):
            columns = g[:, free].reshape(len(g), -1).T
            along = np.linalg.lstsq(columns, way[free].ravel(), rcond=None)[0]
            way[free] -= (columns @ along).reshape(-1, 3)
        way /= np.linalg.norm(way)
        slope = (rest.energy(method.progress.U + h * way) - rest.energy(method.progress.U - h * way)) / (
            2 * h
        )
        assert abs(slope) <= 1e-6 * rest.energy(method.progress.U)


def test_deform_does_not_depend_on_the_unit_of_length():
    V, F = MESHES["tube"]
    fixed, targets = twisted(V)
    small, large = (deform(s * V, F, fixed, s * targets) for s in (1.0, 1024.0))
    assert small.iterations == large.iterations
    assert np.array_equal(1024.0 * small.U, large.U)


@pytest.mark.night
def test_deform_settles_a_bottle_lower_than_by_plain_iterations():
    V, F, labels = sample_bottle(1.5)
    base, handle = np.flatnonzero(labels == 0), np.flatnonzero(labels == 2)
    centre = V[handle].mean(axis=0)
    targets = np.vstack([V[base], (V[handle] - centre) @ rotation([0, 1, 0], 2 * np.pi / 3).T + centre])
    fixed = np.concatenate([base, handle])
    fast = deform(V, F, fixed, targets)
    plain = deform(V, F, fixed, targets, iterations=fast.iterations)
    assert fast.converged
    assert abs(fast.area_error) <= 1e-9
    assert fast.energy < plain.energy


# The memory of the steps


def dense_directions(H0, pairs, gradient):
    """-H gradient with the matrix of Broyden, Fletcher, Goldfarb and Shanno, written out."""
    H, eye = H0, np.eye(len(H0))
    for s, y in pairs:
        rho = 1.0 / (s @ y)
        H = (eye - rho * np.outer(s, y)) @ H @ (eye - rho * np.outer(y, s)) + rho * np.outer(s, s)
    return -H @ gradient


def remember(memory, step, change):
    """A step, with the change of the slope over it."""
    memory.record_step(np.zeros_like(step), step, np.arange(len(step)))
    memory.store_gradients(change, np.zeros_like(change))


def test_lbfgs_memory_directions_are_those_of_the_matrix():
    rng = np.random.default_rng(3)
    n = 7
    root = rng.normal(size=(3 * n, 3 * n))
    A = root @ root.T + np.eye(3 * n)
    H0 = np.kron(np.diag(rng.uniform(0.5, 2.0, n)), np.eye(3))
    memory, pairs = LbfgsMemory(n, 4), []
    for _ in range(9):
        slope = rng.normal(size=(n, 3))
        got, along = memory.descent_direction(slope, lambda b: (H0 @ b.ravel()).reshape(-1, 3))
        expected = dense_directions(H0, pairs[-4:], slope.ravel())
        assert np.abs(got.ravel() - expected).max() <= 1e-9 * np.abs(expected).max()
        assert along == pytest.approx(slope.ravel() @ got.ravel(), rel=1e-12)
        step = rng.normal(size=3 * n).astype(np.float32)
        change = (A @ step).astype(np.float32)  # kept in single precision
        remember(memory, step.reshape(-1, 3).astype(float), change.reshape(-1, 3).astype(float))
        pairs.append((step.astype(float), change.astype(float)))


def test_lbfgs_memory_leaves_out_a_step_over_which_the_slope_fell():
    memory = LbfgsMemory(2, 3)
    remember(memory, np.ones((2, 3)), -np.ones((2, 3)))
    remember(memory, np.ones((2, 3)), np.zeros((2, 3)))
    assert len(memory) == 0
    remember(memory, np.ones((2, 3)), np.ones((2, 3)))
    assert len(memory) == 1
    memory.clear()
    way, along = memory.descent_direction(np.ones((2, 3)), lambda b: 2 * b)
    assert np.array_equal(way, np.full((2, 3), -2.0))
    assert along == -12.0


@pytest.mark.parametrize("tiny", [1e-30, 1e-44, 1e-46])
def test_lbfgs_memory_keeps_only_changes_that_single_precision_can_hold(tiny):
    memory = LbfgsMemory(2, 3)
    remember(memory, np.full((2, 3), 1e-40), np.full((2, 3), tiny))
    way, along = memory.descent_direction(np.ones((2, 3)), lambda b: b)
    assert len(memory) == (tiny > 1e-45)
    assert np.isfinite(way).all()
    assert along < 0.0
