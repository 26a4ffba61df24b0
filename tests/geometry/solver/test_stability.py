"""Rest at a minimum: saddles are found and left, minima stay as they are."""

from itertools import product

import numpy as np
import pytest
from meshes import box, ends, rotation, sphere, tube
from scipy.linalg import eigh

from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.path_iteration import PathIteration, PathStop
from apd_viewer.geometry.solver.stability import StabilitySearch

METHODS = ("exact", "local", "arap")


def sheet(n=20, width=0.5):
    """A flat sheet of length 1, with alternating diagonals; base and handle are its ends."""
    m = round(width * n)
    x, y = np.meshgrid(np.arange(n + 1) / n, np.arange(m + 1) / n, indexing="ij")
    V, F = np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()]), []
    for i, j in product(range(n), range(m)):
        a, b, c, d = ((i + p) * (m + 1) + j + q for p, q in ((0, 0), (1, 0), (1, 1), (0, 1)))
        F += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return V, np.array(F), np.flatnonzero(V[:, 0] == 0.0), np.flatnonzero(V[:, 0] == 1.0)


def settled(V, F, base, handle, move, method, **settings):
    """Solver whose shape has come to rest after a way of ``move`` (n, 3), and its frame."""
    fixed = np.r_[base, handle]
    solver = Deformation(V, F, fixed, handle=handle, method=method, **settings)
    solver.aim((V + move)[fixed])
    while not solver.settled:
        solver.iterate()
    return solver, solver.frame()


def pushed(share, V, base, handle):
    """Motion (n, 3) of the handle towards the base by a share of the length."""
    move = np.zeros_like(V)
    move[handle] = share * (V[base].mean(axis=0) - V[handle].mean(axis=0))
    return move


@pytest.mark.parametrize("contact", [False, True])
@pytest.mark.parametrize("stiffness", [1e-3, pytest.param(1e-4, marks=pytest.mark.night)])
@pytest.mark.parametrize("method", METHODS)
def test_stability_lets_a_flat_sheet_pushed_in_its_plane_end_as_low_as_a_jittered_one(
    method, stiffness, contact
):
    V, F, base, handle = sheet()
    move = pushed(0.3, V, base, handle)
    _, frame = settled(V, F, base, handle, move, method, stiffness=stiffness, contact=contact)
    assert frame.converged
    assert frame.stable
    assert frame.saddle_escapes >= 1
    assert np.abs(frame.U[:, 2]).max() > 0.2
    energies, still = [], Convergence(imperfection=0.0)
    for seed in range(2):
        W = V + 1e-4 * np.random.default_rng(seed).normal(size=V.shape)
        jittered = settled(
            W, F, base, handle, move, method, stiffness=stiffness, contact=contact, convergence=still
        )
        energies.append(jittered[1].energy)
    assert frame.energy <= 1.01 * min(energies)


def rolled(around, along, height, end=1.0):
    """A tube about z with the rows of a sheet, and a radius that goes from 1 to ``end``."""
    angle, z = np.meshgrid(
        2.0 * np.pi * np.arange(around) / around, np.arange(along) / (along - 1), indexing="ij"
    )
    radius, F = 1.0 + (end - 1.0) * z, []
    for i, j in product(range(around), range(along - 1)):
        a, b, c, d = ((i + p) % around * along + j + q for p, q in ((0, 0), (1, 0), (1, 1), (0, 1)))
        F += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    V = np.stack([radius * np.cos(angle), radius * np.sin(angle), height * z], axis=-1)
    return V.reshape(-1, 3), np.array(F)


def _ball():
    V, F = sphere(3)
    return V, F, np.flatnonzero(V[:, 2] < -0.93), np.flatnonzero(V[:, 2] > 0.93)


# Symmetric shapes, and the ways of their handles in shares of the length or in degrees.
SYMMETRIC = {
    "tube pushed": (lambda: rolled(32, 40, 3.0), 0.25, 0.0),
    "tube twisted": (lambda: rolled(32, 40, 3.0), 0.0, 150.0),
    "cone pushed": (lambda: rolled(32, 30, 2.0, 0.4), 0.25, 0.0),
    "box pushed": (lambda: box(8, 8, 12), 0.25, 0.0),
    "ball pushed": (_ball, 0.3, 0.0),
    "sheet sheared": (lambda: sheet(40), 0.0, 0.0),
}


@pytest.mark.night
@pytest.mark.parametrize("contact", [False, True])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SYMMETRIC)
def test_stability_lets_symmetric_shapes_end_as_low_as_jittered_ones(name, method, contact):
    make, push, degrees = SYMMETRIC[name]
    V, F, *held = make()
    base, handle = held or ends(V)
    sheared = np.array([0.0, 0.15, 0.0]) if name.startswith("sheet") else np.zeros(3)

    def energy(shift, imperfection):
        W, fixed = V + shift, np.r_[base, handle]
        solver = Deformation(
            W,
            F,
            fixed,
            handle=handle,
            method=method,
            stiffness=1e-3,
            contact=contact,
            convergence=Convergence(imperfection=imperfection),
        )
        # Which folds a way leads to is decided where the first saddle is left, hence the rest at each stop.
        for part in (0.25, 0.5, 0.75, 1.0) if degrees else (1.0,):
            move = pushed(part * push, V, base, handle)
            R = rotation([0, 0, 1], part * np.radians(degrees))
            move[handle] += V[handle] @ R.T - V[handle] + sheared
            stops = [PathStop((W + move)[fixed])]
            frame = PathIteration(solver, stops).settle(10_000, lambda _: None)
        assert frame.stable is not None
        return frame.energy

    size = np.linalg.norm(np.ptp(V, axis=0))
    jitters = [1e-4 * size * np.random.default_rng(seed).normal(size=V.shape) for seed in range(4)]
    best = min(energy(shift, 0.0) for shift in jitters)
    assert energy(0.0, 1e-4) <= 1.02 * best


@pytest.mark.night
@pytest.mark.parametrize("contact", [False, True])
@pytest.mark.parametrize("stiffness", [1e-3, 1e-4])
@pytest.mark.parametrize("method", METHODS)
def test_stability_lets_a_flat_sheet_fold_alike_in_ten_directions_of_space(method, stiffness, contact):
    V, F, base, handle = sheet(40)
    move, energies = pushed(0.3, V, base, handle), []
    for seed in range(10):
        random = np.random.default_rng(seed)
        R, t = rotation(random.normal(size=3), random.uniform(0.0, np.pi)), random.normal(size=3)
        turned = V @ R.T + t, F, base, handle, move @ R.T
        energies.append(settled(*turned, method, stiffness=stiffness, contact=contact)[1].energy)
    assert max(energies) <= 1.01 * min(energies)


@pytest.mark.parametrize("method", METHODS)
def test_stability_gives_a_strip_one_fold_however_it_lies_and_is_measured(method):
    V, F, base, handle = sheet(40, 0.1)
    move = pushed(0.02, V, base, handle)
    tight = Convergence(energy_tolerance=1e-8)
    R, size = rotation([1, 2, 3], 0.7), 25.4
    order = np.random.default_rng(0).permutation(len(V))
    place = np.argsort(order)
    first, turned, other = (
        settled(*given, method, stiffness=1e-3, convergence=tight)[1].energy
        for given in (
            (V, F, base, handle, move),
            (size * V @ R.T + 7.0, F, base, handle, size * move @ R.T),
            (V[order], place[F], place[base], place[handle], move[order]),
        )
    )
    assert turned / size**2 == pytest.approx(first, rel=1e-6)
    assert other == pytest.approx(first, rel=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_stability_keeps_the_bits_of_a_stable_shape(method):
    V, F = tube(24, 24)
    base, handle = np.flatnonzero(V[:, 2] == V[:, 2].min()), np.flatnonzero(V[:, 2] == V[:, 2].max())
    move = np.zeros_like(V)
    move[handle] = (0.3, 0.0, 0.1)
    fixed = np.r_[base, handle]
    solver = Deformation(V, F, fixed, handle=handle, method=method, stiffness=1e-3)
    solver.aim((V + move)[fixed])
    while not solver.solver.progress.converged:
        solver.iterate()
    before = solver.frame()
    assert not solver.settled, "it is still to be looked at"
    while not solver.settled:
        solver.iterate()
    frame = solver.frame()
    assert frame.stable
    assert frame.saddle_escapes == 0
    assert frame.U.tobytes() == before.U.tobytes()
    assert frame.energy == before.energy
    assert frame.area_error == before.area_error


@pytest.mark.parametrize("method", METHODS)
def test_stability_search_finds_the_lowest_curvature_of_a_dense_hessian(method):
    """Against the whole Hessian by central differences, within the goal of the area."""
    V, F, base, handle = sheet(8)
    still = Convergence(imperfection=0.0)
    move = pushed(0.1, V, base, handle)
    solver, frame = settled(V, F, base, handle, move, method, stiffness=1e-3, convergence=still)
    assert frame.stable is False
    at = solver.solver.equilibrium
    search = StabilitySearch(at, solver.rest.diagonal)
    while not search.has_ended:
        search.step()
    f, small = len(at.surface.free), 1e-5
    H, K = np.empty((3 * f, 3 * f)), np.empty((3 * f, 3 * f))
    for k, unit in enumerate(np.eye(3 * f)):
        way = unit.reshape(f, 3)
        ahead, behind = (at.quarter_gradient(at.moved_along(s * way)) for s in (small, -small))
        H[:, k] = ((ahead - behind) / (2 * small)).ravel()
        K[:, k] = at.solve(way).ravel()  # the inverse of the metric
    at.projection.evaluate(at.surface.U)
    g = at.projection.g[:, at.surface.free].reshape(-1, 3 * f)
    within = np.linalg.svd(g)[2][len(g) :] if len(g) else np.eye(3 * f)
    metric = np.linalg.inv(0.5 * (K + K.T))
    H, metric = (within @ A @ within.T for A in (0.5 * (H + H.T), metric))
    lowest = eigh(H, metric, eigvals_only=True, subset_by_index=(0, 0))[0]
    assert lowest < -0.01
    assert search.lowest >= lowest * (1.0 + 1e-3), "Ritz values lie above"
    assert search.lowest == pytest.approx(lowest, rel=0.3)


def test_convergence_without_imperfection_leaves_a_sheet_flat_and_says_so():
    V, F, base, handle = sheet()
    targets = (V + pushed(0.3, V, base, handle))[np.r_[base, handle]]
    still = Convergence(imperfection=0.0)
    result = deform(V, F, np.r_[base, handle], targets, handle=handle, stiffness=1e-3, convergence=still)
    assert np.abs(result.U[:, 2]).max() == 0.0
    assert result.converged
    assert result.stable is False
    assert result.stability == "not stable: a saddle of the energy"


@pytest.mark.parametrize(("method", "iterations"), [("paper", None), ("sr-arap", None), ("arap", 20)])
def test_stability_text_says_that_iterations_without_a_descent_are_not_examined(method, iterations):
    V, F, base, handle = sheet(8)
    targets = (V + pushed(0.01, V, base, handle))[np.r_[base, handle]]
    result = deform(V, F, np.r_[base, handle], targets, method, iterations, handle=handle, stiffness=1e-3)
    assert result.stable is None
    assert result.stability == "not examined: such iterations minimise no energy"


def test_stability_text_says_that_a_shape_has_not_converged():
    V, F, base, handle = sheet(8)
    targets = (V + pushed(0.1, V, base, handle))[np.r_[base, handle]]
    few = Convergence(most_iterations=2)
    result = deform(V, F, np.r_[base, handle], targets, handle=handle, convergence=few)
    assert (result.stable, result.stability) == (None, "not examined: the shape has not converged")
