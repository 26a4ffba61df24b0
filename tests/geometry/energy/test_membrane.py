"""The membrane's projections against brute force, its forces against its energy, and what "local" keeps."""

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from meshes import box, ends, grid, moved, rotation, sphere, tube
from scipy.optimize import minimize_scalar

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.membrane import LANES, ROWS, Membrane, project_lanes
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.mesh.weighted_areas import Patch
from apd_viewer.geometry.solver.deformation_result import deform

MESHES = {"tube": tube(9, 8, height=3.0, shear=0.6), "box": box(2, 2, 4), "sphere": sphere(2)}


def membrane_of(V, F, shear, area):
    return Membrane(V, Patch(F, len(V)), shear, area)


def projected(D, shear, area):
    """``shear R + area P`` for D (3, 2) in one of many lanes, and the energy."""
    X = np.zeros((ROWS, LANES))
    X[:6], X[:6, 3] = np.random.default_rng(0).normal(size=(6, LANES)), D.ravel()
    project_lanes(X.reshape(-1), shear, area)
    return X[:6, 3].reshape(3, 2), X[-1, 3]


def energy(membrane, U):
    membrane.local_step(U)
    return membrane.energy


entries = st.floats(-4.0, 4.0, allow_nan=False, width=32)


def nearest_of_unit_area(s1, s2):
    """Squared distance from diag(s1, s2) to the nearest diag(p, 1/p), by looking everywhere."""

    def distance(log_p):
        return (np.exp(log_p) - s1) ** 2 + (np.exp(-log_p) - s2) ** 2

    start = np.linspace(-6, 6, 2401)
    best = start[np.argmin(distance(start))]
    return minimize_scalar(
        distance, bounds=(best - 0.01, best + 0.01), method="bounded", options={"xatol": 1e-12}
    ).fun


@settings(max_examples=300, deadline=None)
@given(arrays(np.float64, (3, 2), elements=entries))
@example(np.array([[2.0, 0.0], [0.0, 2.0], [0.0, 0.0]]))  # where the nearest ceases to be the equal stretch
def test_project_lanes_finds_the_nearest_of_all(D):
    left, s, right = np.linalg.svd(D, full_matrices=False)
    if s[1] < 1e-6 * s[0] or s[0] < 1e-3:
        return
    R, shear = projected(D, 1.0, 0.0)
    assert np.abs(R - left @ right).max() <= 1e-7 * s[0] / s[1]
    assert shear == pytest.approx(((s - 1) ** 2).sum(), rel=1e-7, abs=1e-9)
    P, area = projected(D, 0.0, 1.0)
    p = np.linalg.svd(P, compute_uv=False)
    assert p[0] * p[1] == pytest.approx(1.0, rel=1e-9)
    assert area == pytest.approx(((D - P) ** 2).sum(), rel=1e-6, abs=1e-12)
    assert area <= nearest_of_unit_area(*s) * (1 + 1e-6) + 1e-9


def test_project_lanes_pulls_finitely_at_collapsed_triangles():
    for D in (np.zeros((3, 2)), np.outer([1.0, 2, 3], [1.0, 0]), np.full((3, 2), 1e-200)):
        T, energy = projected(D, 0.1, 20.0)
        assert energy == 0.0
        assert np.array_equal(T, (0.1 + 20.0) * D)


@pytest.mark.parametrize("mesh", MESHES)
def test_membrane_forces_are_the_slope_of_the_energy(mesh):
    V, F = MESHES[mesh]
    membrane = membrane_of(V, F, 0.3, 5.0)
    rng = np.random.default_rng(0)
    U, direction = V + 0.05 * rng.normal(size=V.shape), rng.normal(size=V.shape)
    membrane.local_step(U)
    slope = (4 * (membrane.K @ U - membrane.right_hand_side()) * direction).sum()
    h = 1e-6
    quotient = (energy(membrane, U + h * direction) - energy(membrane, U - h * direction)) / (2 * h)
    assert quotient == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("mesh", MESHES)
def test_membrane_costs_nothing_to_turn_and_something_to_grow(mesh):
    V, F = MESHES[mesh]
    membrane = membrane_of(V, F, 0.1, 20.0)
    assert energy(membrane, V @ rotation([1, 2, 3], 2.0).T + 5.0) <= 1e-20 * len(F)
    assert np.abs(membrane.K @ np.ones(len(V))).max() <= 1e-12
    assert np.linalg.eigvalsh(membrane.K.toarray()).min() >= -1e-12
    # Twice as large: every stretch is 2, and the nearest of area 1 is found by looking.
    expected = face_areas(V, F).sum() * (0.1 * 2 + 20.0 * nearest_of_unit_area(2.0, 2.0))
    assert energy(membrane, 2 * V) == pytest.approx(expected, rel=1e-9)


def test_membrane_area_term_lets_a_sheet_shear_freely():
    V, F = grid(5, 5)
    only_area = membrane_of(V, F, 0.0, 1.0)
    assert energy(only_area, V @ np.diag([2.0, 0.5, 1.0])) <= 1e-20
    only_shear = membrane_of(V, F, 1.0, 0.0)
    assert energy(only_shear, V @ np.diag([2.0, 0.5, 1.0])) == pytest.approx(25 * 1.25)


@pytest.mark.parametrize("material", [Material(0.1, 0.1, 20.0), Material(1.0, 2.0, 0.0), Material(0.5, 0, 3)])
@pytest.mark.parametrize("mesh", MESHES)
def test_elastic_surface_with_a_membrane_never_raises_the_energy(mesh, material):
    V, F = MESHES[mesh]
    base, handle = ends(V)
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], 2.0), [0.3, 0, 0.2])])
    surface = ElasticSurface(SolveMesh(V, F), np.concatenate([base, handle]), material)
    energies = []
    for _ in range(60):
        surface.local_step(surface.global_step(targets))
        energies.append(surface.energy)
    assert (np.diff(energies) <= 1e-12 * energies[0]).all()
    assert energies[-1] < energies[0]


def test_deform_by_local_takes_stiffnesses_that_do_what_their_names_say():
    V, F = tube(16, 20)
    base, handle = ends(V)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([V[base], moved(V[handle], rotation([0, 0, 1], 1.2), [0, 0, 1.0])])

    def run(**stiffness):
        U = deform(V, F, fixed, targets, "local", 200, handle=handle, **stiffness).U
        change = np.abs(face_areas(U, F) - face_areas(V, F)).sum()
        return change, energy(membrane_of(V, F, 1.0, 0.0), U)

    soft, firm = run(area_stiffness=2.0), run(area_stiffness=50.0)
    assert firm[0] < soft[0]
    loose, rigid = run(shear_stiffness=0.01), run(shear_stiffness=5.0)
    assert rigid[1] < loose[1]


@pytest.mark.parametrize("name", ["stiffness", "area_stiffness", "shear_stiffness"])
@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, 1e308, "much"])
def test_deform_refuses_stiffnesses_that_are_none(name, value):
    V, F = tube(6, 5)
    fixed = np.concatenate(ends(V))
    with pytest.raises(InputError, match=f"^{name} must be a number from 0"):
        deform(V, F, fixed, V[fixed], "local", 1, **{name: value})


def test_membrane_stays_finite_with_needles():
    V, F = grid(4, 4)
    V = V.copy()
    V[12] = V[7] + [1e-9, 1e-12, 0]
    membrane = membrane_of(V, F, 0.1, 20.0)
    U = V @ rotation([1, 0, 0], 1.0).T
    membrane.local_step(U)
    assert np.isfinite(membrane.right_hand_side()).all()
    assert np.isfinite(membrane.K.toarray()).all()
    assert energy(membrane, U) <= 1e-8
