"""Vertices of the file and vertices of the solve: seams, cracks, and what belongs to no face."""

import tracemalloc

import numpy as np
import pytest
from meshes import box, grid, rotation, soup

from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.weld import SEAM_TOLERANCE, WELD_TOLERANCE, Weld
from apd_viewer.geometry.solver.deformation import Deformation

V, F = box(3, 3, 9)
LENGTH = np.linalg.norm(np.ptp(V, axis=0))


def cracked(by):
    """The box as loose triangles, every corner off by up to ``by`` diagonals."""
    W, G = soup(V, F)
    return W + by * LENGTH * np.random.default_rng(0).uniform(-0.5, 0.5, W.shape) / np.sqrt(3), G


def held(W):
    fixed = np.flatnonzero((W[:, 2] < 0.5) | (W[:, 2] > 8.5))
    X, up = W[fixed].copy(), W[fixed, 2] > 4
    X[up] = X[up] @ rotation([0, 0, 1], 0.7).T + [0.0, 0.3, 0.2]
    return fixed, X


def settled(solver):
    while not (frame := solver.step()).settled:
        pass
    return frame


@pytest.mark.parametrize("by", [0.0, 0.3 * WELD_TOLERANCE])
def test_weld_closes_cracks_within_the_tolerance(by):
    W, G = cracked(by)
    mesh = Mesh(W, G)
    assert len(mesh.weld.first) == len(V)
    kinds = [finding.kind for finding in inspect(mesh).findings]
    assert ("cracks" in kinds) == (by > 0.0)
    assert inspect(mesh).components == 1
    fixed, targets = held(W)
    for method in ("exact", "arap"):
        solver = Deformation(W, G, fixed, method=method)
        solver.aim(targets)
        frame = settled(solver)
        assert np.array_equal(frame.U[fixed], targets)
        whole = Deformation(V, F, held(V)[0], method=method)
        whole.aim(held(V)[1])
        first = [np.flatnonzero(np.abs(W - v).max(axis=1) <= by * LENGTH)[0] for v in V]
        assert np.abs(frame.U[first] - settled(whole).U).max() <= 1e-4 * LENGTH


def test_weld_leaves_cracks_beyond_the_tolerance_open():
    W, G = cracked(300.0 * WELD_TOLERANCE)
    assert len(Mesh(W, G).weld.first) == len(W)


def test_weld_never_joins_a_closed_mesh_by_tolerance():
    tiny = V.copy()
    tiny[:, 0] *= 1e-9  # walls far nearer to each other than the tolerance
    assert len(Weld.from_positions(tiny, F).first) == len(V)


def test_weld_keeps_the_two_ends_of_a_short_edge_two():
    (P, T) = grid(2, 2)
    P = P.copy()
    P[1] = P[0] + [1e-9, 0.0, 0.0]
    assert len(Weld.from_positions(P, T).first) == len(P)


def test_deformation_carries_a_vertex_of_no_face_rigidly():
    """It is fastened to the surface where that is nearest; what does not move leaves it where it is."""
    stray = np.array([[1.5, 1.5, 9.5], [1.5, 1.5, -0.5], [50.0, 0.0, -60.0]])
    W = np.vstack([V, stray])
    fixed, targets = held(V)
    solver = Deformation(W, F, fixed)
    assert np.array_equal(solver.frame().U, W)
    solver.aim(targets)
    U = settled(solver).U
    above = stray[0] @ rotation([0, 0, 1], 0.7).T + [0.0, 0.3, 0.2]
    assert np.abs(U[len(V)] - above).max() < 1e-12
    assert np.array_equal(U[len(V) + 1 :], stray[1:]), "below is held, and so are they"


def test_deformation_puts_a_vertex_of_no_face_that_is_held_where_it_is_held():
    W = np.vstack([V, [[1.5, 1.5, 9.5]]])
    fixed, targets = held(V)
    fixed, targets = np.append(fixed, len(V)), np.vstack([targets, [[7.0, 8.0, 9.0]]])
    solver = Deformation(W, F, fixed)
    solver.aim(targets)
    assert np.array_equal(settled(solver).U[fixed], targets)


def test_deformation_breaks_nothing_without_any_face_with_an_area_nearby():
    W = np.vstack([V, V[:1] + 20.0, V[:1] + 20.0, V[:1] + 21.0])
    G = np.vstack([F, [[len(V), len(V) + 1, len(V)]]])
    fixed, targets = held(V)
    solver = Deformation(W, G, fixed)
    solver.aim(targets)
    assert np.isfinite(settled(solver).U).all()


def test_weld_tells_positions_with_equal_keys_apart():
    mixed, shift = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)

    def key(bits):
        product = bits * mixed
        return product ^ (product >> shift)

    rng, pairs = np.random.default_rng(0), []
    while len(pairs) < 20:
        x, y = rng.normal(size=2), rng.normal(size=1)
        first, second = x.view(np.uint64)
        other = (key(np.array([first])) ^ y.view(np.uint64) ^ key(np.array([second]))).view(np.float64)
        if 1e-30 < abs(other[0]) < 1e30:
            pairs.append([[x[0], y[0], 0.0], [x[1], other[0], 0.0]])
    V = np.tile(np.concatenate(pairs), (5, 1))  # each position five times, in turns with that of its key
    V = V[np.random.default_rng(1).permutation(len(V))]
    weld = Weld.from_positions(V)
    assert len(weld.first) == 40
    np.testing.assert_array_equal(V[weld.representative], V)
    assert (weld.representative <= np.arange(len(V))).all()


def test_weld_compares_no_more_vertices_beside_a_far_part():
    """Every vertex of a small part is within the tolerance of all others there."""
    corners = np.random.default_rng(0).uniform(size=(20_000, 1, 3))
    loose = corners + [[[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]]
    far = [[[1e6, 0, 0], [1e6 + 1e-3, 0, 0], [1e6, 1e-3, 0]]]
    V = np.concatenate([loose, far]).reshape(-1, 3)
    F = np.arange(len(V)).reshape(-1, 3)
    tracemalloc.start()
    try:
        Weld.from_positions(V, F, SEAM_TOLERANCE)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 200e6
