"""Flat bags of two sheets filled to a volume, by film and by what keeps its area."""

import numpy as np
import pytest

import apd_viewer
from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.operators import area, volume
from apd_viewer.verification.case_meshes import disc, sewn_sheets

V, F = sewn_sheets(*disc(5), 1e-4)
RIM = np.arange(61, 91)
FILM = {"method": "wall", "wall_thickness": 1e-3, "poisson": 0.0, "tension_field": True}


def filled(amount, **how):
    return apd_viewer.deform(V, F, [0], V[:1], **FILM | {"filled_volume": amount, "contact": False} | how)


@pytest.mark.parametrize("contact", [False, pytest.param(True, marks=pytest.mark.night)])
def test_deform_fills_a_flat_bag_of_film_whose_rim_wrinkles(contact):
    """The largest volume of two discs sewn together is 1.2185; coarse meshes hold less."""
    found = filled(1.2, contact=contact)
    assert found.converged
    assert volume(found.U, F) == pytest.approx(1.2, rel=1e-9)
    assert not len(crossings(found.U, F))
    radius = np.linalg.norm(found.U[RIM] - found.U[RIM].mean(axis=0), axis=1)
    assert radius.mean() == pytest.approx(0.76276, rel=0.015)
    # Film does not stretch: no edge is longer than it was.
    edges = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    lengths = [np.linalg.norm(X[edges[:, 1]] - X[edges[:, 0]], axis=1) for X in (found.U, V)]
    assert (lengths[0] / lengths[1]).max() < 1.02


def test_deform_fills_a_flat_bag_that_keeps_its_area_and_refuses_more_than_a_ball():
    found = filled(1.2, method="exact")
    assert found.converged
    assert volume(found.U, F) == pytest.approx(1.2, rel=1e-9)
    assert area(found.U, F) == pytest.approx(area(V, F), rel=1e-9)
    with pytest.raises(InputError, match="as a ball"):
        filled(1.5, method="exact")


def test_deform_takes_a_volume_in_percent_or_in_cubic_units():
    with pytest.raises(InputError, match="omit one"):
        filled(0.5, volume=100)
    with pytest.raises(InputError, match="paper"):
        filled(0.5, method="paper", handle=[0])
