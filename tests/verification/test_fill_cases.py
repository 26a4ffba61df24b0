"""Bags and solids of film on coarse meshes, against closed forms and bounds."""

import numpy as np
import pytest

from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.verification import fill_cases
from apd_viewer.verification.case_meshes import platonic_solid
from apd_viewer.verification.fill_cases import (
    INFLATED_SOLIDS,
    MYLAR_BALLOON,
    filled_film,
    filled_to_the_brim,
    mean_strains,
    paper_bag_rule,
    rectangular_bag,
)


def test_mylar_balloon_has_a_curve_as_long_as_the_radius_of_the_discs_and_the_volume_within():
    r, z = MYLAR_BALLOON.curve().T
    assert np.hypot(np.diff(r), np.diff(z)).sum() == pytest.approx(1.0, abs=1e-3)
    assert 2.0 * z[0] == pytest.approx(0.9138932, abs=1e-3)
    half = np.trapezoid(np.pi * r[::-1] ** 2, z[::-1])
    assert 2.0 * half == pytest.approx(1.2185242, abs=3e-3)


def test_paper_bag_rule_is_as_published():
    assert paper_bag_rule(np.array([1.0, 2.0])) == pytest.approx([0.1905, 0.4960], abs=1e-4)


def test_filled_to_the_brim_finds_a_volume_between_bounds_from_below():
    V, F = rectangular_bag(6, 1.0)
    (held,) = filled_to_the_brim(V, F, 0.19, lambda _: ())
    assert 0.17 < held < 0.217


def test_filled_film_holds_its_volume_and_mean_strains_tell_stretch_from_wrinkles():
    V, F = platonic_solid(6, 3)
    U, energy = filled_film(V, F, 1.15 * volume(V, F))
    assert volume(U, F) == pytest.approx(1.15 * volume(V, F), rel=1e-8)
    stretch, strain = mean_strains(V, U, F)
    assert 0.0 < stretch < 1e-3 < strain
    assert energy < 1e-4


def test_mean_strains_are_those_of_an_affine_map():
    V, F = platonic_solid(6, 2)
    for factor, stretch in ((1.01, 0.01), (0.99, 0.0)):
        assert mean_strains(V, factor * V, F) == pytest.approx((stretch, 0.01), abs=1e-12)


def test_inflated_solids_reach_their_bounds_nearly_on_a_coarse_mesh():
    solid = fill_cases.SOLIDS[4]
    stretch, strain, largest = fill_cases.inflated_solid(solid, 2)
    assert largest == pytest.approx(solid.bound, rel=0.01)
    assert stretch < strain < 0.01
    assert INFLATED_SOLIDS.curve()[4] == pytest.approx([20.0, 4.36])
