"""Weights of the terms of the elastic energy."""

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.energy.wall_map import WallMap

# Young's modulus times thickness of the cells of Eq. 1.
_WALL_YOUNG = 4.0


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
        Change of curvature above which bending stays, 1 / mesh unit; infinite for none that does. Of a
        wall map it is that of the mean, see :attr:`yield_curvatures`.
    hardening : float
        Stiffness of a wall that yields over its elastic one, 0 to less than 1.
    thickness : float
        Of a thin elastic wall, mesh units, instead of all the others; 0 for none. Of a wall map the
        mean, to which all weights refer.
    poisson : float
        Of the wall.
    is_relaxed : bool
        True for a wall that wrinkles finer than its mesh: a tension field.
    """

    rigidity: float = 1.0
    shear: float = 0.0
    area: float = 0.0
    bending: float = 0.0
    coupling: float = 0.0
    yield_curvature: float = np.inf
    hardening: float = 0.0
    thickness: float = 0.0
    poisson: float = 0.0
    is_relaxed: bool = False

    @property
    def tensile_stiffness(self) -> float:
        """Young's modulus times thickness at small strains, in uniaxial tension.

        With strains e and f along and across, a unit of area has the energy
        ``(2 rigidity + shear) (e^2 + f^2) + area (e + f)^2 / 2``, which is least at the f of free sides.
        """
        if self.thickness:
            return _WALL_YOUNG
        shape = self.rigidity + 0.5 * self.shear
        size = shape + 0.5 * self.area
        return 8.0 * shape * size / (shape + size)

    @property
    def thickness_factors(self) -> np.ndarray | float:
        """Thickness of every triangle (m,) over the mean; 1 if it is the same everywhere."""
        return self.thickness.factors if isinstance(self.thickness, WallMap) else 1.0

    @property
    def young_factors(self) -> np.ndarray | float:
        """Modulus of every triangle (m,) over the mean; 1 if it is the same everywhere."""
        young = self.thickness.young if isinstance(self.thickness, WallMap) else None
        return 1.0 if young is None else young.factors

    @property
    def yield_curvatures(self) -> np.ndarray | float:
        """Yield curvature of every triangle, (m,), or of all."""
        radius = self.thickness.yield_radius if isinstance(self.thickness, WallMap) else None
        return self.yield_curvature / (self.thickness_factors if radius is None else radius.factors)

    @property
    def plate_rigidity(self) -> float:
        """Bending rigidity D of a thin elastic wall, a squared length."""
        return self.tensile_stiffness * self.thickness**2 / (12.0 * (1.0 - self.poisson**2))
