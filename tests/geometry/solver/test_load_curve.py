"""Readings of loads: yield, stiffness, work."""

from dataclasses import replace

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.solver.pressed_mesh import load_curve, pressed_mesh


def test_load_curve_of_a_spring_is_as_stiff_as_it_is_and_never_yields():
    x = np.linspace(0.0, 2.0, 21)
    found = load_curve(x, 3.0 * x)
    assert found.yield_load is None
    assert found.yield_deflection is None
    assert found.apparent_stiffness == pytest.approx(3.0)
    assert found.work == pytest.approx(6.0)


def test_load_curve_yields_at_the_first_fall_though_the_load_rises_again_higher():
    x = np.linspace(0.0, 4.0, 401)
    y = np.sin(np.pi * x / 2.0) + 0.4 * x
    found = load_curve(x, y)
    place = 2.0 / np.pi * np.arccos(-0.8 / np.pi)
    assert found.yield_deflection == pytest.approx(place, abs=0.011)
    assert found.yield_load == pytest.approx(np.sin(np.pi * place / 2.0) + 0.4 * place, rel=1e-3)
    assert y[-1] > found.yield_load


def test_load_curve_does_not_take_noise_for_yield():
    x = np.linspace(0.0, 1.0, 101)
    y = x * (1.0 + 0.004 * np.random.default_rng(0).normal(size=len(x)))
    assert load_curve(x, y).yield_load is None


def test_load_curve_stiffness_is_that_of_the_beginning():
    """Of a load that levels off, not of its mean."""
    x = np.linspace(0.0, 3.0, 301)
    found = load_curve(x, np.tanh(x))
    assert 0.9 < found.apparent_stiffness < 1.0


@pytest.fixture(scope="module")
def spring():
    """A press whose load is 50 times the deflection."""
    V, F = meshes.sphere(1)
    step = apd_viewer.press(V, F, (0, 0, 1), 1.99, 1, iterations=1).steps[0]
    x = np.array([0.0, 0.1, 0.3, 0.35, 1.0])
    return pressed_mesh(
        [replace(step, deflection=d, load_low=50.0 * d, load_high=50.0 * d) for d in x], (), False, None
    )


def test_pressed_bears_a_weight_at_rest_where_its_load_reaches_it(spring):
    assert spring.deflection_under(4.0) == pytest.approx(4.0 / 50.0)
    assert spring.deflection_under(16.0) == pytest.approx(16.0 / 50.0)
    assert spring.deflection_under(51.0) is None


@pytest.mark.parametrize("drop", [0.0, 0.02, 0.5])
def test_pressed_stops_a_dropped_weight_where_the_work_is_that_of_the_weight(spring, drop):
    """Of a spring k: k x^2 / 2 = W (h + x)."""
    weight, k = 10.0, 50.0
    x = (weight + np.sqrt(weight**2 + 2.0 * k * weight * drop)) / k
    assert spring.deflection_under(weight, drop) == pytest.approx(x, rel=1e-9)


def test_pressed_does_not_stop_a_weight_that_falls_too_far(spring):
    assert spring.deflection_under(10.0, 1.6) is None
