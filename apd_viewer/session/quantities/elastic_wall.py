"""Elasticity of a wall in newtons and metres, and the model's loads in newtons.

The model's energy of bending is ``stiffness * area * integral(k1² + k2²)``, that of a wall with the bending
rigidity ``D = 2 stiffness area`` (a squared length) and no Poisson's ratio; the wall's own is
``D = E t³ / (12 (1 - nu²))``. Where a wall bends and hardly stretches, shapes under given plates do not
depend on D, and loads are in proportion to it:

    load in newtons = load of the model * D of the wall / (D of the model * metres in a mesh unit).

A shape that cannot bend without stretching resists by both, and its load is in proportion to
``D^(1 - p) (E t)^p``, where p is the share of the energy in stretching (the derivative of the least energy by
the logarithm of a modulus is the energy that the modulus has). A wall that is thinner than that of the model
resists stretching more, against bending, so that the newtons above are too low; see
:func:`underestimate_factor`.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.session.quantities.units import Unit

_PRESSURES = {
    "pa": 1.0,
    "kpa": 1e3,
    "mpa": 1e6,
    "mbar": 1e2,
    "bar": 1e5,
    "atm": 101_325.0,
    "psi": 6894.757293168,
}
_PASCALS = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9, "psi": 6894.757293168, "ksi": 6894757.293168}
_UNIT = re.compile(r"(?P<amount>.*?)\s*(?P<unit>[a-zA-Z]*)\s*", re.DOTALL)
_SOFTEST, _HARDEST = 1e3, 2e12  # Pa; gels have more, diamond has 1.2e12
_SHOWN = 20  # characters quoted from invalid input
DEFAULT_POISSON = 0.4
# Of 4 pi of a sphere: a mesh on a tube has up to 1, with vertices off by a hundredth of the radius.
_CURVED = 1.5
# Shares of the energy in stretching: spheres and bottles between plates have 0.2 to 0.5, shallow bends less.
_STRETCHED, _ROOT = 0.05, 0.5


class ElasticWall(NamedTuple):
    """A wall that is known in newtons and metres.

    Attributes
    ----------
    thickness : float
        Metres.
    young : float
        Young's modulus, Pa.
    poisson : float
    """

    thickness: float
    young: float
    poisson: float = DEFAULT_POISSON

    @property
    def rigidity(self) -> float:
        """Bending rigidity ``E t³ / (12 (1 - nu²))``, N m."""
        return self.young * self.thickness**3 / (12.0 * (1.0 - self.poisson**2))

    def newtons_per_load(self, stiffness: float, area: float, metre: float) -> float:
        """Newtons of a load of 1 of the model.

        Parameters
        ----------
        stiffness : float
            Of the model, greater than 0.
        area : float
            At rest, square mesh units.
        metre : float
            Metres in a mesh unit.
        """
        return self.rigidity / (2.0 * stiffness * area * metre)

    def model_stiffness(self, area: float, metre: float, young: float) -> float:
        """Stiffness of the model with this wall's proportion of bending to stretch.

        ``D / (E t)`` is ``2 stiffness area / young`` in the model, and ``t² / (12 (1 - nu²))`` of the wall.

        Parameters
        ----------
        area : float
            At rest, square mesh units.
        metre : float
            Metres in a mesh unit.
        young : float
            Young's modulus times thickness of the model; see :class:`Material`.
        """
        return young * self.thickness**2 / (24.0 * (1.0 - self.poisson**2) * area * metre**2)


def underestimate_factor(ratio: float, stretching: float, curvature: float) -> float:
    """Largest factor by which newtons may be too low; less than 1 if too high.

    It is 1 where a shape need not stretch. Where it has to, loads are in proportion to the root of ``D E t``
    or so: that of a sphere is [Reissner 1946]; sharp folds stretch less, and a tube along its axis, while it
    is straight, more. So the power of the ratio is a half, or the share of the energy if that is more.

    Parameters
    ----------
    ratio : float
        Stiffness that the model was pressed with, over that of the wall.
    stretching : float
        Share of the energy in stretching, at the stiffness of the model.
    curvature : float
        Total curvature at rest: what can be unrolled can also bend without stretching.
    """
    forced = curvature > _CURVED and stretching > _STRETCHED
    return ratio ** max(_ROOT, stretching) if forced or stretching > _ROOT else 1.0


def metres_per_unit(unit: Unit) -> float | None:
    """Metres in a unit of length; None if there is none."""
    litres = unit.to_litres(1.0)
    return None if litres is None else 0.1 * math.cbrt(litres)


def parse_young_modulus(text: str) -> float:
    """Young's modulus in Pa from a text; a bare number is in GPa. Raises InputError."""
    parted = _UNIT.fullmatch(text.strip())
    assert parted is not None
    unit = parted["unit"].lower() or "gpa"
    if unit not in _PASCALS:
        raise InputError(
            tr("“{unit}” is not a unit of Young's modulus; use GPa, MPa or psi.").format(unit=parted["unit"])
        )
    try:
        value = _PASCALS[unit] * parse_number(parted["amount"], {})
    except InputError:
        sentence = tr("“{text}” is not a Young's modulus; enter one such as 2.8 GPa.")
        raise InputError(sentence.format(text=text.strip()[:_SHOWN])) from None
    if not _SOFTEST <= value <= _HARDEST:
        raise InputError(
            tr("A Young's modulus of {value:.4g} GPa is out of range; enter one such as 2.8 GPa.").format(
                value=1e-9 * value
            )
        )
    return value


def parse_pressure(text: str) -> float | None:
    """Pressure in Pa from a text, None for a bare number; raises InputError."""
    parted = _UNIT.fullmatch(text.strip())
    assert parted is not None
    unit = parted["unit"].lower()
    if unit and unit not in _PRESSURES:
        raise InputError(
            tr("“{unit}” is not a unit of pressure; use kPa, bar, atm or psi.").format(unit=parted["unit"])
        )
    value = parse_number(parted["amount"], {})
    if not value > 0.0:
        raise InputError(tr("The pressure of the gas must be greater than 0."))
    return _PRESSURES[unit] * value if unit else None


def parse_poisson_ratio(text: str) -> float:
    """Poisson's ratio from a text; raises InputError."""
    value = parse_number(text, {})
    if not 0.0 <= value <= 0.5:
        raise InputError(tr("Poisson's ratio must be from 0 to 0.5, such as 0.4."))
    return value
