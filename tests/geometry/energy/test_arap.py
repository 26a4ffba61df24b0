"""ARAP against an independent oracle, against libigl, and against what must be true of it."""

import igl
import numpy as np
import oracle
import pytest
from meshes import box, ends, grid, moved, rotation, sphere, tube

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform

# name: rotation of the handle about its centroid, and its shift in heights of the mesh
MOVES = {
    "twist": (rotation([0, 0, 1], 2.0), (0, 0, 0)),
    "bend": (rotation([0, 1, 0], 1.2), (0.4, 0, -0.2)),
    "stretch": (np.eye(3), (0, 0, 0.4)),
    "crush": (np.eye(3), (0, 0, -0.6)),
    "shear": (np.eye(3), (0.5, 0.2, 0)),
    "half turn": (rotation([1, 0, 0], np.pi), (0, 0, 0)),
}


def held_ends(V, move):
    base, handle = ends(V)
    R, shift = MOVES[move]
    targets = np.vstack([V[base], moved(V[handle], R, np.array(shift) * np.ptp(V[:, 2]))])
    return np.concatenate([base, handle]), handle, targets


def diagonal(V):
    return np.linalg.norm(np.ptp(V, axis=0))


OBTUSE = tube(10, 12, height=4.0, shear=0.8)


DAILY = {"twist", "shear"}


@pytest.mark.parametrize(
    "move", [pytest.param(move, marks=() if move in DAILY else pytest.mark.night) for move in MOVES]
)
def test_deform_by_arap_equals_the_naive_oracle_after_ten_iterations(move):
    V, F = OBTUSE
    fixed, _, targets = held_ends(V, move)
    expected = oracle.arap(V, F, fixed, targets, 10)
    result = deform(V, F, fixed, targets, "arap", iterations=10)
    assert np.abs(result.U - expected).max() <= 1e-10 * diagonal(V)
    assert result.energy == pytest.approx(oracle.energy(V, expected, oracle.edges_of(V, F)), rel=1e-9)


def test_arap_oracle_has_a_mesh_of_obtuse_triangles():
    V, F = OBTUSE
    corner = V[F[:, [1, 2, 0]]] - V[F], V[F[:, [2, 0, 1]]] - V[F]
    assert ((corner[0] * corner[1]).sum(axis=2) < 0).any(axis=1).mean() > 0.5


GENTLE = {
    "twist": (rotation([0, 0, 1], 1.0), (0, 0, 0)),
    "bend": (rotation([0, 1, 0], 0.7), (0.2, 0, -0.1)),
    "stretch": (np.eye(3), (0, 0, 0.5)),
    "shear": (np.eye(3), (1.0, 0, 0)),
}


@pytest.mark.parametrize("iterations", [1, 5, 40])
@pytest.mark.parametrize("move", GENTLE)
@pytest.mark.parametrize("mesh", [tube(16, 20), sphere(2)], ids=["tube", "sphere"])
def test_deformation_by_arap_equals_the_iterations_of_libigl(mesh, move, iterations):
    """Where no cotangent is negative, clamping changes nothing and libigl minimises the same energy.

    libigl does the local step first, from the shape it is given: here that after our first
    iteration. Its rotations come from a single precision SVD: 1e-8 to 1e-6 of the bounding box was
    measured, the most where a vertex has two nearly equally good rotations.
    """
    V, F = mesh
    z = V[:, 2]
    base = np.flatnonzero(z <= z.min() + 0.3)
    handle = np.flatnonzero(z >= z.max() - 0.3)
    fixed, targets = np.concatenate([base, handle]), np.vstack([V[base], moved(V[handle], *GENTLE[move])])
    solver = Deformation(V, F, fixed, method="arap", plain=True)
    solver.aim(targets)
    start = solver.step().U
    for _ in range(iterations):
        U = solver.step().U

    data = igl.ARAPData()
    data.energy, data.max_iter = igl.ARAP_ENERGY_TYPE_SPOKES, iterations
    igl.arap_precomputation(V, F, 3, fixed.astype(np.int32), data)
    expected = igl.arap_solve(targets, data, start)
    assert np.abs(U - expected).max() <= 3e-6 * diagonal(V)
    rest = RestMesh(V, F)
    assert rest.energy(U) == pytest.approx(rest.energy(expected), rel=1e-6)


def test_solve_mesh_energy_is_that_of_the_formula():
    V, F = OBTUSE
    U = V + 0.3 * np.random.default_rng(0).normal(size=V.shape)
    assert SolveMesh(V, F).energy(U) == pytest.approx(oracle.energy(V, U, oracle.edges_of(V, F)), rel=1e-12)


def test_solve_mesh_energy_of_a_stretched_triangle_is_that_by_hand():
    """Equilateral, side 1, weights cot(60 deg) / 2; 1.5 times as large, every edge misses by 1/2, twice."""
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 3**0.5 / 2, 0]])
    assert SolveMesh(V, np.array([[0, 1, 2]])).energy(1.5 * V) == pytest.approx(6 * (3**-0.5 / 2) / 4)


@pytest.mark.parametrize("mesh", [OBTUSE, box(2, 2, 5)], ids=["tube", "box"])
@pytest.mark.parametrize("move", MOVES)
def test_elastic_surface_never_raises_the_energy_and_its_rotations_stay_rotations(mesh, move):
    V, F = mesh
    fixed, _, targets = held_ends(V, move)
    rest = SolveMesh(V, F)
    arap = ElasticSurface(rest, fixed)
    energies = []
    for _ in range(40):
        arap.local_step(arap.global_step(targets))
        energies.append(rest.energy(arap.U))
        assert np.abs(np.linalg.norm(arap.q, axis=1) - 1.0).max() <= 1e-12
    energies = np.array(energies)
    assert (np.diff(energies) <= 1e-12 * energies[0]).all()


def test_elastic_surface_ends_at_a_minimum_of_the_energy_in_every_direction():
    V, F = OBTUSE
    fixed, _, targets = held_ends(V, "bend")
    rest = SolveMesh(V, F)
    arap = ElasticSurface(rest, fixed)
    for _ in range(1500):
        arap.local_step(arap.global_step(targets))
    rng = np.random.default_rng(0)
    for _ in range(10):
        direction = np.zeros_like(V)
        direction[arap.free] = rng.normal(size=(len(arap.free), 3))
        slope = (rest.energy(arap.U + 1e-5 * direction) - rest.energy(arap.U - 1e-5 * direction)) / 2e-5
        curve = rest.energy(arap.U + 1e-2 * direction) - rest.energy(arap.U)
        assert abs(slope) <= 1e-5
        assert curve > 0


RIGID = {
    "shift": (np.eye(3), (3.0, -2.0, 1.0)),
    "a sixth": (rotation([1, 2, 3], np.pi / 3), (1.0, 0.0, 0.0)),
    "half turn": (rotation([1, 1, 0], np.pi), (0.0, 0.0, 0.0)),
    "a full turn": (rotation([0, 0, 1], 2 * np.pi), (0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("method", ["arap", "paper"])
@pytest.mark.parametrize("motion", RIGID)
def test_deformation_takes_a_rigid_motion_for_a_fixed_point_of_energy_zero(method, motion):
    V, F = OBTUSE
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    expected = moved(V, *RIGID[motion])
    solver = Deformation(V, F, fixed, method=method, handle=handle)
    solver.aim(expected[fixed], U=expected)
    for _ in range(3):
        frame = solver.step()
        assert np.abs(frame.U - expected).max() <= 1e-12 * diagonal(V)
        assert abs(frame.area_error) <= 1e-12
        assert frame.handle_drift <= 1e-12
    assert frame.converged
    assert solver.rest.energy(frame.U) <= 1e-20 * diagonal(V) ** 2


@pytest.mark.parametrize("motion", ["shift", "a sixth", "a full turn"])
def test_deform_by_arap_moves_everything_rigidly_with_a_rigid_motion_of_what_is_held(motion):
    V, F = OBTUSE
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    expected = moved(V, *RIGID[motion])
    result = deform(V, F, fixed, expected[fixed], "arap", iterations=1500)
    assert np.abs(result.U - expected).max() <= 1e-6 * diagonal(V)
    assert result.energy <= 1e-10 * diagonal(V) ** 2


def test_deform_by_arap_puts_held_vertices_exactly_where_they_were_asked_for():
    V, F = OBTUSE
    for move in MOVES:
        fixed, _, targets = held_ends(V, move)
        for n in (1, 7):
            assert np.array_equal(deform(V, F, fixed, targets, "arap", iterations=n).U[fixed], targets)


def test_deform_by_arap_has_rest_as_a_fixed_point():
    V, F = OBTUSE
    fixed = np.concatenate(ends(V))
    result = deform(V, F, fixed, V[fixed], "arap")
    assert result.iterations == 1
    assert result.converged
    assert np.abs(result.U - V).max() <= 1e-13 * diagonal(V)


def test_deform_by_arap_moves_one_free_vertex_along_with_its_neighbors():
    V, F = grid(2, 2)
    fixed = np.delete(np.arange(9), 4)
    targets = V[fixed] + [0.0, 0.0, 1.0]
    result = deform(V, F, fixed, targets, "arap")
    assert np.abs(result.U - V - [0.0, 0.0, 1.0]).max() <= 1e-14


def test_deform_by_arap_swings_one_triangle_about_its_held_edge():
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 1, 0]]), np.array([[0, 1, 2]])
    result = deform(V, F, [0, 1], [[0.0, 0, 0], [0, 1, 0]], "arap", iterations=300)
    assert result.U[2] == pytest.approx([-1, 0.3, 0], abs=1e-6)
    follows = deform(V, F, [2], [[1.0, 2, 3]], "arap", contact=False).U
    assert np.abs(follows - (V + np.array([0.7, 1, 3]))).max() <= 1e-14


def test_deform_by_arap_equals_the_oracle_with_a_handle_in_several_places():
    V, F = sphere(2)
    base = np.flatnonzero(V[:, 2] < -0.8)
    left, right = np.flatnonzero(V[:, 0] < -0.9), np.flatnonzero(V[:, 0] > 0.9)
    fixed = np.concatenate([base, left, right])
    targets = np.vstack([V[base], V[left] - [0.5, 0, 0], V[right] + [0.5, 0, 0]])
    expected = oracle.arap(V, F, fixed, targets, 10)
    assert np.abs(deform(V, F, fixed, targets, "arap", iterations=10).U - expected).max() <= 1e-10


# Triangles that CAD systems and scanners produce.


def with_a_cap(eps):
    """A vertex next to the middle of an edge, joined to it by a triangle with an angle of 180 degrees."""
    V, F = box(2, 2, 5)
    face = np.flatnonzero((V[F][:, :, 2] > 1).all(axis=1))[0]
    i, j, k = F[face]
    new = len(V)
    V = np.vstack([V, (V[i] + V[j]) / 2 + [eps, 0.0, 0.0]])
    return V, np.vstack([np.delete(F, face, axis=0), [[i, new, k], [new, j, k], [i, j, new]]])


def with_a_needle(eps):
    """A face whose corner is doubled, the gap closed by a triangle with a side as short as ``eps``."""
    V, F = box(2, 2, 5)
    face = np.flatnonzero((V[F][:, :, 2] > 1).all(axis=1))[0]
    i, j, k = F[face]
    new = len(V)
    assert V[i, 0] == 0.0  # so that the smallest eps makes a difference
    V = np.vstack([V, V[i] + [eps, 0.0, 0.0]])
    return V, np.vstack([np.delete(F, face, axis=0), [[new, j, k], [i, j, new]]])


@pytest.mark.parametrize("eps", [0.0, 1e-300, 1e-20, 1e-17, 1e-15, 1e-13, 1e-10])
@pytest.mark.parametrize("method", ["arap", "paper"])
@pytest.mark.parametrize("sliver", [with_a_cap, with_a_needle])
def test_deform_takes_no_harm_from_slivers(sliver, method, eps):
    V, F = sliver(eps)
    fixed, handle, targets = held_ends(V, "twist")
    result = deform(V, F, fixed, targets, method, 30, handle=handle)
    assert np.isfinite(result.U).all()
    assert np.isfinite(result.energy)
    if eps >= 1e-20:  # the corners differ and the triangle has an area
        # Stiffness has a limit: the shape is that with a sliver large enough to be seen.
        seen = deform(*sliver(1e-7), fixed, targets, method, 30, handle=handle)
        assert np.abs(result.U - seen.U).max() <= 1e-5 * diagonal(V)


def test_deform_by_arap_is_unchanged_by_faces_with_a_repeated_corner():
    V, F = OBTUSE
    fixed, _, targets = held_ends(V, "twist")
    a, b = F[100, :2]
    more = np.vstack([F, [[a, a, b], [b, b, b], [a, b, a]]])
    expected = deform(V, F, fixed, targets, "arap", iterations=10).U
    assert np.abs(deform(V, more, fixed, targets, "arap", iterations=10).U - expected).max() <= 1e-12


def stitched():
    """Two sheets side by side; along their common line only triangles without area join them."""
    (V, F), (W, G) = grid(4, 2), grid(4, 2)
    left, right = np.flatnonzero(V[:, 1] == 2), np.flatnonzero(W[:, 1] == 0)
    W = W + np.array([0.5, 2.0, 0.0])
    seam = np.column_stack([left[:-1], right[:-1] + len(V), left[1:]])
    return np.vstack([V, W]), np.vstack([F, G + len(V), seam]), len(V)


def test_deform_by_arap_carries_a_part_along_that_only_flat_triangles_join():
    V, F, _ = stitched()
    fixed = np.flatnonzero(V[:, 1] == 0)
    result = deform(V, F, fixed, V[fixed] + [1.0, 2.0, 3.0], "arap", iterations=3)
    assert not any("piece" in warning for warning in result.warnings)
    assert np.abs(result.U - V - [1.0, 2.0, 3.0]).max() <= 1e-8


@pytest.mark.parametrize("needle", [False, True], ids=["", "with a needle elsewhere"])
def test_deform_by_arap_does_not_show_the_floor_under_the_weights(needle):
    V, F, n = stitched()
    if needle:
        V = np.vstack([V, V[0] + [0.0, 0.0, 1e-12]])
        F = np.vstack([F, [[0, F[0, 1], len(V) - 1]]])
    lower, upper = np.flatnonzero(V[:n, 1] == 0), np.flatnonzero(V[:, 1] == 4)
    fixed = np.concatenate([lower, upper])
    targets = np.vstack([V[lower], V[upper] + [0.0, 1.0, 0.0]])
    U = deform(V, F, fixed, targets, "arap", iterations=10).U
    assert np.abs(U[:n] - V[:n]).max() <= 1e-4
    assert np.abs(U[n : 2 * n] - V[n : 2 * n] - [0.0, 1.0, 0.0]).max() <= 1e-4
