"""What handles draw along: the distances, the springs, and the shapes that come of them."""

import heapq

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box, rotation

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints
from apd_viewer.geometry.pose.falloff import distances, edge_graph, falloff_strengths, soft_constraints
from apd_viewer.geometry.solver.deformation import Deformation


def plate(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A square of side 1 with n * n squares, each two triangles."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    V = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    return V, np.vstack([np.column_stack([i, i + 1, i + n + 2]), np.column_stack([i, i + n + 2, i + n + 1])])


def around(
    V: np.ndarray, F: np.ndarray, handle: np.ndarray, fixed: np.ndarray, falloff: float
) -> SoftConstraints:
    free = np.ones(len(V), dtype=bool)
    free[fixed] = False
    strength = falloff_strengths(distances(edge_graph(V, F), handle, falloff), falloff)
    return soft_constraints(free, strength[None], np.array([falloff]))


def poked(n: int, falloff: float, method: str = "arap", **options) -> np.ndarray:
    """The shape of a plate, held at its border, whose middle is lifted by 0.1."""
    V, F = plate(n)
    border = np.flatnonzero(((V[:, :2] == 0) | (V[:, :2] == 1)).any(axis=1))
    handle = np.flatnonzero((V[:, :2] == 0.5).all(axis=1))
    fixed = np.concatenate([border, handle])
    soft = around(V, F, handle, fixed, falloff) if falloff else NO_SOFT_CONSTRAINTS
    solver = Deformation(V, F, fixed, method=method, handle=handle, soft=soft, **options)
    up = np.array([0.0, 0.0, 0.1])
    solver.aim(V[fixed] + np.isin(fixed, handle)[:, None] * up, None, V[soft.ids] + up)
    for _ in range(600):
        solver.iterate()
        if solver.settled:
            return solver.frame().U
    raise AssertionError("it did not settle")


def brute_force(V, F, start, limit):
    """Dijkstra's search [1959], by hand."""
    away = np.full(len(V), np.inf)
    near = [set() for _ in V]
    for a, b, c in F.tolist():
        for i, j in ((a, b), (b, c), (c, a)):
            near[i].add(j)
            near[j].add(i)
    heap = [(0.0, int(i)) for i in start]
    while heap:
        d, i = heapq.heappop(heap)
        if d < away[i] and d <= limit:
            away[i] = d
            for j in near[i]:
                heapq.heappush(heap, (d + float(np.linalg.norm(V[i] - V[j])), j))
    return away


@given(st.integers(0, 2**32 - 1), st.floats(0.3, 4.0))
def test_distances_are_those_of_a_search_by_hand(seed, limit):
    rng = np.random.default_rng(seed)
    V, F = box(2, 2, 3)
    V = V + rng.normal(scale=0.1, size=V.shape)
    start = rng.choice(len(V), 3, replace=False)
    np.testing.assert_allclose(distances(edge_graph(V, F), start, limit), brute_force(V, F, start, limit))


def test_soft_constraints_gives_what_two_handles_draw_to_the_stronger_and_only_what_is_free():
    strength = np.array([[1.0, 0.5, 0.2, 0.0, 0.9], [0.3, 0.6, 0.0, 0.0, 0.1]])
    soft = soft_constraints(np.array([False, True, True, True, True]), strength, np.array([2.0, 4.0]))
    assert soft.ids.tolist() == [1, 2, 4]
    assert soft.handle.tolist() == [1, 0, 0]
    np.testing.assert_allclose(soft.density * np.array([16.0, 4.0, 4.0]) / soft.strength, 25.0)


@pytest.mark.parametrize("material", [Material(), Material(0.1, 2.0, 5.0), Material(bending=0.02)])
def test_elastic_surface_residual_is_a_quarter_of_the_gradient_of_the_energy(material):
    rng = np.random.default_rng(1)
    V, F = box(2, 2, 4)
    fixed = np.flatnonzero(V[:, 2] == 0)
    handle = np.flatnonzero(V[:, 2] == 4)
    held = np.concatenate([fixed, handle])
    soft = around(V, F, handle, held, 2.5)
    surface = ElasticSurface(RestMesh(V, F).solve_mesh, held, material, soft=soft)
    targets = np.concatenate([V[held], V[soft.ids] @ rotation((0, 0, 1), 0.4).T])
    U = V + rng.normal(scale=0.05, size=V.shape)
    U[held] = V[held]
    surface.local_step(U)
    found = 4.0 * surface.residual(targets)
    for k in rng.choice(len(surface.free), 6, replace=False):
        for axis in range(3):
            E = []
            for step in (1e-5, -1e-5):
                X = U.copy()
                X[surface.free[k], axis] += step
                surface.local_step(X)
                surface.held_contribution(targets)
                E.append(surface.energy)
            assert (E[0] - E[1]) / 2e-5 == pytest.approx(found[k, axis], abs=1e-5 * np.abs(found).max())


@pytest.mark.parametrize("method", ["arap", "local"])
def test_deformation_lifts_a_spike_by_a_point_and_a_hill_by_a_soft_point(method):
    spike, hill = poked(24, 0.0, method), poked(24, 0.25, method)
    ring = np.abs(np.linalg.norm(plate(24)[0][:, :2] - 0.5, axis=1) - 1 / 12) < 1e-9
    assert ring.sum() >= 4
    assert hill[ring, 2].min() > 0.095
    assert spike[ring, 2].max() < 0.09
    assert hill[:, 2].max() < 0.101


def test_falloff_springs_are_as_firm_on_a_finer_mesh():
    coarse, fine = poked(16, 0.25), poked(32, 0.25)
    V, W = plate(16)[0], plate(32)[0]
    same = [int(np.flatnonzero((v == W).all(axis=1))[0]) for v in V]
    assert np.abs(coarse[:, 2] - fine[same, 2]).max() < 0.1 * 0.05


def test_deformation_of_a_guided_surface_comes_to_rest_where_that_of_a_plain_one_does():
    V, _ = plate(72)
    assert len(V) > 5000, "so large that a coarse one shows the way"
    guided, plain = poked(72, 0.3), poked(72, 0.3, plain=True)
    assert np.abs(guided - plain).max() < 1e-3


def test_deformation_with_falloff_keeps_the_area_and_what_is_held_where_it_is_put():
    V, F = box(4, 4, 12)
    base, handle = np.flatnonzero(V[:, 2] == 0), np.flatnonzero(V[:, 2] == 12)
    fixed = np.concatenate([base, handle])
    soft = around(V, F, handle, fixed, 4.0)
    solver = Deformation(V, F, fixed, handle=handle, soft=soft)
    turn = rotation((0, 0, 1), 0.6).T
    targets = V[fixed] + np.isin(fixed, handle)[:, None] * (V[fixed] @ turn - V[fixed])
    solver.aim(targets, None, V[soft.ids] @ turn)
    for _ in range(300):
        frame = solver.step()
        np.testing.assert_array_equal(frame.U[fixed], targets)
        assert abs(frame.area_error) < 1e-9
        if frame.settled:
            break
    assert frame.settled
    near = np.flatnonzero(V[:, 2] == 11)
    hard = Deformation(V, F, fixed, handle=handle)
    hard.aim(targets)
    while not hard.settled:
        hard.iterate()

    def off(U):
        return np.abs(U[near] - V[near] @ turn).mean()

    assert off(frame.U) < 0.7 * off(hard.frame().U)


def test_li_hui_handle_takes_its_soft_vertices_along():
    V, F = box(4, 4, 12)
    base, handle = np.flatnonzero(V[:, 2] == 0), np.flatnonzero(V[:, 2] == 12)
    fixed = np.concatenate([base, handle])
    soft = around(V, F, handle, fixed, 4.0)
    solver = Deformation(V, F, fixed, method="paper", handle=handle, soft=soft)
    turn = rotation((0, 0, 1), 0.6).T
    solver.aim(
        V[fixed] + np.isin(fixed, handle)[:, None] * (V[fixed] @ turn - V[fixed]), None, V[soft.ids] @ turn
    )
    while not (frame := solver.step()).settled:
        assert frame.iteration < 500
    assert abs(frame.area_error) <= 1e-3
