"""Stiffness between plates against shell theory.

Lengths in radii; the Young's modulus of the cells of Eq. 1 is 4 for each length of edge and their Poisson's
ratio 0, bending has D = 2 stiffness area. Cells resist bending, too, in proportion to the square of their
edges, so two resolutions are extrapolated to none.
"""

import numpy as np
import pytest
from meshes import sphere, tube

from apd_viewer import press

YOUNG = 4.0


def load_per_deflection(V, F, axis, stiffness):
    """Slope at a deflection of two hundredths of the radius, of the shape and not of the plates."""
    extent = np.ptp(V @ axis)
    last = press(V, F, axis, extent - 0.02, 1, method="arap", stiffness=stiffness).steps[-1]
    assert last.load_low == pytest.approx(last.load_high, rel=0.01)
    return 0.5 * (last.load_low + last.load_high) / (extent - np.ptp(last.U @ axis))


def equilateral_tube(around):
    return tube(around, round(around / (2.0 * np.pi) / 0.75**0.5), height=1.0)


@pytest.mark.parametrize(
    "stiffness",
    [pytest.param(0.0005, marks=pytest.mark.night), 0.001, pytest.param(0.002, marks=pytest.mark.night)],
)
def test_press_of_a_ring_between_plates_has_the_stiffness_of_the_closed_form(stiffness):
    """A thin ring that bends and stretches [Timoshenko, Strength of Materials, curved bars]."""
    across = np.array([1.0, 0.0, 0.0])
    coarse, fine = (load_per_deflection(*equilateral_tube(n), across, stiffness) for n in (36, 72))
    area = 2.0 * np.pi
    bends, stretches = (np.pi / 4 - 2 / np.pi) / (2.0 * stiffness * area), np.pi / 4 / YOUNG
    assert fine < coarse
    assert fine + (fine - coarse) / 3.0 == pytest.approx(1.0 / (bends + stretches), rel=0.06)


@pytest.mark.night
def test_press_of_a_sphere_between_plates_has_the_stiffness_of_the_closed_form():
    """Point loads at two poles [Reissner 1946, Stresses and small displacements of shallow shells]."""
    stiffness = 2e-4
    up = np.array([0.0, 0.0, 1.0])
    coarse, fine = (load_per_deflection(*sphere(n), up, stiffness) for n in (4, 5))
    at_a_pole = 8.0 * np.sqrt(2.0 * stiffness * 4.0 * np.pi * YOUNG)
    assert fine < coarse
    assert fine + (fine - coarse) / 3.0 == pytest.approx(0.5 * at_a_pole, rel=0.1)
