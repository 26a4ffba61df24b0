"""Weights of the terms of the elastic energy."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Material:
    """Weights of the elastic energy, and its yield curvature.

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
    yield_curvature : float
        Change of curvature above which bending stays, 1 / mesh unit; infinite for none that does.
    """

    rigidity: float = 1.0
    shear: float = 0.0
    area: float = 0.0
    bending: float = 0.0
    coupling: float = 0.0
    yield_curvature: float = np.inf

    @property
    def young(self) -> float:
        """Young's modulus times thickness at small strains, in uniaxial tension.

        With strains e and f along and across, a unit of area has the energy
        ``(2 rigidity + shear) (e^2 + f^2) + area (e + f)^2 / 2``, which is least at the f of free sides.
        """
        shape = self.rigidity + 0.5 * self.shear
        size = shape + 0.5 * self.area
        return 8.0 * shape * size / (shape + size)
