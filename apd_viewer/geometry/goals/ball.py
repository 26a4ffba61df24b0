"""Ball: the surface that holds most with its area."""

import math

from apd_viewer.errors import InputError
from apd_viewer.language import tr


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
