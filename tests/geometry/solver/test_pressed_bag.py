"""Bags of two sheets that are sewn at their rims, filled, and pressed between plates."""

import itertools

import numpy as np
import pytest

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.scalars import triangle_stretches
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.geometry.solver.pressed_mesh import press
from apd_viewer.geometry.solver.quasi_newton_descent import QuasiNewtonDescent
from apd_viewer.verification.case_meshes import grid, sewn_sheets

SIZE = 40.0  # cm
FILM = {"method": "wall", "wall_thickness": 0.05, "poisson": 0.3, "tension_field": True}
FILLED = 5000.0  # ml, 40 % of the most that it holds
Z = np.array([0.0, 0.0, 1.0])


def pillow(n):
    """Flat bag of two squares with ``n`` edges along a side."""
    uv, F = grid(n, n)
    return sewn_sheets(SIZE * uv, F, 0.01)


def check_steps(found):
    """No step crosses itself, loses of its filling, moves on, or loads one plate more."""
    for step in found.steps:
        assert step.crossings == 0
        assert step.volume == pytest.approx(FILLED, rel=1e-8)
        assert step.settled
        assert step.load_low == pytest.approx(step.load_high, rel=1e-3)


@pytest.mark.parametrize("n", [8, pytest.param(24, marks=pytest.mark.night)])
def test_press_fills_a_flat_pillow_and_halves_its_height_without_stretching_it(n, record_property):
    V, F = pillow(n)
    found = press(V, F, Z, "50%", 5, filled_volume=FILLED, **FILM)
    check_steps(found)
    assert (np.diff([step.load for step in found.steps]) > 0.0).all()
    assert not found.stopped
    height = np.ptp(found.steps[0].U[:, 2])
    assert 5.0 < height < 15.0
    assert found.steps[-1].distance == pytest.approx(0.5 * height, rel=1e-9)
    assert np.ptp(found.U[:, 2]) < 0.5 * height
    for U in (found.steps[0].U, found.U):
        largest, _ = triangle_stretches(V[F], U[F])
        assert np.maximum(largest - 1.0, 0.0).mean() < 3e-3
    record_property("load at half height", found.steps[-1].load)


@pytest.mark.night
@pytest.mark.parametrize("seed", range(1, 7))
def test_press_loads_both_plates_alike_whatever_the_rounding(seed):
    V, F = pillow(8)
    V = V + 1e-10 * np.random.default_rng(seed).normal(size=V.shape)
    check_steps(press(V, F, Z, "50%", 5, filled_volume=FILLED, **FILM))


@pytest.mark.night
def test_press_goes_on_after_searches_that_fail(monkeypatch):
    """A shape that has not moved as its metric was outdated is not at rest."""
    step, count = QuasiNewtonDescent.step, itertools.count(1)

    def failing_at_times(self, held):
        return next(count) % 40 > 0 and step(self, held)

    monkeypatch.setattr(QuasiNewtonDescent, "step", failing_at_times)
    V, F = pillow(8)
    check_steps(press(V, F, Z, "60%", 2, filled_volume=FILLED, **FILM))


@pytest.mark.parametrize("n", [8, pytest.param(20, marks=pytest.mark.night)])
def test_press_keeps_the_area_of_a_filled_pillow_exactly_where_that_is_asked(n):
    """Its mesh wrinkles then, besides each triangle."""
    V, F = pillow(n)
    found = press(V, F, Z, "80%", 3, filled_volume=FILLED, area="100%", **FILM)
    check_steps(found)
    assert [step.area_error for step in found.steps] == pytest.approx([0.0] * 4, abs=1e-9)


@pytest.mark.parametrize("method", ["exact", pytest.param("local", marks=pytest.mark.night)])
@pytest.mark.parametrize("n", [12, pytest.param(40, marks=pytest.mark.night)])
def test_press_halves_the_height_of_a_filled_pillow_of_cloth_with_its_area_exact(method, n):
    V, F = pillow(n)
    found = press(V, F, Z, "50%", 5, method=method, filled_volume=FILLED, area="100%", stiffness=1e-4)
    check_steps(found)
    assert (np.diff([step.load for step in found.steps]) > 0.0).all()
    assert [step.area_error for step in found.steps] == pytest.approx([0.0] * 6, abs=1e-11)
    assert np.ptp(found.U[:, 2]) < 0.5 * np.ptp(found.steps[0].U[:, 2])


@pytest.mark.night
def test_press_comes_to_rest_where_a_full_pillow_has_to_stretch():
    """The gap to the plates does not vanish under its pressure."""
    V, F = pillow(8)
    found = press(V, F, Z, "50%", 4, filled_volume=1.2 * FILLED, **FILM | {"wall_thickness": 0.01})
    assert not found.stopped
    assert all(step.settled and step.crossings == 0 for step in found.steps)
    loads = [step.load for step in found.steps]
    assert loads[-1] > 1000.0 * loads[1]


@pytest.mark.night
def test_press_begins_a_filled_bag_as_a_filled_shape_given_to_it():
    """Pressed at once or from a shape that was filled before, plates touch it at the same height."""
    V, F = pillow(6)
    filled = press(V, F, Z, "95%", 1, filled_volume=FILLED, **FILM).steps
    again = press(V, F, Z, "95%", 1, start=filled[0].U, filled_volume=FILLED, **FILM).steps
    assert again[0].distance == pytest.approx(filled[0].distance, rel=1e-3)
    assert again[1].load == pytest.approx(filled[1].load, rel=0.05)


def test_press_does_not_fill_what_is_full_at_rest():
    V, F = pillow(4)
    V = V * [1.0, 1.0, 300.0]
    held = volume(V, F)
    first = press(V, F, Z, "97%", 1, filled_volume=held, **FILM).steps[0]
    np.testing.assert_allclose(first.U, V, atol=1e-12)


@pytest.mark.parametrize("to", ["half", "nan%", "5000%", "0%"])
def test_press_refuses_a_distance_that_is_no_part_of_the_extent(to):
    with pytest.raises(InputError, match="enter a smaller distance"):
        press(*pillow(4), Z, to, 1, **FILM)


@pytest.mark.night
def test_press_presses_one_filled_cushion_by_another():
    """Without friction a stack of them holds by Exact, which turns no part as a whole.

    Ten times as far off the middle, one of seven topples, by its rounding.
    """
    V, F = pillow(8)
    n = len(V)
    found = press(
        np.vstack([V, V + [0.13, 0.07, 0.6]]), np.vstack([F, F + n]), Z, "60%", 4, filled_volume=2 * FILLED
    )
    for step in found.steps:
        assert step.crossings == 0
        assert step.settled
        assert step.volume == pytest.approx(2 * FILLED, rel=1e-8)
        assert step.area_error == pytest.approx(0.0, abs=1e-9)
        # Both have one pressure, so that either holds its share.
        assert volume(step.U[:n], F) == pytest.approx(FILLED, rel=2e-3)
    assert (np.diff([step.load for step in found.steps]) > 0.0).all()
