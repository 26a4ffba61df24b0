"""Closed forms of the cases against numbers computed elsewhere, and against what they must keep."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from apd_viewer.verification.case_meshes import grid
from apd_viewer.verification.press_cases import LIFT_OFF, flattened_load, flattened_volume, hinged_load
from apd_viewer.verification.shape_cases import bonnet, elastica_sag, kresling_height, spindle, spindle_volume


@pytest.mark.parametrize(
    ("distance", "sag"),
    [(0.9, 0.194924), (0.75, 0.292390), (0.5, 0.373306), (0.25, 0.402205), (0.0, 0.391594)],
)
def test_elastica_sag_is_as_tabulated(distance, sag):
    assert elastica_sag(distance) == pytest.approx(sag, abs=1e-6)


def test_elastica_sag_is_that_of_the_equation_of_a_bent_strip():
    """Angle, its curvature, and both coordinates along half of the strip; the load is unknown."""

    def slopes(_, y, p):
        return np.vstack([y[1], -p[0] * np.sin(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(left, right, _):
        return np.array([left[1], left[2], left[3], right[0], right[2] - 0.25])

    s = np.linspace(0.0, 0.5, 41)
    guess = np.vstack([1.2 * np.cos(np.pi * s), -3.8 * np.sin(np.pi * s), 0.5 * s, 0.7 * s])
    found = solve_bvp(slopes, ends, s, guess, p=[13.0], tol=1e-9)
    assert found.success
    assert found.y[3, -1] == pytest.approx(elastica_sag(0.5), rel=1e-6)


@pytest.mark.parametrize(
    ("share", "volume"), [(0.7, 0.903862), (0.6, 0.835491), (0.5, 0.746869), (0.4, 0.637996), (0.3, 0.508873)]
)
def test_flattened_volume_is_as_tabulated(share, volume):
    assert flattened_volume(2.0 * share) == pytest.approx(volume, abs=1e-6)
    assert pytest.approx(1.435540, abs=1e-6) == LIFT_OFF


def test_kresling_height_leaves_the_edges_as_long():
    for tall, low in ((1.6, 0.9099171), (1.4, 0.4774403)):
        assert kresling_height(tall, np.pi / 6.0) == pytest.approx(low, abs=1e-7)
    for turn in (0.0, np.pi / 3.0):  # of the creases that meet in a corner
        before, after = np.pi / 6.0 + turn, np.pi / 2.0 + turn
        lengths = [
            2.0 - 2.0 * np.cos(a) + h**2 for a, h in ((before, 1.6), (after, kresling_height(1.6, np.pi / 6)))
        ]
        assert lengths[0] == pytest.approx(lengths[1], rel=1e-12)


def edge_lengths(V, F):
    return np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2)


def test_bonnet_and_spindle_keep_lengths_whatever_their_parameter():
    """To first order in the edges, which are chords."""
    uv, F = grid(200, 200)
    u, v = 0.4 * uv.T
    for family in (bonnet, spindle):
        first, last = (edge_lengths(family(*words), F) for words in wound(family, u, v))
        assert np.abs(last / first - 1.0).max() < 1e-5


def wound(family, u, v):
    """Arguments of the first surface of a family and of its last."""
    if family is bonnet:
        return (u, v, 0.0), (u, v, np.pi / 2.0)
    return (v, u, 1.0), (v, u / 0.75, 0.75)


def test_spindle_volume_is_as_computed_elsewhere():
    assert spindle_volume(0.75) == pytest.approx(2.5636540, abs=1e-7)
    assert spindle_volume(0.5) == pytest.approx(1.1938366, abs=1e-7)
    assert spindle_volume(1.0) == pytest.approx(4.0 * np.pi / 3.0)
    tip = spindle(np.array([np.pi / 2.0]), np.zeros(1), 0.75)
    assert tip[0] == pytest.approx([0.0, 0.0, 2.6369442 / 2.0], abs=1e-7)


def test_hinged_load_is_as_published():
    assert [hinged_load(share) for share in (0.0, 0.2, 0.4, 0.6)] == pytest.approx(
        [4.0, 4.082, 4.364, 5.0], abs=1e-3
    )


@pytest.mark.parametrize(("share", "load"), [(0.7, 2.929674), (0.5, 5.742160), (0.3, 15.950445)])
def test_flattened_load_is_as_tabulated(share, load):
    assert flattened_load(2.0 * share) == pytest.approx(load, rel=1e-6)
