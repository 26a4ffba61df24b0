"""Gas within a closed surface, or an open one with capped openings.

An ideal gas at one temperature, as much outside as inside at rest:

    E(U) = p V0 (V / V0 - 1 - ln(V / V0)),        p the pressure at rest, V0 the volume there,

so that its pressure is ``p V0 / V``, and the surface feels that less ``p``. A surface filled from a line, or
emptied by a pump, feels the same difference of pressure at every volume:

    E(U) = -p (V - V0).
"""

from abc import ABC, abstractmethod

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import check_argument
from apd_viewer.language import tr

# Volume relative to the cubed diagonal, below which a surface is flat.
_FLAT = 1e-9


class EnclosedVolume(ABC):
    """Something enclosed by a surface, whose energy depends on the volume alone.

    Attributes
    ----------
    metric_pressure : float
        Derivative of the energy by the volume, as far as it stiffens the surface; 0 if it varies.
    """

    metric_pressure = 0.0

    def __init__(self, rest: RestMesh) -> None:
        self._patch, self._caps = rest.solve_mesh.all_triangles, rest.caps
        self._first = (rest.volume if rest.caps is None else rest.volume_capped) or 0.0

    def energy(self, U: np.ndarray) -> float:
        """Energy at ``U`` (n, 3), square mesh units."""
        return self._energy_and_slope(self._volume_and_gradient(U)[0])[0]

    def gradient(self, U: np.ndarray) -> np.ndarray:
        """Gradient of the energy at ``U`` (n, 3), (n, 3)."""
        volume, g = self._volume_and_gradient(U)
        g *= self._energy_and_slope(volume)[1]
        return g

    @abstractmethod
    def _energy_and_slope(self, volume: float) -> tuple[float, float]:
        """Energy of a volume, and its derivative."""

    def _volume_and_gradient(self, U: np.ndarray) -> tuple[float, np.ndarray]:
        g = np.zeros_like(U)
        volume = self._patch.volume_and_gradient(U, g)
        if self._caps is not None:
            volume += self._caps.volume_and_gradient(U, U[self._patch.F[0, 0]], g)
        return volume, g


class EnclosedGas(EnclosedVolume):
    """Gas enclosed by a surface.

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
        super().__init__(rest)
        if not self._first:
            raise InputError(tr("The mesh encloses no gas; cap it, or omit the gas."))
        self._amount = amount * rest.area

    def _energy_and_slope(self, volume: float) -> tuple[float, float]:
        ratio = volume / self._first
        energy = self._amount * (ratio - 1.0 - float(np.log(ratio))) if ratio > 0.0 else np.inf
        return energy, self._amount * (1.0 / self._first - 1.0 / volume)


class ConstantPressure(EnclosedVolume):
    """Constant difference of pressure, inside less outside.

    Parameters
    ----------
    rest : RestMesh
    pressure : float
        Force per area: 1 / mesh unit, for a wall of Young's modulus times thickness 4.

    Raises
    ------
    InputError
        If the surface has no inside.
    """

    def __init__(self, rest: RestMesh, pressure: float) -> None:
        check_argument("pressure", pressure)
        super().__init__(rest)
        if rest.volume is None and rest.volume_capped is None:
            raise InputError(tr("The mesh encloses nothing that has a pressure; cap it, or omit it."))
        is_inside_out = self._first < -_FLAT * rest.diagonal**3
        self.metric_pressure = pressure if is_inside_out else -pressure

    def _energy_and_slope(self, volume: float) -> tuple[float, float]:
        return self.metric_pressure * (volume - self._first), self.metric_pressure


def enclosed_volume(rest: RestMesh, gas: float | None, pressure: float | None) -> EnclosedVolume | None:
    """Enclosed gas or constant pressure; None without either."""
    if pressure is not None:
        return ConstantPressure(rest, pressure)
    return None if gas is None else EnclosedGas(rest, gas)
