"""The multifrontal factor against SciPy's, and the order that it eliminates in."""

import numba
import numpy as np
import pytest
import scipy.sparse as sp
from meshes import box, grid, sphere, tube
from scipy.sparse.linalg import spsolve
from threadpoolctl import threadpool_info, threadpool_limits

from apd_viewer.geometry.linalg import block_cholesky
from apd_viewer.geometry.linalg.block_cholesky import BlockPattern
from apd_viewer.geometry.linalg.nested_dissection import elimination_order
from apd_viewer.geometry.mesh.operators import vertex_neighbours

MESHES = {
    "tube": tube(12, 20),
    "box": box(5, 4, 6),
    "sphere": sphere(3),
    "sheet": grid(13, 7),
    "one triangle": (np.eye(3), np.array([[0, 1, 2]])),
}


def graph(F, n):
    """Neighbours of every vertex, itself among them."""
    start, neighbour = vertex_neighbours(F, n)
    A = sp.csr_array((np.ones(len(neighbour)), neighbour, start), shape=(n, n)) + sp.eye_array(n)
    A = A.tocsr()
    A.sort_indices()
    return A.indptr, A.indices


def two_apart(V, F):
    """The same mesh twice, far apart: no separator cuts what is not connected."""
    return np.vstack([V, V + 100.0]), np.vstack([F, F + len(V)])


def random_blocks(start, column, rng):
    """Blocks of a positive definite matrix, and the matrix."""
    n = len(start) - 1
    B = sp.bsr_array((rng.normal(size=(len(column), 3, 3)), column, start), shape=(3 * n, 3 * n))
    A = sp.bsr_array(B + B.T, blocksize=(3, 3))
    A = A + sp.diags_array(np.abs(A).sum(axis=1) + 0.01)
    A = sp.bsr_array(A, blocksize=(3, 3))
    A.sort_indices()
    assert np.array_equal(A.indices, column)
    return A.data, A.tocsc()


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("apart", [False, True])
def test_block_factor_solves_what_scipy_does(mesh, apart):
    V, F = two_apart(*MESHES[mesh]) if apart else MESHES[mesh]
    start, column = graph(F, len(V))
    rng = np.random.default_rng(0)
    pattern = BlockPattern(V, start, column)
    for _ in range(2):  # with one pattern, one matrix after another
        blocks, A = random_blocks(start, column, rng)
        b = rng.normal(size=(len(V), 3))
        x = pattern.factor(blocks).solve(b)
        expected = spsolve(A, b.ravel()).reshape(-1, 3)
        assert np.abs(x - expected).max() <= 1e-5 * np.abs(expected).max()


def test_block_factor_has_a_symmetric_response():
    """Quasi-Newton steps need that of their metric, rounded as it is."""
    V, F = MESHES["tube"]
    start, column = graph(F, len(V))
    rng = np.random.default_rng(1)
    factor = BlockPattern(V, start, column).factor(random_blocks(start, column, rng)[0])
    a, b = rng.normal(size=(2, len(V), 3))
    there, back = (a * factor.solve(b)).sum(), (b * factor.solve(a)).sum()
    assert there == pytest.approx(back, rel=1e-5)


@pytest.mark.skipif(
    numba.config.NUMBA_NUM_THREADS < 2, reason="numba has one thread here, where two are compared"
)
def test_block_factor_gives_the_same_bits_on_any_number_of_cores():
    V, F = grid(40, 40)
    start, column = graph(F, len(V))
    rng = np.random.default_rng(3)
    blocks, B = random_blocks(start, column, rng)[0], rng.normal(size=(len(V), 3))
    found, before = [], numba.get_num_threads()
    for threads in (1, 2):
        numba.set_num_threads(threads)
        found.append(BlockPattern(V, start, column).factor(blocks).solve(B))
    numba.set_num_threads(before)
    assert np.array_equal(*found)


@pytest.mark.parametrize("mesh", MESHES)
def test_elimination_order_couples_no_group_with_another_branch(mesh):
    V, F = two_apart(*MESHES[mesh])
    start, column = graph(F, len(V))
    order, first, parent = elimination_order(V, start, column)
    assert np.array_equal(np.sort(order), np.arange(len(V)))
    groups = len(parent)
    assert ((parent > np.arange(groups)) | (parent < 0)).all()
    group = np.empty(len(V), dtype=int)
    group[order] = np.repeat(np.arange(groups), np.diff(first))

    def ancestors(s):
        while s >= 0:
            yield s
            s = parent[s]

    above = [set(ancestors(s)) for s in range(groups)]
    rows = np.repeat(np.arange(len(V)), np.diff(start))
    assert all(t in above[s] or s in above[t] for s, t in zip(group[rows], group[column], strict=True))


def test_block_pattern_has_cuts_that_are_short():
    """A sheet of n unknowns is known to take n log2 n blocks, times a constant of at most eight."""
    V, F = grid(40, 40)
    pattern = BlockPattern(V, *graph(F, len(V)))
    assert pattern.panel[-1] / 9 <= 8 * len(V) * np.log2(len(V))


def test_block_pattern_cuts_positions_that_coincide_all_the_same():
    V, F = MESHES["sphere"]
    start, column = graph(F, len(V))
    blocks, A = random_blocks(start, column, np.random.default_rng(2))
    b = np.ones((len(V), 3))
    x = BlockPattern(np.zeros_like(V), start, column).factor(blocks).solve(b)
    assert np.abs(A @ x.ravel() - b.ravel()).max() <= 1e-4


def test_block_factor_takes_one_thread_of_blas_and_gives_the_others_back(monkeypatch):
    """Threads of BLAS that wait for each other take thirty times as long on a busy machine."""
    seen, factorize = [], block_cholesky.factorize

    def threads():
        return {found["num_threads"] for found in threadpool_info() if found["user_api"] == "blas"}

    def watched(*arguments):
        seen.append(threads())
        return factorize(*arguments)

    monkeypatch.setattr(block_cholesky, "factorize", watched)
    V, F = tube(12, 20)
    start, column = graph(F, len(V))
    blocks = np.eye(3) * (np.repeat(np.arange(len(V)), np.diff(start)) == column)[:, None, None]
    with threadpool_limits(2, user_api="blas"):
        x = BlockPattern(V, start, column).factor(blocks).solve(V)
        assert threads() == {2}
    assert seen == [{1}]
    assert np.abs(x - V).max() < 1e-6
