"""Turns that a bottle holds and loses, through the call that everybody uses."""

import functools

import numpy as np
import pytest
from meshes import sample_bottle, sphere

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.geometry.solver.deformation_result import deform

Y = np.array([0.0, 1.0, 0.0])


@functools.cache
def bottle():
    """A coarse bottle with its labels."""
    return sample_bottle(3.5)


def turned_bottle(degrees, axis=Y, point=(0.0, 0.0, 0.0), **how):
    """The result of turning the cap on a way of steps below half a turn."""
    V, F, labels = bottle()
    held, cap = np.flatnonzero((labels == BASE) | (labels == HANDLE)), np.flatnonzero(labels == HANDLE)
    count = int(abs(degrees) // 50) + 1
    places = []
    for step in range(1, count + 1):
        R = rotation_about(point, axis, np.deg2rad(degrees * step / count))
        U = V.copy()
        U[cap] = V[cap] @ R[:3, :3].T + R[:3, 3]
        places.append(U[held])
    return deform(V, F, held, np.array(places), handle=cap, **how)


@pytest.mark.parametrize(("degrees", "left"), [(240.0, -120.0), (400.0, 40.0), (-400.0, -40.0), (360.0, 0.0)])
def test_deform_without_contact_says_a_lost_turn(degrees, left):
    result = turned_bottle(degrees, contact=False)
    assert result.turned == pytest.approx((degrees,), abs=1e-6)
    assert result.turned_held == pytest.approx((left,), abs=1e-6)
    (said,) = result.warnings
    assert said.startswith(f"The surface holds {left:g} of the {degrees:g} degrees asked: without contact it")


def test_deform_with_contact_holds_the_turn_that_was_asked():
    result = turned_bottle(-240.0, contact=True)
    assert result.share_reached == 1.0
    assert result.turned_held == pytest.approx((-240.0,), abs=1e-6)
    assert result.warnings == ()


@pytest.mark.parametrize("method", ["paper", "sr-arap", "arap", "local"])
def test_deform_says_by_every_method_what_turn_it_holds(method):
    kept = turned_bottle(100.0, method=method, contact=False)
    assert kept.turned_held == pytest.approx((100.0,), abs=1.0 if method == "paper" else 1e-6)
    assert kept.warnings == ()


def test_deform_raises_no_alarm_at_tipping_and_shifting():
    for axis, degrees in (([1.0, 0.0, 0.0], 60.0), ([0.0, 0.0, 1.0], -100.0), ([1.0, 1.0, 0.0], 90.0)):
        result = turned_bottle(degrees, axis, contact=False)
        assert np.abs(result.turned) == pytest.approx([abs(degrees)], abs=1e-6)
        assert result.turned_held == pytest.approx(result.turned, abs=1e-6)
        assert not any("holds" in said for said in result.warnings)
    assert turned_bottle(2.0, contact=False).turned_held == (None,)


def test_deform_says_that_a_ball_pushed_through_its_own_bottom_is_inside_out():
    V, F = sphere(3)
    base, cap = np.flatnonzero(V[:, 2] < -0.8), np.flatnonzero(V[:, 2] > 0.8)
    for way, inside_out in ((0.5, False), (2.5, True)):
        held = np.concatenate([base, cap])
        targets = np.vstack([V[base], V[cap] - [0.0, 0.0, way]])
        result = deform(V, F, held, targets, "arap", handle=cap, contact=False)
        assert (result.volume < 0.0) == inside_out
        said = [each for each in result.warnings if each.startswith("The surface has turned inside out:")]
        assert len(said) == inside_out
