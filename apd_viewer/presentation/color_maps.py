"""Crameri's colour maps: perceptually uniform and colour-blind safe.

From F. Crameri, Scientific colour maps 8 (doi 10.5281/zenodo.1243862, MIT licence), without their darkest
ends, on which shading would be invisible. Linear interpolation between the knots is indistinguishable from
the original.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ColorMap:
    """Piecewise linear colour map.

    Attributes
    ----------
    knots : tuple of (r, g, b)
        Colours from 0 to 255 at equal steps.
    """

    knots: tuple[tuple[int, int, int], ...]

    def colors(self, t: np.ndarray) -> np.ndarray:
        """RGB (k, 3) uint8 at each ``t`` (k,) from 0 to 1, clamped."""
        at, knots = np.linspace(0.0, 1.0, len(self.knots)), np.array(self.knots, dtype=float)
        return np.rint(np.column_stack([np.interp(t, at, channel) for channel in knots.T])).astype(np.uint8)

    def glsl(self, t: str) -> str:
        """GLSL expression of the colour map, a vec3 from 0 to 1; ``t`` names a float."""
        knots, last = np.array(self.knots) / 255.0, len(self.knots) - 1
        steps = [
            f"{_vec3(step)} * clamp({t} * {last:.1f} - {k:.1f}, 0.0, 1.0)"
            for k, step in enumerate(np.diff(knots, axis=0))
        ]
        return " + ".join([_vec3(knots[0]), *steps])


def _vec3(v: np.ndarray) -> str:
    return f"vec3({v[0]:.5f}, {v[1]:.5f}, {v[2]:.5f})"


# Crameri's "bam": hues unlike base and handles, and a nearly white middle for no change.
DIVERGING = ColorMap(
    (
        (134, 37, 108),
        (183, 86, 158),
        (217, 143, 197),
        (238, 205, 229),
        (246, 241, 241),
        (222, 235, 203),
        (159, 195, 120),
        (96, 146, 63),
        (46, 103, 24),
    )
)
# Crameri's "lapaz", reversed.
SEQUENTIAL = ColorMap(
    (
        (254, 242, 243),
        (223, 197, 173),
        (157, 165, 150),
        (104, 147, 162),
        (63, 116, 161),
        (43, 78, 144),
        (33, 37, 117),
    )
)
