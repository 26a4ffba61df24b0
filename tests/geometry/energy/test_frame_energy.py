"""The energy that comes with a frame, against one that is computed afresh for its shape."""

import numpy as np
import oracle
import pytest
from meshes import box, ends, rotation, tube
from remote_factor_double import Elsewhere

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_SHEAR_STIFFNESS,
    METHODS,
    method_material,
)

V, F = box(2, 2, 6)
BASE, HANDLE = ends(V)
FIXED = np.concatenate([BASE, HANDLE])


def targets(angle=0.8, shift=(0.5, 0.0, 0.7)):
    X = V[HANDLE]
    return np.vstack([V[BASE], (X - X.mean(axis=0)) @ rotation([0, 1, 1], angle).T + X.mean(axis=0) + shift])


@pytest.mark.parametrize("method", ["exact", "arap", "paper"])
def test_frame_energy_is_equation_one_with_the_best_rotations_without_other_terms(method):
    solver, w = Deformation(V, F, FIXED, method=method, handle=HANDLE), oracle.edges_of(V, F)
    solver.aim(targets())
    for _ in range(15):
        frame = solver.step()
        assert frame.energy == pytest.approx(oracle.energy(V, frame.U, w), rel=1e-9)
    assert frame.energy > 0.1


@pytest.mark.parametrize("method", ["exact", "paper", "local"])
def test_frame_energy_has_the_terms_of_the_material(method):
    solver = Deformation(V, F, FIXED, method=method, handle=HANDLE, stiffness=0.05)
    material = method_material(METHODS[method], 0.05, DEFAULT_AREA_STIFFNESS, DEFAULT_SHEAR_STIFFNESS)
    afresh = ElasticSurface(RestMesh(V, F).solve_mesh, np.sort(FIXED), material)
    solver.aim(targets())
    for _ in range(6):
        frame = solver.step()
        afresh.restart(frame.U[solver.rest.weld.first])
        assert frame.energy == pytest.approx(afresh.energy, rel=1e-8)
    assert frame.energy > 1.01 * material.rigidity * RestMesh(V, F).energy(frame.U)


def test_frame_energy_is_of_the_shape_shown_while_a_coarse_one_leads_and_others_are_tried():
    V, F = tube(48, 72, height=4.0)
    rest = RestMesh(V, F)
    fixed = np.flatnonzero((V[:, 2] < 0.4) | (V[:, 2] > 3.6))
    held = V[fixed].copy()
    above = held[:, 2] > 2.0
    held[above] = held[above] @ rotation([0, 0, 1], 1.2).T
    solver = Deformation(V, F, fixed, rest=rest)
    solver.aim(held)
    hid = 0
    for _ in range(400):
        frame = solver.step()
        hid += solver.solver.progress.is_iterate_hidden
        assert frame.energy == pytest.approx(rest.energy(frame.U), rel=1e-6)
        if hid > 3 or solver.settled:
            break
    assert hid, "no other shape was tried"


def test_frame_energy_of_a_preview_is_not_known():
    V, F = tube(48, 72, height=4.0)
    fixed = np.flatnonzero((V[:, 2] < 0.4) | (V[:, 2] > 3.6))
    solver = Deformation(V, F, fixed, factored=Elsewhere)
    solver.aim(V[fixed] + [0.0, 0.0, 0.1] * (V[fixed, 2:] > 2.0))
    assert solver.step().energy is None


def test_frame_tells_all_iterations_since_the_solver_was_made():
    solver = Deformation(V, F, FIXED)
    for shift in (0.1, 0.2, 0.3):
        solver.aim(targets(0.0, (0.0, 0.0, shift)))
        for _ in range(4):
            frame = solver.step()
    assert (frame.iteration, frame.total) == (4, 12)
