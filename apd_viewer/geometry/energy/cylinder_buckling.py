"""Axial buckling loads of thin cylinders, perfect and as designs count on them."""

import numpy as np

from apd_viewer.geometry.energy.material import Material

_THINNEST = 1500.0  # radius over thickness, up to which the tests were made
_DIRECTIONS = 36  # in which widths are measured
_ROUND = 0.9  # smallest ratio of the least width to the largest one


def classical_load(material: Material) -> float:
    """Axial load at which a perfect cylinder of a thin wall buckles.

    It does not depend on the radius: ``2 pi E t^2 / sqrt(3 (1 - nu^2))`` [Timoshenko and Gere 1961, Theory of
    Elastic Stability, 2nd ed., section 11.1], in the units of a press: energy per length, of a material of
    stiffness 1.

    Parameters
    ----------
    material : Material
        Of a thin wall.
    """
    return float(4.0 * np.pi * np.sqrt(material.plate_rigidity * material.tensile_stiffness))


def knock_down_factor(slenderness: float) -> float | None:
    """Share of the classical load that designs count on; None beyond the tests.

    It is a lower bound of them, ``1 - 0.901 (1 - exp(-sqrt(R / t) / 16))`` [Weingarten, Seide and Peterson
    1968, Buckling of thin-walled circular cylinders, NASA SP-8007].

    Parameters
    ----------
    slenderness : float
        Radius over wall thickness.
    """
    if not 0.0 < slenderness < _THINNEST:
        return None
    return float(1.0 - 0.901 * (1.0 - np.exp(-np.sqrt(slenderness) / 16.0)))


def round_radius(points: np.ndarray, axis: np.ndarray) -> float | None:
    """Half the mean width of a body across an axis; None unless about round.

    Parameters
    ----------
    points : (n, 3) float array
    axis : (3,) float array
        Of length 1.
    """
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, np.pi, _DIRECTIONS, endpoint=False)
    across = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), np.cross(axis, first))
    widths = np.ptp(points @ across.T, axis=0)
    is_round = widths.min() > _ROUND * widths.max()
    return 0.5 * float(widths.mean()) if is_round else None
