"""Criteria of convergence: stricter ones go on for longer and come lower, from wherever one is."""

import numpy as np
import pytest
from meshes import box, ends, rotation, sphere

from apd_viewer import Convergence, Deformation, InputError, deform
from apd_viewer.geometry.solver.convergence import MEMORY, StepConvergence, step_ratio

V, F = box(2, 2, 8)
BASE, HANDLE = ends(V)
FIXED = np.concatenate([BASE, HANDLE])
TARGETS = np.vstack([V[BASE], V[HANDLE] @ rotation([1.0, 0.0, 0.0], 0.8).T])


def result(method="exact", **criteria):
    given = {"handle": HANDLE, "stiffness": 0.01, "contact": False}
    return deform(V, F, FIXED, TARGETS, method, convergence=Convergence(**criteria), **given)


@pytest.mark.parametrize(
    ("method", "name", "tolerances"),
    [
        ("exact", "energy_tolerance", (1e-2, 1e-4, 1e-7)),
        ("local", "energy_tolerance", (1e-2, 1e-7)),
        ("arap", "energy_tolerance", (1e-3, 1e-7)),
        ("paper", "step_tolerance", (1e-6, 1e-7, 1e-8)),  # the area decides before
        ("sr-arap", "step_tolerance", (1e-3, 1e-5, 1e-7)),
    ],
)
def test_convergence_by_a_stricter_tolerance_takes_longer_and_ends_nearer(method, name, tolerances):
    results = [result(method, **{name: tolerance}) for tolerance in tolerances]
    assert all(each.converged for each in results)
    counts = [each.iterations for each in results]
    assert counts == sorted(set(counts))
    exact = result(method, **{name: 1e-13}, most_iterations=5_000).U
    away = [np.abs(each.U - exact).max() for each in results]
    assert away == sorted(away, reverse=True)


def test_convergence_does_not_depend_on_the_other_tolerance():
    for method, name in (("exact", "step_tolerance"), ("paper", "energy_tolerance")):
        np.testing.assert_array_equal(result(method).U, result(method, **{name: 1e-2}).U)


def test_convergence_ends_the_iterations_with_a_sentence():
    found = result("paper", most_iterations=7, step_tolerance=1e-12)
    assert found.iterations == 7
    assert not found.converged
    assert found.warnings[-1] == "The shape did not converge within 7 iterations."
    assert found.convergence.most_iterations == 7


def settle(solver):
    for count in range(3000):
        if solver.settled:
            return count
        solver.iterate()
    raise AssertionError("it did not settle")


@pytest.mark.parametrize("subdivisions", [2, 4])  # without and with coarse levels
def test_deformation_convergence_lets_a_settled_shape_go_on_once_more_is_asked_for(subdivisions):
    W, G = sphere(subdivisions)
    held = np.flatnonzero(np.abs(W[:, 2]) > 0.9)
    solver = Deformation(W, G, held, method="arap", convergence=Convergence(energy_tolerance=1e-2))
    solver.aim(W[held] * [1.0, 1.0, 1.5])
    settle(solver)
    before = solver.rest.energy(solver.frame().U)
    solver.convergence = Convergence(energy_tolerance=1e-8)
    assert not solver.settled
    assert settle(solver) > 0
    after = solver.rest.energy(solver.frame().U)
    assert after <= before
    solver.convergence = Convergence(energy_tolerance=1e-8, most_iterations=5)
    assert solver.settled, "only the tolerance of the energy starts it again"


@pytest.mark.parametrize(
    ("criteria", "sentence"),
    [
        ({"most_iterations": 0}, "iteration limit"),
        ({"most_iterations": 2.5}, "iteration limit"),
        ({"energy_tolerance": 0.0}, "tolerances of convergence"),
        ({"energy_tolerance": float("nan")}, "tolerances of convergence"),
        ({"step_tolerance": -1e-5}, "tolerances of convergence"),
        ({"step_tolerance": "small"}, "tolerances of convergence"),
    ],
)
def test_check_convergence_refuses_criteria_that_cannot_be_used(criteria, sentence):
    with pytest.raises(InputError, match=sentence):
        result(**criteria)


def test_step_ratio_says_nothing_of_steps_to_come_where_they_hardly_become_shorter():
    assert step_ratio([*[1.0] * MEMORY, 1.0 - 1e-16], 1e-5) is None
    assert step_ratio([0.5**k for k in range(MEMORY + 1)], 1e-5) == pytest.approx(0.5**MEMORY / 1e-5)


def test_step_convergence_do_not_end_where_what_stood_still_at_first_moves_now():
    """Found by chance in a session of many verbs."""
    lengths = StepConvergence()
    for step in [0.0] + [1e-6] * MEMORY:
        lengths.append(step)
    assert not lengths.has_converged(Convergence())
