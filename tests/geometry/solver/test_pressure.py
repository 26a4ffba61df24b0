"""Walls under a constant difference of pressure: filling, and panelling."""

import numpy as np
import pytest
from meshes import sphere, tube

from apd_viewer import deform, press
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.verification.case_meshes import disc, sewn_sheets

BALL = sphere(3)
BAG, RIM = sewn_sheets(*disc(10), 1e-4), slice(271, 331)
FILM = {"wall_thickness": 1e-3, "poisson": 0.0, "tension_field": True}


def under(mesh, pressure, **how):
    V, F = mesh
    wall = {"wall_thickness": 0.02, "poisson": 0.3} | how
    return deform(V, F, [0], V[:1], method="wall", pressure=pressure, **wall)


def mean_radius(U):
    return np.linalg.norm(U - U.mean(axis=0), axis=1).mean()


@pytest.mark.parametrize("poisson", [0.0, 0.3])
@pytest.mark.parametrize("pressure", [1e-3, -1e-5])
def test_deform_grows_a_sphere_by_the_law_of_its_membrane(pressure, poisson):
    """A radius R grows by p R^2 (1 - nu) / (2 E t), where E t is 4."""
    found, first = under(BALL, pressure, poisson=poisson), mean_radius(BALL[0])
    assert found.converged
    grown = pressure * first**2 * (1.0 - poisson) / 8.0
    assert mean_radius(found.U) - first == pytest.approx(grown, rel=0.01)


@pytest.mark.night
def test_deform_fills_a_flat_bag_of_film_to_the_mylar_balloon():
    """Two discs of radius 1 hold 1.2185; coarse meshes hold less, and film under pressure stretches."""
    amounts = []
    for pressure in (2e-3, 1e-2):
        found = under(BAG, pressure, **FILM)
        assert found.converged
        amounts.append(volume(found.U, BAG[1]))
    assert amounts[0] < amounts[1]
    assert amounts[0] == pytest.approx(1.2185, rel=0.025)
    radius = np.linalg.norm(found.U[RIM] - found.U[RIM].mean(axis=0), axis=1)
    assert radius.mean() == pytest.approx(0.76276, rel=0.02)


@pytest.mark.parametrize(("share", "is_round"), [(0.97, True), (1.03, False)])
def test_deform_buckles_a_ring_at_the_pressure_of_levy(share, is_round):
    """A ring under outside pressure goes oval from 3 D / R^3 on."""
    thickness = 0.05
    rigidity = 4.0 * thickness**2 / 12.0
    ring = tube(48, 3, height=0.4)
    found = under(ring, -share * 3.0 * rigidity, wall_thickness=thickness, poisson=0.0)
    assert found.converged
    assert found.stable
    radii = np.linalg.norm((found.U - found.U.mean(axis=0))[:, :2], axis=1)
    assert (np.ptp(radii) < 1e-4) == is_round


def test_deform_ends_where_a_pressure_stretches_the_wall_without_limit():
    found = under(BALL, 100.0)
    assert not found.converged
    assert "twice its area" in " ".join(found.warnings)


@pytest.mark.night
def test_press_holds_the_pressure_of_a_bag_whose_load_is_that_on_the_flat_part():
    """Film rests on the plates where it is flat, and carries no load elsewhere."""
    V, F = BAG
    pressure = 5e-3
    step = press(V, F, (0, 0, 1), "50%", 2, method="wall", pressure=pressure, **FILM).steps[-1]
    assert step.settled
    height = step.U[:, 2]
    corners = step.U[F[(height[F] > height.max() - 0.01).all(axis=1)]]
    e, f = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    flat = 0.5 * np.linalg.norm(np.cross(e, f), axis=1).sum()
    assert step.load == pytest.approx(pressure * flat, rel=0.05)


WRONG = {
    "another method": ({"method": "arap"}, "Only the method Wall"),
    "gas": ({"method": "wall", "gas": 1.0}, "exclude each other"),
    "a volume in percent": ({"method": "wall", "volume": 100}, "exclude each other"),
    "a volume": ({"method": "wall", "filled_volume": 1.0}, "exclude each other"),
    "vacuum without contact": ({"method": "wall", "pressure": -1.0, "contact": False}, "needs contact"),
}


@pytest.mark.parametrize("case", WRONG)
def test_deform_refuses_a_pressure_with(case):
    V, F = BALL
    how, words = WRONG[case]
    with pytest.raises(InputError, match=words):
        deform(V, F, [0], V[:1], **{"pressure": 1.0, "contact": True} | how)
