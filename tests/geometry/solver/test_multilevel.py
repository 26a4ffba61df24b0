"""A coarse surface that shows a fine one the way: what it is made of, hands over, and what comes of it."""

import numpy as np
import pytest
import trimesh
from meshes import rotation, sample_bottle, soup, sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.goals import Region, make_goals
from apd_viewer.geometry.linalg.rotations import blended_rotations, relative_rotations
from apd_viewer.geometry.mesh.weighted_areas import total_area
from apd_viewer.geometry.solver.coarse_level import CoarseLevel
from apd_viewer.geometry.solver.constrained_descent import ConstrainedDescent
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.multilevel import MultilevelDescent, compute_decimations, multilevel_descent
from apd_viewer.geometry.solver.restarts import Restarts

TUBE = tube(60, 90, height=4.0)


def ends_of(V, share=0.1):
    z = (V[:, 2] - V[:, 2].min()) / np.ptp(V[:, 2])
    base, handle = np.flatnonzero(z < share), np.flatnonzero(z > 1 - share)
    fixed = np.sort(np.concatenate([base, handle]))
    return fixed, np.isin(fixed, handle)


def held(V, angle=1.5, shift=(0.2, 0, 0.3)):
    fixed, is_handle = ends_of(V)
    targets = V[fixed].copy()
    targets[is_handle] = targets[is_handle] @ rotation([0, 0, 1], angle).T + shift
    return fixed, targets


def coarse_of(V, F, fixed):
    return CoarseLevel(ElasticSurface(RestMesh(V, F).solve_mesh, fixed), (), ConstrainedDescent)


@pytest.mark.parametrize("mesh", [TUBE, sphere(5)], ids=["tube", "sphere"])
def test_coarse_level_is_a_smaller_mesh_of_the_same_shape(mesh):
    V, F = mesh
    coarse = coarse_of(V, F, np.arange(5))
    assert 0.2 * len(V) < len(coarse.vertices) < 0.6 * len(V)
    assert len(np.unique(coarse.vertices)) == len(coarse.vertices)
    assert (np.sort(coarse.F, axis=1)[:, :-1] < np.sort(coarse.F, axis=1)[:, 1:]).all()
    assert total_area(V[coarse.vertices], coarse.F) == pytest.approx(total_area(V, F), rel=0.02)


def test_coarse_level_hears_of_a_handle_of_one_vertex():
    V, F = TUBE
    for lonely in (4000, 4321, 5003):
        coarse = coarse_of(V, F, np.array([0, 1, 2, lonely]))
        assert lonely in coarse.vertices


def test_decimation_lets_every_vertex_turn_with_those_near_it_on_its_own_side():
    """A cup of two walls, nearer to each other than the coarse vertices are."""
    V, F = TUBE
    n = len(V)
    inner = V * [0.99, 0.99, 1.0]
    both, faces = np.vstack([V, inner]), np.vstack([F, F[:, ::-1] + n])
    thinning = SolveMesh(both, faces).decimation
    near = thinning.vertices[thinning.coarse_neighbours]
    assert ((near < n) == (np.arange(2 * n) < n)[:, None])[thinning.weight > 1e-6].all()
    assert np.abs(thinning.weight.sum(axis=1) - 1.0).max() <= 1e-12


def test_coarse_level_turns_pieces_by_themselves():
    V, F = TUBE
    n = len(V)
    both, faces = np.vstack([V, V + [2.01, 0, 0]]), np.vstack([F, F + n])
    fixed, _ = ends_of(V)
    coarse = coarse_of(both, faces, fixed)
    coarse.set_targets(V[fixed] @ rotation([0, 0, 1], 0.7).T)
    coarse.iterate(400)
    turns = coarse.take_rotations()
    half = np.array([np.cos(0.35), 0, 0, np.sin(0.35)])
    assert np.abs(np.abs(turns[:n] @ half) - 1.0).max() <= 1e-6
    assert np.abs(turns[n:] - [1.0, 0, 0, 0]).max() <= 1e-15
    coarse.iterate(10)
    assert np.abs(np.abs(coarse.take_rotations()[:, 0]) - 1.0).max() <= 1e-6, (
        "what was handed over is not again"
    )


def test_coarse_level_has_goals_of_the_coarse_surface():
    V, F = sphere(5)
    rest = RestMesh(V, F)
    upper = np.flatnonzero(V[:, 2] > 0)
    goals = make_goals(rest, 103.0, 97.0, (Region("upper", upper, 110.0), Region("dot", F[0], 100.0)))
    own = {}

    def solver_of(surface, goals):
        own.update((goal.name, goal) for goal in goals)
        return ConstrainedDescent(surface, goals)

    CoarseLevel(ElasticSurface(rest.solve_mesh, np.arange(3)), goals, solver_of)
    assert list(own) == ["the area", "“upper”", "the volume"], "what has no triangle cannot be asked for"
    assert own["the area"].rest == pytest.approx(goals[0].rest, rel=0.02)
    for goal in goals:
        if goal.name in own:
            assert own[goal.name].target / own[goal.name].rest == pytest.approx(goal.target / goal.rest)


def test_blended_rotations_gives_back_what_is_alone_or_alike_and_difference_from_itself_is_none():
    rng = np.random.default_rng(0)
    q, p = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in rng.normal(size=(2, 50, 4)))
    assert np.abs(relative_rotations(q, q) - [1, 0, 0, 0]).max() <= 1e-15
    near = rng.integers(50, size=(200, 4)).astype(np.int32)
    alone = np.zeros((200, 4))
    alone[:, 2] = 1.0
    assert np.abs(np.abs((blended_rotations(q, near, alone) * q[near[:, 2]]).sum(axis=1)) - 1).max() <= 1e-14
    same = np.tile(p[:1], (50, 1)) * np.where(rng.random(50) < 0.5, 1, -1)[:, None]
    weight = rng.random((200, 4))
    assert np.abs(np.abs(blended_rotations(same, near, weight) @ p[0]) - 1).max() <= 1e-14
    assert np.array_equal(blended_rotations(q, near, np.zeros((200, 4))), np.tile([1.0, 0, 0, 0], (200, 1)))


@pytest.mark.parametrize(
    "material",
    [Material(), pytest.param(Material(bending=1e-3), marks=pytest.mark.night), Material(0.1, 0.1, 20.0)],
)
def test_multilevel_holds_what_is_held_and_what_is_kept_in_every_iteration(material):
    V, F = TUBE
    rest, (fixed, targets) = RestMesh(V, F), held(V)
    surface = ElasticSurface(rest.solve_mesh, fixed, material)
    method = multilevel_descent(surface, make_goals(rest, 100.0, None, ()))
    assert isinstance(method, MultilevelDescent)
    method.set_targets(targets)
    for _ in range(40):
        method.step()
        assert method.progress.has_met_goals
        assert np.array_equal(method.progress.U[fixed], targets)
        assert np.isfinite(method.progress.U).all()


@pytest.mark.parametrize("method", ["arap", "exact", "local"])
def test_multilevel_gets_lower_in_a_few_iterations_than_the_fine_one_alone_in_many(method):
    V, F, labels = sample_bottle(1.3)
    fixed = np.flatnonzero(labels != 1)
    centre = V[labels == 2].mean(axis=0)
    targets = V[fixed].copy()
    turned = (targets - centre) @ rotation([0, 1, 0], 2 * np.pi / 3).T + centre
    targets[labels[fixed] == 2] = turned[labels[fixed] == 2]

    def energy(plain, count):
        solver = Deformation(V, F, fixed, method=method, plain=plain)
        solver.aim(targets)
        for _ in range(count):
            solver.iterate()
        return solver.solver.surface.energy

    assert energy(False, 12) < 0.9 * energy(True, 25)


@pytest.mark.parametrize("stiffness", [pytest.param(0.0, marks=pytest.mark.night), 1e-3])
def test_multilevel_brings_the_shape_without_a_jump(stiffness):
    """Of a stiff tube the hand sees at once what will come; one that buckles does so before the eyes."""
    V, F = TUBE
    fixed, _ = ends_of(V)
    solver = Deformation(V, F, fixed, stiffness=stiffness)
    for angle in (0.1, 0.2, 0.3):
        solver.aim(held(V, angle, (0, 0, 0))[1])
        first = shown = solver.step()
    while not solver.settled:
        frame = solver.step()
        assert np.abs(frame.U - shown.U).max() <= 0.03 * solver.rest.diagonal
        shown = frame
    assert shown.converged
    if stiffness:
        assert np.abs(first.U - shown.U).max() <= 3e-3 * solver.rest.diagonal


def test_multilevel_takes_the_coarse_surface_along_in_going_back_by_a_jump():
    V, F = TUBE
    fixed, targets = held(V)
    solver = Deformation(V, F, fixed)
    solver.aim(targets)
    for _ in range(15):
        solver.step()
    solver.aim(V[fixed], U=V)
    assert np.abs(solver.step().U - V).max() <= 1e-9 * solver.rest.diagonal


def test_deformation_has_no_coarse_level_for_what_cannot_be_thinned():
    V, F = soup(*sphere(4))
    rng = np.random.default_rng(0)
    V = V + 0.01 * rng.normal(size=(len(F), 1, 3)).repeat(3, axis=1).reshape(-1, 3)
    solver = Deformation(V, F, np.flatnonzero(V[:, 2] > 0))
    assert type(solver.solver) is ConstrainedDescent
    V, F = TUBE
    nearly_all = np.setdiff1d(np.arange(len(V)), F[::3].ravel()[:200])
    assert type(Deformation(V, F, nearly_all).solver) is ConstrainedDescent


def test_deformation_lets_triangles_that_nothing_joins_go_alone():
    V = np.random.default_rng(0).normal(size=(9000, 3))
    F = np.arange(9000).reshape(-1, 3)
    fixed = F[:, 0]
    solver = Deformation(V, F, fixed)
    solver.aim(V[fixed] + [1.0, 0.0, 0.0])
    frame = solver.step()
    assert np.abs(frame.U - V - [1.0, 0.0, 0.0]).max() <= 1e-6


@pytest.mark.parametrize("mesh", [TUBE, sphere(5)], ids=["tube", "sphere"])
def test_compute_decimations_leaves_nothing_to_be_looked_for_again(mesh, monkeypatch):
    V, F = mesh
    rest = RestMesh(V, F)
    compute_decimations(rest)
    monkeypatch.delattr("apd_viewer.geometry.energy.solve_mesh.decimated_mesh")
    ends, lonely = ends_of(V)[0], np.argmin(np.abs(V[:, 2] - V[:, 2].mean()))
    for method in ("arap", "exact", "local"):
        assert isinstance(Deformation(V, F, ends, method=method, rest=rest).solver, Restarts)
        moved = Deformation(V, F, np.append(ends, lonely), method=method, rest=rest)
        assert isinstance(moved.solver, Restarts), "a coarse vertex is replaced by one far from all others"


def test_multilevel_follows_a_mesh_of_loose_triangles_too():
    V, F = soup(*tube(60, 80))
    fixed = np.flatnonzero(np.abs(V[:, 2] - V[:, 2].mean()) > 0.4 * np.ptp(V[:, 2]))
    solver = Deformation(V, F, fixed)
    turn = np.where(V[fixed, 2:] > V[:, 2].mean(), V[fixed] @ rotation([0, 0, 1], 0.5).T, V[fixed])
    solver.aim(turn)
    for _ in range(5):
        frame = solver.step()
        assert np.isfinite(frame.U).all()
        assert abs(frame.area_error) <= 1e-9


@pytest.mark.parametrize("method", ["arap", "exact"])
def test_multilevel_descent_leaves_a_large_surface_at_rest_where_it_is(method):
    """Also if its positions are single, and decimation folds some of its flat faces into lines."""
    V, F, _ = sample_bottle()
    V, F = trimesh.remesh.subdivide(V, F)
    V = V.astype(np.float32).astype(np.float64)
    height = (V[:, 1] - V[:, 1].min()) / np.ptp(V[:, 1])
    held = np.flatnonzero((height < 0.06) | (height > 0.93))
    solver = Deformation(V, F, held, method=method)
    solver.aim(V[held])
    for _ in range(3):
        assert np.abs(solver.step().U - V).max() < 1e-9 * np.linalg.norm(np.ptp(V, axis=0))
