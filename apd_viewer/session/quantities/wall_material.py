"""Wall materials: parsing of typed properties, and known materials with sources."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trc
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS, parse_number

DEFAULT_POISSON = 0.4
GPA = 1e9  # Pa
# Units of density in g/cm³, the unit of a bare number.
_DENSITIES = {
    **dict.fromkeys(("g/cm3", "g/cc", "g/ml", "kg/l", "kg/dm3", "t/m3"), 1.0),
    **dict.fromkeys(("kg/m3", "g/l"), 1e-3),
    "lb/ft3": 453.59237 / 30.48**3,
    "lb/in3": 453.59237 / 2.54**3,
    "oz/in3": 28.349523125 / 2.54**3,
}
_PSI = 6894.757293168  # Pa
MODULI = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": GPA, "psi": _PSI, "ksi": 6894757.293168}
_PRESSURES = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "mbar": 1e2, "bar": 1e5, "atm": 101_325.0, "psi": _PSI}
_AMOUNT_AND_WORD = re.compile(r"(.*?)\s*([a-zA-Z]*)", re.DOTALL)
_AMOUNT_AND_RATIO = re.compile(r"(.+?)\s*(?<![a-z])([a-z]+\s*[/∕⁄]\s*[a-z]+\^?[3³]?)", re.DOTALL)
_SPELLINGS = str.maketrans({"³": "3", "^": "", "∕": "/", "⁄": "/"})
_SHOWN = 20  # maximum number of characters quoted from invalid input
_HEAVIEST = 100.0  # g/cm³; osmium has 22.6
_SOFTEST, _HARDEST = 1e3, 2e12  # Pa; gels have more, diamond has 1.2e12


class WallMaterial(NamedTuple):
    """Properties of a wall material; None if undefined or too variable.

    Attributes
    ----------
    name : str
        On the command line.
    thickness : float
        Of a typical wall, mm.
    density : float or None
        g/cm³.
    young : float or None
        Young's modulus, GPa.
    yield_strain : float or None
        Yield stress over Young's modulus; None where bends do not last.
    source : str
        Of these numbers.
    """

    name: str
    title: str
    thickness: float
    density: float | None
    young: float | None
    poisson: float | None
    yield_strain: float | None
    source: str

    def yield_radius(self, thickness: float) -> float | None:
        """Bending radius at which the outer fibres yield, in the unit of ``thickness``.

        None where bends do not last.
        """
        return None if self.yield_strain is None else thickness / (2.0 * self.yield_strain)


# Where a source gives a range, its geometric mean is taken.
WALL_MATERIALS = (
    WallMaterial("pet-bottle", tr("PET, wall of a bottle"), 0.3, 1.36, 3.4, 0.38, 0.0175, tr(
        "Callister, Materials Science and Engineering, 7th ed., appendix B: 2.76 to 4.14 GPa, "
        "yield at 59.3 MPa; MatWeb, mean of 134 grades: 1.36 g/cm³; Poisson's ratio as of PET film")),
    WallMaterial("pet-film", tr("PET film, oriented"), 0.1, 1.39, 4.9, 0.38, 0.02, tr(
        "DuPont Teijin Films, Mylar, Physical-Thermal Properties, H-37232-3: 490 to 510 kg/mm², "
        "10 kg/mm² at 5 % elongation")),
    WallMaterial("hdpe", tr("HDPE, bottle or film"), 0.5, 0.96, 1.08, 0.42, 0.027, tr(
        "Callister, Materials Science and Engineering, 7th ed., appendix B: 0.959 g/cm³, 1.08 GPa, "
        "yield at 26.2 to 33.1 MPa; Poisson's ratio as usual for polyethylene, 0.40 to 0.46")),
    WallMaterial("aluminium-foil", tr("Aluminium foil, annealed"), 0.016, 2.71, 69.0, 0.33, 0.0005, tr(
        "Aluminum Association, Aluminum Standards and Data, 1100-O: 2.71 g/cm³, 68.9 GPa, yield at "
        "34 MPa; thickness of household foil")),
    WallMaterial("tinplate", tr("Tinplate TS275, wall of a can"), 0.2, 7.85, 210.0, 0.3, 0.0013, tr(
        "EN 10202, TS275: proof strength 275 MPa; EN 1993-1-1, 3.2.6, for the elasticity of steel")),
    WallMaterial("paper", trc("material", "Paper"), 0.1, 0.64, 5.2, 0.33, 0.0044, tr(
        "Ashby, Materials and the Environment, Paper and cardboard: 480 to 860 kg/m³, 3 to 8.9 GPa, "
        "elastic limit 15 to 34 MPa; Schulgasser, Fibre Science and Technology 19, 297 (1983): "
        "Poisson's ratio 1/3")),
    WallMaterial("fabric", tr("Fabric"), 0.3, None, None, None, None, tr(
        "no values: weaves differ too much, and their folds do not last; enter your own density")),
)  # fmt: skip


def wall_material(name: str) -> WallMaterial | None:
    """Known material by name, None for an empty name; raises InputError."""
    known = {material.name: material for material in WALL_MATERIALS}
    if name and name not in known:
        raise InputError(
            tr("There is no material “{name}”; choose one of {known}.").format(
                name=name, known=", ".join(known)
            )
        )
    return known.get(name)


def parse_density(text: str) -> float:
    """Density in g/cm³ from a text; raises InputError."""
    unknown = tr("“{unit}” is not a unit of density; use g/cm³, kg/m³ or lb/ft³.")
    amount, factor = _amount_and_factor(text, _AMOUNT_AND_RATIO, _DENSITIES, unknown)
    value = (factor or 1.0) * _number(
        amount, text, tr("“{text}” is not a density; enter one such as 1.38 g/cm³.")
    )
    if not 0.0 < value <= _HEAVIEST:
        raise InputError(
            tr("A density of {value:.4g} g/cm³ is out of range; enter one such as 1.38 g/cm³.").format(
                value=value
            )
        )
    return value


def parse_young_modulus(text: str) -> float:
    """Young's modulus in Pa from a text; a bare number is in GPa. Raises InputError."""
    unknown = tr("“{unit}” is not a unit of Young's modulus; use GPa, MPa or psi.")
    amount, factor = _amount_and_factor(text, _AMOUNT_AND_WORD, MODULI, unknown)
    value = (factor or GPA) * _number(
        amount, text, tr("“{text}” is not a Young's modulus; enter one such as 2.8 GPa.")
    )
    if not _SOFTEST <= value <= _HARDEST:
        raise InputError(
            tr("A Young's modulus of {value:.4g} GPa is out of range; enter one such as 2.8 GPa.").format(
                value=1e-9 * value
            )
        )
    return value


def parse_poisson_ratio(text: str) -> float:
    """Poisson's ratio from a text; raises InputError."""
    value = parse_number(text, {})
    if not 0.0 <= value <= 0.5:
        raise InputError(tr("Poisson's ratio must be from 0 to 0.5, such as 0.4."))
    return value


def parse_pressure(text: str) -> float | None:
    """Pressure of gas in Pa from a text, None for a bare number; raises InputError."""
    value, factor = _pressure_and_factor(text)
    if not value > 0.0:
        raise InputError(tr("The pressure of the gas must be greater than 0."))
    return None if factor is None else factor * value


def parse_pressure_difference(text: str) -> float:
    """Pressure in Pa from a text such as ``-50mbar``; raises InputError."""
    value, factor = _pressure_and_factor(text)
    if factor is None:
        raise InputError(tr("A pressure needs a unit; enter one such as 30mbar or -0.2bar."))
    return factor * value


def has_pressure_unit(text: str) -> bool:
    """True if a text ends with a unit of pressure."""
    parted = _AMOUNT_AND_WORD.fullmatch(text.strip()) if len(text) <= MOST_CHARACTERS else None
    return parted is not None and parted[2].lower() in _PRESSURES


def _pressure_and_factor(text: str) -> tuple[float, float | None]:
    """Number, and the factor of its unit; None for a bare number."""
    unknown = tr("“{unit}” is not a unit of pressure; use kPa, bar, atm or psi.")
    amount, factor = _amount_and_factor(text, _AMOUNT_AND_WORD, _PRESSURES, unknown)
    return parse_number(amount, {}), factor


def _amount_and_factor(
    text: str, pattern: re.Pattern[str], units: Mapping[str, float], unknown: str
) -> tuple[str, float | None]:
    """Amount as typed, and the factor of its unit; None for a bare number."""
    # Longer ones are no number either; a pattern may take as many steps as they have characters, squared.
    parted = pattern.fullmatch(text.strip()) if len(text) <= MOST_CHARACTERS else None
    amount, unit = parted.groups() if parted else (text, "")
    unit = "".join(unit.translate(_SPELLINGS).split())
    if unit and unit.lower() not in units:
        raise InputError(unknown.format(unit=unit))
    return amount, units.get(unit.lower())


def _number(amount: str, text: str, refusal: str) -> float:
    """Parse an amount; the error message quotes the whole text."""
    try:
        return parse_number(amount, {})
    except InputError:
        raise InputError(refusal.format(text=text.strip()[:_SHOWN])) from None
