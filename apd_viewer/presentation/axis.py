"""Plot axes: range and labelled ticks."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from apd_viewer.presentation.number_format import format_grouped, format_signed, round_step, superscript

_FEWEST = 1e-12

Ticks: TypeAlias = list[tuple[float, str]]


@dataclass(frozen=True)
class Axis:
    """Range and tick labels of a plot axis.

    Attributes
    ----------
    ticks : callable
        Function giving at most a number of positions on the axis, with their labels.
    """

    low: float
    high: float
    ticks: Callable[[int], Ticks]


def linear_axis(low: float, high: float, suffix: str = "", whole: bool = False) -> Axis:
    """Linear axis; ``suffix`` follows each label."""
    if not high - low > _FEWEST * max(abs(low), abs(high)):
        high = low + 1.0

    def ticks(most: int) -> Ticks:
        step = round_step((high - low) / max(1, most))
        step = max(step, 1.0) if whole else step
        decimals = max(0, -math.floor(math.log10(step) + 1e-9))
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        return [(k * step, f"{format_grouped(k * step, decimals)}{suffix}") for k in range(first, last + 1)]

    return Axis(low, high, ticks)


def rounded_axis(low: float, high: float, suffix: str = "") -> Axis:
    """Linear axis extended to round numbers at both ends."""
    step = round_step((high - low) / 4.0) if high > low else 1.0
    return linear_axis(step * math.floor(low / step + 1e-9), step * math.ceil(high / step - 1e-9), suffix)


def decade_axis(low: float, high: float) -> Axis:
    """Logarithmic axis of fractions, in percent; positions are decimal logarithms."""
    bottom, top = math.floor(math.log10(low)), math.ceil(math.log10(high))
    top = max(top, bottom + 1)

    def ticks(most: int) -> Ticks:
        every = math.ceil((top - bottom + 1) / max(1, most))
        return [(float(k), f"{power_of_ten(k + 2)} %") for k in range(top, bottom - 1, -every)]

    return Axis(float(bottom), float(top), ticks)


def magnitude_axis(low: float, high: float, suffix: str = "") -> Axis:
    """Logarithmic axis between powers of ten; positions are decimal logarithms."""
    bottom, top = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    top = max(top, bottom + 1)

    def ticks(most: int) -> Ticks:
        every = math.ceil((top - bottom + 1) / max(1, most))
        return [(float(k), f"{power_of_ten(k)}{suffix}") for k in range(bottom, top + 1, every)]

    return Axis(float(bottom), float(top), ticks)


def power_of_ten(exponent: int) -> str:
    """Power of ten as text, written out from 0.001 to 1,000."""
    if -3 <= exponent <= 3:
        return format_grouped(10.0**exponent, max(0, -exponent))
    return f"10{superscript(exponent)}"


def ratio_axis(reach: float) -> Axis:
    """Axis of ratios about 1, up to ``reach``; positions are binary logarithms.

    Small changes are written in percent, also beyond ``reach`` up to the end, and large ones as factors.
    """
    small = reach < 2.0
    # On a log axis a decrease lies farther from the centre than an equal increase in percent.
    high = -math.log2(2.0 - reach) if small else math.log2(reach)

    def ticks(most: int) -> Ticks:
        return _percents(reach, most) if small else _factors(high, most)

    return Axis(-high, high, ticks)


def _percents(reach: float, most: int) -> Ticks:
    step = round_step(2.0 * (reach - 1.0) / max(1, most))
    decimals = max(0, -math.floor(math.log10(100.0 * step) + 1e-9))
    count = math.floor((reach - 1.0) / step + 1e-9)
    changes = [k * step for k in range(-count, count + 1)]
    # An increase as long as the decrease by ``reach`` is larger in percent; the axis goes on to it.
    high = -math.log2(2.0 - reach)
    last = step * math.floor((2.0**high - 1.0) / step + 1e-9)
    least = 2.0 * high / max(1, most)  # distance of two labels
    for k in range(count + 1, round(last / step) + 1):
        place = math.log2(1.0 + k * step)
        to_last = math.log2(1.0 + last) - place
        if place - math.log2(1.0 + changes[-1]) >= least and (to_last >= least or k == round(last / step)):
            changes.append(k * step)
    return [(math.log2(1.0 + c), f"{format_signed(100.0 * c, decimals)} %") for c in changes]


def _factors(high: float, most: int) -> Ticks:
    every = max(1, math.ceil(2.0 * high / max(1, most)))
    count = math.floor(high / every + 1e-9)
    steps = [k * every for k in range(-count, count + 1)]
    return [
        (float(k), "1" if k == 0 else f"{'×' if k > 0 else '÷'}{format_grouped(2 ** abs(k), 0)}")
        for k in steps
    ]
