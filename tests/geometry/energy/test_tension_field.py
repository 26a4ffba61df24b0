"""Tension field: its states, and its stresses and moduli as derivatives."""

import numpy as np
import pytest

from apd_viewer.geometry.energy.tension_field import relaxed_moduli, relaxed_stress

YOUNG, POISSON = 4.0, 0.3
LAME, MU = YOUNG * POISSON / (1.0 - POISSON**2), YOUNG / (2.0 * (1.0 + POISSON))
# The share of the material's own energy that is left.
LEFT = 1e-3


def strain(e, f, angle):
    """Components e00, e11, e01 of principal strains, e along a direction."""
    m, h = 0.5 * (e + f), 0.5 * (e - f)
    return m + h * np.cos(2.0 * angle), m - h * np.cos(2.0 * angle), h * np.sin(2.0 * angle)


def energy(*components):
    return relaxed_stress(*components, LAME, MU)[0]


def full(e, f):
    return 0.5 * YOUNG / (1.0 - POISSON**2) * (e * e + f * f + 2.0 * POISSON * e * f)


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.0])
def test_relaxed_stress_is_taut_wrinkled_or_slack(angle):
    assert energy(*strain(0.02, -0.005, angle)) == pytest.approx(full(0.02, -0.005))
    # Pulled along the wrinkles as a strip with free sides, whatever the width.
    for width in (-0.01, -0.1):
        wrinkled = relaxed_stress(*strain(0.02, width, angle), LAME, MU)
        assert wrinkled[0] == pytest.approx(0.5 * YOUNG * 0.02**2, abs=LEFT * full(0.02, width))
        assert wrinkled[1] + wrinkled[2] == pytest.approx(YOUNG * 0.02, rel=0.01)
    assert 0.0 < energy(*strain(-0.01, -0.02, angle)) < LEFT * full(-0.01, -0.02)


STATES = [(0.02, 0.01), (0.02, -0.001), (0.02, -0.03), (0.001, -0.03), (-0.01, -0.02)]


@pytest.mark.parametrize(("e", "f"), STATES)
def test_relaxed_moduli_and_relaxed_stress_are_the_derivatives_of_the_energy(e, f):
    at, step, moduli = np.array(strain(e, f, 0.7)), 1e-7, np.empty((3, 3))
    relaxed_moduli(*at, LAME, MU, moduli)
    _, *stress = relaxed_stress(*at, LAME, MU)
    for k, both in enumerate((1.0, 1.0, 2.0)):  # the shear strain counts on either side of the diagonal
        way = step * np.eye(3)[k]
        there, back = (relaxed_stress(*(at + sign * way), LAME, MU) for sign in (1, -1))
        assert both * stress[k] == pytest.approx((there[0] - back[0]) / (2 * step), abs=1e-8)
        change = (np.array(there[1:]) - np.array(back[1:])) / (2 * step)
        assert both * moduli[:, k] == pytest.approx(change, abs=1e-6)
    assert np.linalg.eigvalsh(moduli).min() > 0.0


def test_relaxed_stress_does_not_jump_between_the_states():
    for f in np.linspace(-0.03, 0.01, 9):
        path = [relaxed_stress(*strain(e, f, 0.3), LAME, MU) for e in np.linspace(f, 0.03, 4001)]
        assert np.abs(np.diff(path, axis=0)).max() < 2.0 * YOUNG * 0.06 / 4000
