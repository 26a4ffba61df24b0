"""Numbers as people write them: no figure is lost, and none is invented."""

import math

import numpy as np
import pytest

from apd_viewer.presentation.number_format import format_position, format_short, format_significant

RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


def value(text):
    """What a person reads."""
    number, _, power = text.partition("·10")
    return float(number.replace("−", "-").replace(",", "")) * 10.0 ** int((power or "0").translate(RAISED))


@pytest.mark.parametrize(("written", "digits"), [(format_significant, 6), (format_short, 3)])
def test_number_format_lets_numbers_of_any_size_be_read_as_they_are(written, digits):
    for x in np.geomspace(1e-20, 1e20, 997):
        text = written(x)
        assert value(text) == pytest.approx(x, rel=0.51 * 10.0 ** (1 - digits))
        assert "e" not in text, "that is how programs write it"


def test_format_significant_gives_negative_numbers_true_minus_signs():
    for x in np.geomspace(1e-20, 1e20, 97):
        assert format_significant(-float(x)) == "−" + format_significant(float(x))


def test_format_short_writes_a_number_that_rounds_to_a_thousand_as_one():
    assert [format_short(x) for x in (999.4, 999.5, 1000.0, 1234.5)] == ["999", "1,000", "1,000", "1,234"]
    assert [format_short(x) for x in (0.00025, 2e-6, 20.0)] == ["0.00025", "2·10⁻⁶", "20"]
    assert [format_significant(x) for x in (1234567.0, 407.117, 2.4e-17)] == [
        "1.23457·10⁶",
        "407.117",
        "2.40000·10⁻¹⁷",
    ]


@pytest.mark.parametrize("step", [2e-7, 0.05, 0.1, 0.5, 1.0, 20.0])
@pytest.mark.parametrize("middle", [0.0, 12.0, -1000.0, 123_456.0])
def test_format_position_tells_places_on_an_axis_from_each_other(step, middle):
    ticks = step * np.arange(round(middle / step) - 8, round(middle / step) + 9)
    texts = [format_position(float(tick), step) for tick in ticks]
    assert len(set(texts)) == len(texts)
    np.testing.assert_allclose([value(text) for text in texts], ticks, rtol=0, atol=0.1 * step)
    assert "-" not in "".join(texts)


def test_format_position_that_is_nothing_but_rounding_is_zero():
    assert format_position(math.sin(math.pi), 1.0) == format_position(-1e-17, 0.1) == "0"


def test_format_significant_groups_digits_and_begins_powers_at_a_million():
    assert [format_significant(x) for x in (123456.7, 999999.4, 12345.678)] == [
        "123,457",
        "999,999",
        "12,345.7",
    ]
    assert [format_significant(x, 4) for x in (1234.5, 12345.6, 99999.9, 999999.6)] == [
        "1,234",
        "12,346",
        "100,000",
        "1.000·10⁶",
    ]
