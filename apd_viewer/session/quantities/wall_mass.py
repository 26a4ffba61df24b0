"""Wall thickness and density as typed, and the mass of a surface."""

from __future__ import annotations

import re
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import comma_separated, tr
from apd_viewer.session.quantities.expressions import parse_length, parse_number
from apd_viewer.session.quantities.units import Unit

# In grams per cubic centimetre, the unit of a bare number.
_DENSITIES = {
    "g/cm3": 1.0,
    "g/cc": 1.0,
    "g/ml": 1.0,
    "kg/l": 1.0,
    "kg/dm3": 1.0,
    "t/m3": 1.0,
    "kg/m3": 1e-3,
    "g/l": 1e-3,
    "lb/ft3": 453.59237 / 30.48**3,
    "lb/in3": 453.59237 / 2.54**3,
    "oz/in3": 28.349523125 / 2.54**3,
}
_SPELLINGS = str.maketrans({"³": "3", "^": "", "∕": "/", "⁄": "/"})
_UNIT = re.compile(r"(?P<amount>.*?)\s*(?P<unit>[a-z]+\s*/\s*[a-z]+3?)", re.DOTALL)
_SHOWN = 20  # characters quoted from invalid input
_HEAVIEST = 100.0  # g/cm³; osmium has 22.6


class Wall(NamedTuple):
    """Thickness and density of a wall, as typed.

    The texts are kept as they were typed: 0.3mm stay 0.3 mm when the mesh is said to be in centimetres.

    Attributes
    ----------
    thickness : str
        A length, such as ``0.3mm``; a bare number is in mesh units.
    density : str
        Such as ``1380 kg/m3``; a bare number is in g/cm³.
    """

    thickness: str = ""
    density: str = ""

    def text(self, unit: Unit) -> str:
        """Thickness and density, a bare number with the unit that it is in; empty if none."""
        thickness, density = (text.strip() for text in self)
        thickness = unit.format_length(thickness) if _is_bare(thickness) else thickness
        density = f"{density}\u00a0g/cm³" if _is_bare(density) else density
        return comma_separated(filter(None, (thickness, density)))


NO_WALL = Wall()


def wall_mass(wall: Wall, area: float, unit: Unit, material_volume: float | None = None) -> float | None:
    """Mass of a wall of ``area`` square mesh units, grams; None if nothing was typed.

    Of a double wall the ``material_volume`` between its surfaces counts, cubic mesh units, and no thickness.

    Raises
    ------
    InputError
        If one of the two is missing or makes no sense, or the unit of the mesh is not known.
    """
    if not any(text.strip() for text in wall):
        return None
    if unit is Unit.NONE:
        raise InputError(tr("The mass needs the unit of the mesh; choose it next to the area."))
    if material_volume is None:
        if not wall.thickness.strip():
            raise InputError(tr("The mass needs a wall thickness; enter one such as 0.3mm."))
        material_volume = area * parse_thickness(wall.thickness, unit)
    if not wall.density.strip():
        raise InputError(tr("The mass needs a density; enter one such as 1.38 g/cm³."))
    litres = unit.to_litres(material_volume)
    assert litres is not None
    return 1000.0 * litres * parse_density(wall.density)


def parse_thickness(text: str, unit: Unit) -> float:
    """Thickness in mesh units from a text; raises InputError."""
    thickness = parse_length(text, unit, {})
    if not thickness > 0.0:
        raise InputError(tr("Enter a wall thickness greater than 0, such as 0.3mm."))
    return thickness


def wall_thickness(wall: Wall, unit: Unit) -> float | None:
    """Thickness in mesh units; None where no usable one was typed."""
    try:
        return parse_thickness(wall.thickness, unit)
    except InputError:
        return None


def wall_density(wall: Wall) -> float | None:
    """Density in g/cm³; None where no usable one was typed."""
    try:
        return parse_density(wall.density)
    except InputError:
        return None


def _is_bare(text: str) -> bool:
    try:
        parse_number(text, {})
    except InputError:
        return False
    return True


def parse_density(text: str) -> float:
    """Density in g/cm³ from a text; raises InputError."""
    parted = _UNIT.fullmatch(text.translate(_SPELLINGS).strip())
    amount, factor = text, 1.0
    if parted is not None and parted["amount"]:
        said = re.sub(r"\s", "", parted["unit"])
        if said not in _DENSITIES:
            raise InputError(
                tr("“{unit}” is not a unit of density; use g/cm³, kg/m³ or lb/ft³.").format(unit=said)
            )
        amount, factor = parted["amount"], _DENSITIES[said]
    try:
        value = factor * parse_number(amount, {})
    except InputError:
        sentence = tr("“{text}” is not a density; enter one such as 1.38 g/cm³.")
        raise InputError(sentence.format(text=text.strip()[:_SHOWN])) from None
    if not 0.0 < value <= _HEAVIEST:
        raise InputError(
            tr("A density of {value:.4g} g/cm³ is out of range; enter one such as 1.38 g/cm³.").format(
                value=value
            )
        )
    return value
