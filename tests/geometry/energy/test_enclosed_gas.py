"""Enclosed gas: its forces, its law, and what it does between plates."""

import numpy as np
import pytest
from meshes import box, grid, sphere, tube

from apd_viewer import deform, press
from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.enclosed_gas import ConstantPressure, EnclosedGas
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.plate_press import PlatePress

Z = np.array([0.0, 0.0, 1.0])
MESHES = {"closed": sphere(2), "open": tube(16, 10), "inside out": (sphere(2)[0], sphere(2)[1][:, ::-1])}


@pytest.mark.parametrize("mesh", MESHES)
def test_enclosed_gas_forces_are_the_slope_of_the_energy(mesh):
    V, F = MESHES[mesh]
    gas, rng = EnclosedGas(RestMesh(V, F), 0.7), np.random.default_rng(0)
    U, way = V + 0.05 * rng.normal(size=V.shape) + 10.0, rng.normal(size=V.shape)
    h = 1e-6
    slope = (gas.energy(U + h * way) - gas.energy(U - h * way)) / (2.0 * h)
    assert (gas.gradient(U) * way).sum() == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("mesh", MESHES)
def test_enclosed_gas_keeps_pressure_times_volume_constant(mesh):
    """The work of a volume that shrinks, and no force at rest."""
    V, F = MESHES[mesh]
    rest = RestMesh(V, F)
    gas, volume = EnclosedGas(rest, 2.0), abs(rest.volume or rest.volume_capped)
    assert gas.energy(V) == pytest.approx(0.0, abs=1e-12)
    assert np.abs(gas.gradient(V)).max() < 1e-12
    for scale in (0.7, 0.9, 1.2):
        ratio, outside = scale**3, 2.0 * rest.area / volume
        # A change of scale by ds changes the volume by 3 V ds / s.
        work = (gas.gradient(scale * V) * V).sum() / (3.0 * scale**2 * volume)
        assert outside - work == pytest.approx(outside / ratio, rel=1e-9)
        known = 2.0 * rest.area * (ratio - 1.0 - np.log(ratio))
        assert gas.energy(scale * V) == pytest.approx(known)


def test_enclosed_gas_of_a_collapsed_surface_has_no_energy_that_could_be_taken():
    V, F = sphere(2)
    gas = EnclosedGas(RestMesh(V, F), 1.0)
    assert gas.energy(V * [1.0, 1.0, -0.1]) == np.inf


def pressed(gas):
    V, F = sphere(2)
    found = press(V, F, Z, 1.4, 2, method="arap", stiffness=0.002, gas=gas)
    assert all(step.settled and step.crossings == 0 for step in found.steps)
    return found.steps


def test_press_with_much_gas_keeps_the_volume_and_with_little_lets_it_go():
    free, little, much = pressed(None), pressed(1e-4), pressed(20.0)
    lost = [1.0 - steps[-1].volume / steps[0].volume for steps in (free, little, much)]
    assert little[-1].load_low == pytest.approx(free[-1].load_low, rel=0.02)
    assert lost[1] == pytest.approx(lost[0], rel=0.02)
    assert lost[2] < 0.1 * lost[0]
    assert much[-1].load_low > 1.2 * free[-1].load_low


def test_plate_press_has_the_load_as_the_slope_of_the_energy_with_that_of_the_gas():
    V, F = sphere(3)
    plates = PlatePress(RestMesh(V, F), Z, 1.5, 1, method="arap", stiffness=0.002, gas=0.5)
    solver, found = plates.solver, []
    for share in (0.995, 1.0):
        plates.set_target(share)
        while not solver.settled:
            solver.iterate()
            assert solver.frame().iteration < 4000
        low, high = solver.frame().loads @ Z
        found.append((solver.contact.energy_in_contact, 0.5 * (high - low)))
    (before, first), (after, last) = found
    assert 0.5 * (first + last) == pytest.approx((after - before) / (0.005 * plates.travel.length), rel=0.01)
    assert solver.frame().volume < solver.rest.volume


@pytest.mark.parametrize(
    ("gas", "words"), [(0.0, "greater than 0"), (-1.0, "greater"), (np.nan, "greater"), (np.inf, "greater")]
)
def test_enclosed_gas_refuses_a_pressure_that_cannot_be(gas, words):
    with pytest.raises(InputError, match=words):
        EnclosedGas(RestMesh(*sphere(2)), gas)


def test_enclosed_gas_refuses_what_encloses_nothing():
    V, F = box(1, 1, 1)
    with pytest.raises(InputError, match="encloses no gas"):
        EnclosedGas(RestMesh(V, F[:2]), 1.0)


@pytest.mark.parametrize("mesh", MESHES)
def test_constant_pressure_has_the_work_of_the_volume_as_its_energy(mesh):
    """Outwards, whichever way the triangles face."""
    V, F = MESHES[mesh]
    rest, rng = RestMesh(V, F), np.random.default_rng(0)
    inside, volume = ConstantPressure(rest, 0.7), abs(rest.volume or rest.volume_capped)
    U, way = V + 0.05 * rng.normal(size=V.shape) + 10.0, rng.normal(size=V.shape)
    h = 1e-6
    slope = (inside.energy(U + h * way) - inside.energy(U - h * way)) / (2.0 * h)
    assert (inside.gradient(U) * way).sum() == pytest.approx(slope, rel=1e-6)
    assert inside.energy(1.1 * V) == pytest.approx(-0.7 * (1.1**3 - 1.0) * volume)


def test_constant_pressure_refuses_what_encloses_nothing():
    V, F = box(1, 1, 1)
    with pytest.raises(InputError, match="encloses nothing"):
        ConstantPressure(RestMesh(V, F[:2]), 1.0)


@pytest.mark.parametrize("method", ["arap", "local"])
def test_deform_with_gas_keeps_the_volume_where_handles_alone_move(method):
    """Without an obstacle and a start shape: the force of the gas is that of the surface at rest."""
    V, F = sphere(2)
    base, top = (np.flatnonzero(side * V[:, 2] > 0.8) for side in (-1.0, 1.0))
    targets = np.vstack([V[base], V[top] - 0.6 * Z])
    found = [
        deform(V, F, np.r_[base, top], targets, handle=top, method=method, gas=gas)
        for gas in (None, 1.0, 30.0)
    ]
    lost = [1.0 - each.volume / RestMesh(V, F).volume for each in found]
    assert all(each.converged for each in found)
    assert lost[0] > 0.09
    assert lost[0] > lost[1] > 2.0 * lost[2] > 0.0


def test_deform_with_creases_compresses_a_sheet_by_handles_alone():
    V, F = grid(12, 6)
    base, top = np.flatnonzero(V[:, 0] == 0.0), np.flatnonzero(V[:, 0] == 12.0)
    targets = np.vstack([V[base], V[top] - [1.5, 0.0, 0.0]])
    found = deform(
        V, F, np.r_[base, top], targets, handle=top, method="arap", stiffness=0.01, yield_radius=2.0
    )
    assert np.isfinite(found.U).all()
    assert found.handle_drift < 1e-9
