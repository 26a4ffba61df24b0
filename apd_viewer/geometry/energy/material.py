"""Weights of the terms of the elastic energy."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """Weights of the terms of the energy.

    Attributes
    ----------
    rigidity : float
        Of Eq. 1; greater than zero.
    shear, area : float
        Of what keeps the shape and the area of every triangle.
    bending : float
        Of what keeps the curvature.
    coupling : float
        Of what keeps neighbouring rotations alike, times the total area: alpha of SR-ARAP.
    """

    rigidity: float = 1.0
    shear: float = 0.0
    area: float = 0.0
    bending: float = 0.0
    coupling: float = 0.0
