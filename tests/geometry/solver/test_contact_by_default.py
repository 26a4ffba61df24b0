"""Contact where nobody says whether walls are kept apart: by method and number of vertices alone."""

import numpy as np
import pytest
from crossing_check import CrossingCheck
from meshes import ends, rotation, tube

import apd_viewer
from apd_viewer.geometry.solver import methods
from apd_viewer.geometry.solver.methods import METHODS, MOST_VERTICES_IN_CONTACT, contact_by_default

V, F = tube(16, 14)
BASE, HANDLE = ends(V)
FIXED = np.concatenate([BASE, HANDLE])
# In legs, as half a turn has two ways.
WAY = [np.vstack([V[BASE], V[HANDLE] @ rotation([0, 0, 1], np.radians(turn)).T]) for turn in (80, 160)]


def twisted(**given):
    return apd_viewer.deform(V, F, FIXED, np.array(WAY), handle=HANDLE, **given)


def crosses(result):
    return CrossingCheck(V, F).crosses(result.U)


@pytest.mark.parametrize("name", METHODS)
def test_contact_by_default_is_on_for_methods_that_can_touch_up_to_a_number_of_vertices(name):
    touches = METHODS[name].may_use_contact
    assert touches == (name in ("exact", "local", "wall", "arap"))
    assert [
        contact_by_default(name, n) for n in (4, MOST_VERTICES_IN_CONTACT, MOST_VERTICES_IN_CONTACT + 1)
    ] == [
        touches,
        touches,
        False,
    ]


def test_deform_keeps_walls_apart_unless_it_is_said_otherwise():
    by_default, kept, passing = (twisted(**said) for said in ({}, {"contact": True}, {"contact": False}))
    np.testing.assert_array_equal(by_default.U, kept.U)
    assert not crosses(by_default)
    assert crosses(passing)


@pytest.mark.parametrize("method", ["paper", "sr-arap"])
def test_deform_by_methods_without_contact_runs_as_ever(method):
    targets = WAY[0]
    by_default, without = (
        apd_viewer.deform(V, F, FIXED, targets, method, handle=HANDLE, **said)
        for said in ({}, {"contact": False})
    )
    np.testing.assert_array_equal(by_default.U, without.U)
    assert by_default.warnings == without.warnings


def test_deform_lets_plain_iterations_stay_plain():
    plain, without = (
        apd_viewer.deform(V, F, FIXED, WAY[1], "arap", 20, handle=HANDLE, **said)
        for said in ({}, {"contact": False})
    )
    np.testing.assert_array_equal(plain.U, without.U)
    assert (plain.iterations, plain.least_gap, plain.warnings) == (20, None, without.warnings)


def test_deform_says_of_larger_meshes_that_walls_may_pass(monkeypatch):
    monkeypatch.setattr(methods, "MOST_VERTICES_IN_CONTACT", len(V) - 1)
    large, without = (twisted(**said) for said in ({}, {"contact": False}))
    np.testing.assert_array_equal(large.U, without.U)
    (sentence,) = set(large.warnings) - set(without.warnings)
    assert "Walls may pass through each other" in sentence
    assert "--contact" in sentence
    assert not set(twisted(contact=True).warnings) - set(without.warnings)
    assert not any(
        "Walls" in said
        for more in ({"method": "paper"}, {"method": "arap", "iterations": 3})
        for said in apd_viewer.deform(V, F, FIXED, WAY[0], handle=HANDLE, **more).warnings
    )
