"""Projection onto goals: what their tolerance is worth."""

import numpy as np
import pytest
from meshes import ends, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goal_projection import GoalProjection
from apd_viewer.geometry.goals.goals import make_goals
from apd_viewer.geometry.solver.constrained_descent import ConstrainedDescent


@pytest.fixture(scope="module")
def at_rest():
    """A tube shortened by a tenth with its area kept, in equilibrium: surface, goals and multipliers."""
    V, F = tube(16, 20)
    low, high = ends(V)
    rest, fixed = RestMesh(V, F), np.concatenate([low, high])
    surface, goals = ElasticSurface(rest.solve_mesh, fixed), make_goals(rest, "100%", None, ())
    descent, targets = ConstrainedDescent(surface, goals, 1e-15), V[fixed].copy()
    targets[len(low) :, 2] -= 0.1 * np.ptp(V[:, 2])
    descent.set_targets(targets)
    while not descent.has_ended:
        descent.step()
    return surface, goals, descent.multipliers


@pytest.mark.parametrize("miss", [-1e-5, 1e-5])
def test_energy_at_targets_does_not_count_what_a_missed_goal_spares(at_rest, miss):
    surface, goals, multipliers = at_rest
    U, before = surface.U, surface.energy
    projection = GoalProjection(surface, goals)
    projection.refresh_directions(U)
    away = miss * goals[0].rest * projection.g[0] / (projection.g[0] ** 2).sum()
    W = U.copy()
    W[surface.free] += away[surface.free]
    projection.evaluate(W)
    after = surface.energy_after_local_step(W)
    surface.local_step(U)
    spared = abs(after - before)
    assert spared > 1e-7 * before
    assert abs(projection.energy_at_targets(after, multipliers) - before) < 0.1 * spared
