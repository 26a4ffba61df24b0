"""The time left until convergence, against series of which it is known."""

import numpy as np
import pytest

from apd_viewer.presentation.time_left import TimeLeftEstimate, duration_text, progress_text, time_left_text


def told(gaps, step=0.2):
    """What a forecast says after each of the gaps, one every ``step`` seconds, and the moments."""
    forecast, said = TimeLeftEstimate(0.0), []
    moments = step * (1.0 + np.arange(len(gaps)))
    for moment, gap in zip(moments, gaps, strict=True):
        forecast.add_sample(moment, gap)
        said.append(forecast.seconds_left(moment))
    return said, moments


@pytest.mark.parametrize("end", [30.0, 300.0])
def test_time_left_estimate_foretells_a_geometric_series_after_a_few_iterations(end):
    gaps = 1e6 ** (1.0 - 0.2 * np.arange(1, round(end / 0.2)) / end)
    said, moments = told(gaps)
    true = end - moments
    known = np.array([left is not None for left in said])
    assert known[np.argmax(known) :].all()
    assert moments[np.argmax(known)] < 0.2 * end
    assert np.abs(np.array(said)[known].astype(float) / true[known] - 1.0).max() < 0.2


def test_time_left_estimate_does_not_jump_by_noise_and_bumps():
    rng, t = np.random.default_rng(0), 0.2 * np.arange(1, 300)
    gaps = np.exp(13.8 * (1.0 - t / 60.0) + 0.5 * rng.standard_normal(len(t)) + 1.5 * np.sin(t / 3.0))
    said = told(gaps)[0]
    said = np.array([np.nan if left is None else left for left in said])
    assert np.isfinite(said).mean() > 0.5
    assert np.nanmax(np.abs(np.diff(said))) < 5.0


@pytest.mark.parametrize("gaps", [np.full(200, 50.0), np.linspace(1.0, 100.0, 200), [None] * 200])
def test_time_left_estimate_says_nothing_of_what_does_not_converge(gaps):
    assert not any(told(gaps)[0])


def test_time_left_estimate_no_longer_foretells_what_stalls():
    gaps = np.r_[1e6 * 0.9 ** np.arange(60), np.full(300, 1e6 * 0.9**60)]
    said = told(gaps)[0]
    assert said[59] is not None
    assert not any(said[-200:])


def test_time_left_estimate_lets_the_time_go_on_while_nothing_is_heard():
    forecast = TimeLeftEstimate(0.0)
    for k in range(1, 50):
        forecast.add_sample(0.2 * k, 1e6 * 0.9**k)
    left = forecast.seconds_left(9.8)
    assert left > 2.0
    assert forecast.seconds_left(10.8) == pytest.approx(left - 1.0)
    assert forecast.seconds_left(9.8 + left) is None
    assert 0.0 < forecast.elapsed_fraction(9.8) < forecast.elapsed_fraction(10.8) < 1.0
    forecast.add_sample(10.0, None)
    assert forecast.seconds_left(10.0) is None


def test_time_left_estimate_counts_what_the_solver_expects_until_the_gap_tells():
    forecast = TimeLeftEstimate(0.0)
    forecast.add_sample(1.0, None, 90.0)
    assert forecast.seconds_left(1.0) == pytest.approx(90.0)
    assert forecast.seconds_left(61.0) == pytest.approx(30.0)
    for k in range(1, 100):
        gap = 1e6 ** (1.0 - k / 100)
        forecast.add_sample(61.0 + 0.2 * k, gap, 30.0 - 0.2 * k)
        assert forecast.seconds_left(61.0 + 0.2 * k) is not None
    assert forecast.seconds_left(80.8) == pytest.approx(0.2, abs=0.1)
    forecast.add_sample(81.0, None)
    assert forecast.seconds_left(81.0) is None


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.3, "about 5 s left"),
        (41.0, "about 40 s left"),
        (100.0, "about 105 s left"),
        (119.0, "about 2 min left"),
        (400.0, "about 7 min left"),
        (9000.0, "more than an hour left"),
    ],
)
def test_time_left_text_says_round_times(seconds, words):
    assert time_left_text(seconds) == words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(99.4, "99 s"), (5400.0, "90 min"), (7190.0, "2 h 0 min"), (9e4, "25 h 0 min")],
)
def test_duration_text_says_times_of_any_length(seconds, words):
    assert duration_text(seconds) == words


def test_progress_text_tells_the_time_so_far_until_the_first_step_is_done():
    assert progress_text("Step 1 of 4", 1.0, 0, 4) == "Step 1 of 4"
    assert progress_text("Step 1 of 4", 20.0, 0, 4) == "Step 1 of 4, 20 s so far"
    assert progress_text("Step 2 of 4", 20.0, 1, 4) == "Step 2 of 4, about 60 s left"
