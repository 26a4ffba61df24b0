"""Gas within a closed surface, or an open one with capped openings.

An ideal gas at one temperature, as much outside as inside at rest:

    E(U) = p V0 (V / V0 - 1 - ln(V / V0)),        p the pressure at rest, V0 the volume there,

so that its pressure is ``p V0 / V``, and the surface feels that less ``p``.
"""

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import check_argument
from apd_viewer.language import tr


class EnclosedGas:
    """Gas enclosed by a surface, and its energy.

    Parameters
    ----------
    rest : RestMesh
    amount : float
        Pressure times volume at rest, in areas of the surface; greater than 0.

    Raises
    ------
    InputError
        If nothing is enclosed.
    """

    def __init__(self, rest: RestMesh, amount: float) -> None:
        check_argument("gas", amount)
        volume = rest.volume if rest.caps is None else rest.volume_capped
        if not volume:
            raise InputError(tr("The mesh encloses no gas; cap it, or omit the gas."))
        self._patch, self._caps, self._first = rest.solve_mesh.all_triangles, rest.caps, volume
        self._amount = amount * rest.area

    def volume_ratio(self, U: np.ndarray) -> float:
        """Volume at ``U`` (n, 3) relative to the rest volume."""
        return self._volume_and_gradient(U)[0] / self._first

    def energy(self, U: np.ndarray) -> float:
        """Energy at ``U`` (n, 3), square mesh units; infinite for a volume of 0 or less."""
        ratio = self.volume_ratio(U)
        return self._amount * (ratio - 1.0 - float(np.log(ratio))) if ratio > 0.0 else np.inf

    def gradient(self, U: np.ndarray) -> np.ndarray:
        """Gradient of the energy at ``U`` (n, 3), (n, 3)."""
        volume, g = self._volume_and_gradient(U)
        g *= self._amount * (1.0 / self._first - 1.0 / volume)
        return g

    def _volume_and_gradient(self, U: np.ndarray) -> tuple[float, np.ndarray]:
        g = np.zeros_like(U)
        volume = self._patch.volume_and_gradient(U, g)
        if self._caps is not None:
            volume += self._caps.volume_and_gradient(U, U[self._patch.F[0, 0]], g)
        return volume, g
