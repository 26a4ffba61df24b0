"""Factors of sparse systems against SciPy, of every kind that a mesh or a caller may bring."""

import numba
import numpy as np
import pytest
import scipy.sparse as sp
from meshes import box, grid, sample_bottle, sphere, tube
from scipy.sparse.linalg import spsolve

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg import linear_solver
from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.geometry.linalg.supernodal import SupernodalFactor
from apd_viewer.geometry.linalg.supernodes import Supernodes

# Nine of the sixteen digits are left by a condition number of ten millions.
STEPS, RESULTS = 1e-4, 1e-9
RNG = np.random.default_rng(0)


@pytest.fixture(autouse=True)
def of_any_size(monkeypatch):
    """Let small systems have supernodal factors as well."""
    monkeypatch.setattr(linear_solver, "FEWEST_SUPERNODAL_UNKNOWNS", 0)


def pinned(V, F, held=1):
    """Laplacian of a mesh without its first vertices, which leaves it definite; and positions."""
    A = SolveMesh(V, F).L[held:, held:]
    return sp.csr_array(A), V[held:]


def two_apart(V, F):
    return np.vstack([V, V + 100.0]), np.vstack([F, F + len(V)])


def disconnected():
    """Two pieces, one of them held by springs alone."""
    V, F = two_apart(*sphere(2))
    A = SolveMesh(V, F).L + sp.diags_array(np.where(np.arange(len(V)) % 40 == 0, 1.0, 0.0))
    return sp.csr_array(A), V


def scattered():
    """A random system, whose positions tell nothing."""
    n = 400
    B = sp.random_array((n, n), density=0.01, rng=RNG)
    A = B + B.T
    return sp.csr_array(A + sp.diags_array(np.abs(A).sum(axis=1) + 0.01)), RNG.normal(size=(n, 3))


def badly_scaled():
    """Rows and columns over eight orders of magnitude."""
    A, V = pinned(*tube(16, 20), 16)
    d = sp.diags_array(10.0 ** RNG.uniform(-4.0, 4.0, len(V)))
    return sp.csr_array(d @ A @ d), V


def surface(**moduli):
    V, F = tube(24, 30)
    surface = ElasticSurface(SolveMesh(V, F), np.arange(24), Material(**moduli))
    return surface.factored_matrix, V[surface.free]


SYSTEMS = {
    "a single unknown": lambda: (sp.csr_array([[2.0]]), np.zeros((1, 3))),
    "an edge": lambda: (sp.csr_array([[2.0, -1.0], [-1.0, 2.0]]), np.eye(3)[:2]),
    "sphere": lambda: pinned(*sphere(3)),
    "box": lambda: pinned(*box(6, 5, 8)),
    "sheet": lambda: pinned(*grid(40, 25), 40),
    "disconnected": disconnected,
    "all in one place": lambda: (pinned(*sphere(2))[0], np.zeros((161, 3))),
    "scattered": scattered,
    "badly scaled": badly_scaled,
    "bending": lambda: surface(bending=1e-2),
    "membrane": lambda: surface(shear=1.0, area=10.0),
}


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("threads", [1, 2])
def test_linear_solver_solves_what_scipy_does(name, threads):
    A, V = SYSTEMS[name]()
    B = RNG.normal(size=(len(V), 3))
    expected = spsolve(A.tocsc(), B).reshape(B.shape)
    size = np.abs(expected).max()
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(min(threads, before))
        solver = LinearSolver(A, V)
        assert np.abs(solver.solve(B) - expected).max() <= STEPS * size
        assert np.abs(solver.solve_refined(B) - expected).max() <= RESULTS * size
        for k in (1, 2, 5):
            found = solver.solve(np.tile(B, 2)[:, :k])
            assert np.abs(found - np.tile(expected, 2)[:, :k]).max() <= STEPS * size
            found = solver.solve_refined(np.tile(B, 2)[:, :k])
            assert np.abs(found - np.tile(expected, 2)[:, :k]).max() <= RESULTS * size
    finally:
        numba.set_num_threads(before)


@pytest.mark.skipif(
    numba.config.NUMBA_NUM_THREADS < 2, reason="numba has one thread here, where two are compared"
)
def test_linear_solver_gives_the_same_bits_on_any_number_of_cores():
    V, F, _ = sample_bottle(2.0)
    A, V = pinned(V, F, 100)
    B = RNG.normal(size=(len(V), 3))
    found = []
    before = numba.get_num_threads()
    for threads in (1, 2):
        numba.set_num_threads(threads)
        found.append(LinearSolver(A, V).solve_refined(B))
    numba.set_num_threads(before)
    assert np.array_equal(*found)


@pytest.mark.parametrize("sign", [-1.0, 0.0])
def test_linear_solver_refuses_a_matrix_that_is_not_definite(sign):
    A, V = pinned(*sphere(2))
    with pytest.raises(ValueError, match="differ too much in size or shape"):
        LinearSolver(sp.csr_array(A + (sign - 1.0) * sp.diags_array(A.diagonal())), V)


def test_linear_solver_leaves_a_right_hand_side_as_it_is():
    A, V = pinned(*sphere(2))
    B = RNG.normal(size=(len(V), 3))
    before = B.copy()
    LinearSolver(A, V).solve_refined(B)
    assert np.array_equal(B, before)


class TestTheWayBack:
    """CHOLMOD's factor takes over where a supernodal one will not do."""

    @pytest.fixture
    def system(self):
        return pinned(*sphere(3))

    def check(self, solver, A):
        assert not isinstance(solver.factor, SupernodalFactor)
        B = RNG.normal(size=(A.shape[0], 3))
        assert np.abs(A @ solver.solve(B) - B).max() <= 1e-10 * np.abs(B).max()

    def test_linear_solver_does_not_take_cholmod_without_need(self, system):
        assert isinstance(LinearSolver(*system).factor, SupernodalFactor)

    def test_linear_solver_takes_cholmod_without_positions(self, system):
        self.check(LinearSolver(system[0]), system[0])

    def test_linear_solver_takes_cholmod_for_small_systems(self, system, monkeypatch):
        monkeypatch.setattr(linear_solver, "FEWEST_SUPERNODAL_UNKNOWNS", 10**6)
        self.check(LinearSolver(*system), system[0])

    def test_linear_solver_takes_cholmod_where_the_factor_would_be_dense(self, system):
        A, V = system
        nowhere = np.zeros_like(V)
        assert Supernodes(nowhere, A.indptr, A.indices).fill == len(V) ** 2
        self.check(LinearSolver(A, nowhere), A)

    def test_linear_solver_takes_cholmod_where_single_precision_is_not_enough(self, system, monkeypatch):
        monkeypatch.setattr(linear_solver, "LARGEST_RELATIVE_ERROR", 1e-12)
        self.check(LinearSolver(*system), system[0])

    @pytest.mark.parametrize("fault", ["wrong", "raises"])
    def test_linear_solver_takes_cholmod_where_the_self_check_fails(self, system, monkeypatch, caplog, fault):
        def solve(self, B):
            if fault == "raises":
                raise RuntimeError("unknown processor")
            return np.zeros_like(B)

        linear_solver.supernodal_solver_works.cache_clear()
        monkeypatch.setattr(SupernodalFactor, "solve", solve)
        try:
            self.check(LinearSolver(*system), system[0])
        finally:
            linear_solver.supernodal_solver_works.cache_clear()
        assert "self-check" in caplog.text


@pytest.mark.parametrize("mesh", [tube(12, 20), box(5, 4, 6), sphere(3), grid(13, 7), two_apart(*sphere(2))])
def test_supernodes_are_all_unknowns_and_the_tasks_are_apart(mesh):
    A, V = pinned(*mesh)
    nodes = Supernodes(V, A.indptr, A.indices)
    assert np.array_equal(np.sort(nodes.order), np.arange(len(V)))
    assert nodes.first[0] == 0
    assert nodes.first[-1] == len(V)
    task_of = np.searchsorted(nodes.task, np.arange(len(nodes.own_width)), side="right") - 1
    last = len(nodes.task) - 1
    supernode_of = np.repeat(np.arange(len(nodes.own_width)), nodes.own_width)
    for s in range(len(nodes.own_width)):
        later = nodes.later[nodes.begin[s] : nodes.begin[s + 1]]
        assert (later >= nodes.first[s + 1]).all()
        assert np.isin(task_of[supernode_of[later]], [task_of[s], last]).all()
    *shares, top = np.add.reduceat(nodes.own_width, nodes.task) / len(V)
    assert len(shares) >= 4
    assert max(shares) <= 0.25
    assert top < 0.3, "what no two cores can share"


def test_linear_solver_refuses_an_indefinite_matrix_in_a_sentence():
    with pytest.raises(InputError, match="differ too much in size or shape"):
        LinearSolver(sp.csr_array(np.array([[1.0, 2.0], [2.0, 1.0]])))
