"""Ticks: round numbers, where they say they are, and never too many."""

import math

import numpy as np
import pytest

from apd_viewer.presentation.axis import decade_axis, linear_axis, power_of_ten, ratio_axis, rounded_axis

RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def value(text):
    """The number that a tick says."""
    number = text.removesuffix(" %").removesuffix(" s").replace(",", "").replace("−", "-")
    if number.startswith("10") and number[2:].translate(RAISED) != number[2:]:
        return 10.0 ** int(number[2:].translate(RAISED))
    return float(number)


def check_within(axis, ticks):
    places = [place for place, _ in ticks]
    span = axis.high - axis.low
    assert all(axis.low - 1e-9 * span <= place <= axis.high + 1e-9 * span for place in places)
    assert len({text for _, text in ticks}) == len(ticks)


@pytest.mark.parametrize("most", [1, 2, 4, 9])
@pytest.mark.parametrize("seed", range(20))
def test_ticks_of_numbers_say_where_they_are(seed, most):
    random = np.random.default_rng(seed)
    low = random.choice([0.0, random.normal()]) * 10.0 ** random.integers(-3, 5)
    high = low + random.uniform(0.1, 10.0) * 10.0 ** random.integers(-3, 5)
    for axis in (linear_axis(low, high, " s"), rounded_axis(low, high, " %")):
        ticks = axis.ticks(most)
        check_within(axis, ticks)
        assert len(ticks) <= most + 1
        for place, text in ticks:
            assert value(text) == pytest.approx(place, abs=1e-9 * max(abs(low), abs(high)))
            lead = abs(value(text)) / 10.0 ** math.floor(math.log10(abs(value(text)) or 1.0))
            assert round(lead, 6) == round(lead, 1) or abs(place) > (axis.high - axis.low), text
    assert rounded_axis(low, high).low <= low + 1e-9 * abs(low)
    assert rounded_axis(low, high).high >= high - 1e-9 * abs(high)


def test_linear_axis_has_no_ticks_between_whole_numbers():
    assert [text for _, text in linear_axis(0.0, 2.0, whole=True).ticks(9)] == ["0", "1", "2"]
    assert linear_axis(0.0, 12_000.0, whole=True).ticks(3)[1][1] == "5,000"


@pytest.mark.parametrize("most", [1, 3, 20])
@pytest.mark.parametrize(("low", "high"), [(1e-13, 2e-9), (1e-7, 0.3), (0.02, 0.03), (1e-3, 1e-3)])
def test_decade_axis_are_percentages(low, high, most):
    axis = decade_axis(low, high)
    assert axis.low <= math.log10(low) <= math.log10(high) <= axis.high
    ticks = axis.ticks(most)
    check_within(axis, ticks)
    assert 1 <= len(ticks) <= most + 1
    for place, text in ticks:
        assert value(text) == pytest.approx(100.0 * 10.0**place, rel=1e-12)


def test_power_of_ten_is_written_out_where_that_is_short():
    assert [power_of_ten(k) for k in (-4, -3, 0, 2, 4)] == ["10⁻⁴", "0.001", "1", "100", "10⁴"]


@pytest.mark.parametrize("reach", [1.001, 1.05, 1.2, 1.5])
@pytest.mark.parametrize("most", [1, 3, 8])
def test_ratio_axis_that_are_small_are_percentages_on_both_sides(reach, most):
    axis = ratio_axis(reach)
    assert axis.low == -axis.high
    ticks = axis.ticks(most)
    check_within(axis, ticks)
    values = [value(text) for _, text in ticks]
    falls = [x for x in values if x < 0.0]
    middle = values.index(0.0)
    assert [-x for x in reversed(falls)] == values[middle + 1 : middle + 1 + len(falls)]
    for place, text in ticks:
        assert 2.0**place == pytest.approx(1.0 + value(text) / 100.0, abs=1e-9)


@pytest.mark.parametrize("most", [6, 8, 14])
def test_ratio_axis_has_labels_up_to_its_end(most):
    axis = ratio_axis(1.5)
    places, texts = zip(*axis.ticks(most), strict=True)
    assert texts[-1] == "+100 %"
    assert places[-1] == pytest.approx(axis.high)
    beyond = [place for place in places if place >= np.log2(1.5 + 1e-9) - 1e-6]
    assert np.diff(beyond).min(initial=np.inf) >= (axis.high - axis.low) / most - 1e-9


@pytest.mark.parametrize("reach", [2.0, 16.0, 1024.0])
def test_ratio_axis_that_are_large_are_factors(reach):
    axis = ratio_axis(reach)
    for place, text in axis.ticks(6):
        factor = float(text.lstrip("×÷").replace(",", ""))
        assert 2.0**place == (1.0 / factor if text.startswith("÷") else factor)
    assert {"1"} < {text for _, text in axis.ticks(6)}
