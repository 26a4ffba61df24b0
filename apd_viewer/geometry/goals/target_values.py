"""Target percentages, and the largest volume within an area."""

import math

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import as_float
from apd_viewer.language import tr

# Targets outside these limits are taken for typing errors.
LEAST_PERCENTAGE, MOST_PERCENTAGE = 1.0, 1000.0
PERCENT_SIGN = "%"
# Smaller numbers could be meant as factors of the rest value instead of percentages.
_FACTORS = MOST_PERCENTAGE / 100.0
# Displayed names of the goals; regions have names given by the user.
GOAL_WORDS = {"the area": tr("the area"), "the volume": tr("the volume")}


def percentage(target: float | str, name: str) -> float:
    """Percentage from a number such as 110 or a string such as ``"1.1%"``.

    Raises
    ------
    InputError
        If it is none, or a number that could be meant as a factor.
    """
    value: object = target
    is_signed = False
    if isinstance(target, str):
        value, is_signed = (
            _number(target.strip().removesuffix(PERCENT_SIGN)),
            target.strip().endswith(PERCENT_SIGN),
        )
    if not LEAST_PERCENTAGE <= (percent := as_float(value)) <= MOST_PERCENTAGE:
        raise InputError(
            tr("The target of {name} must be a percentage from {least:g} to {most:g}, such as 100.").format(
                name=GOAL_WORDS.get(name, name), least=LEAST_PERCENTAGE, most=MOST_PERCENTAGE
            )
        )
    if not is_signed:
        check_not_factor(percent)
    return percent


def check_not_factor(value: float, factors: float = _FACTORS) -> None:
    """Raise InputError for a bare number so small that it may be meant as a factor.

    Parameters
    ----------
    value : float
        Percent.
    factors : float
        Numbers below could be one.
    """
    if value < factors:
        raise InputError(
            tr("{value:g} can mean {percent:g} % or {value:g} %; write {percent:g}% or {value:g}%.").format(
                value=value, percent=100.0 * value
            )
        )


def percentage_text(percent: float | None) -> float | str | None:
    """Percentage as unambiguous input for :func:`percentage`."""
    return percent if percent is None or percent >= _FACTORS else f"{percent!r}{PERCENT_SIGN}"


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def check_fits_in_ball(volume: float, area: float) -> None:
    """Raise InputError if a ball of this ``area`` holds less than ``volume``."""
    if volume > (most := ball_volume(area)):
        raise InputError(
            tr(
                "With its area the surface holds at most {most:.4g} cubic mesh units, as a ball; "
                "enter less than that."
            ).format(most=most)
        )


def ball_volume(area: float) -> float:
    """Volume of a ball with a surface of this ``area``, the largest of all."""
    return area**1.5 / (6.0 * math.sqrt(math.pi))
