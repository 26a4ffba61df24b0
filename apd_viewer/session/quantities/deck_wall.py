"""Wall of an FE deck in consistent units: the mesh unit, newtons and seconds."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.files.fe_deck import DeckWall
from apd_viewer.language import tr
from apd_viewer.session.quantities.elastic_wall import (
    DEFAULT_POISSON,
    metres_per_unit,
    parse_poisson_ratio,
    parse_young_modulus,
)
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall, parse_density, parse_thickness
from apd_viewer.session.quantities.wall_materials import WallMaterial

_DEFAULT_THICKNESS = 1e-3  # in diagonals of the mesh
_DEFAULT_YOUNG = 1.0
_GPA = 1e9
_KILOGRAMS = 1e3  # in a cubic metre of 1 g/cm³
# Spelt out for those who do not multiply in their heads.
_KNOWN = {
    Unit.MILLIMETRE: "stress and Young's modulus MPa, mass tonne, density tonne/mm3",
    Unit.METRE: "stress and Young's modulus Pa, mass kg, density kg/m3",
}


class DeckWallText(NamedTuple):
    """Wall of shells as typed; what is empty follows from the material.

    Without one it is a default.

    Attributes
    ----------
    wall : Wall
    young : str
        Such as ``2.8GPa``.
    poisson : str
    material : WallMaterial or None
    """

    wall: Wall = Wall()
    young: str = ""
    poisson: str = ""
    material: WallMaterial | None = None


def deck_wall(text: DeckWallText, unit: Unit, size: float) -> DeckWall:
    """Wall in the units of a deck, with comments on what nobody gave.

    Parameters
    ----------
    text : DeckWallText
    unit : Unit
        Of the mesh.
    size : float
        Diagonal of the bounding box of the mesh, for the default of the thickness.

    Raises
    ------
    InputError
        If something is no quantity, or needs the unit of the mesh.
    """
    metre = metres_per_unit(unit)
    if metre is None and (text.young or text.wall.density.strip() or text.material):
        raise InputError(tr("A material needs the unit of the mesh; choose it, or add --unit mm."))
    notes = [_about(unit)]
    thickness = _thickness(text, unit)
    if thickness is None:
        thickness = _DEFAULT_THICKNESS * size
        notes.append("No thickness was given: it is a thousandth of the diagonal of the mesh.")
    young = _young(text)
    if young is None or metre is None:
        young, metre = _DEFAULT_YOUNG, metre or 1.0
        notes.append("No Young's modulus was given: it is 1. Shapes do not depend on it; stresses do.")
    else:
        young *= metre**2
    heavy = _density(text)
    if heavy is None:
        notes.append("No density was given: none is needed for this step.")
    else:
        heavy *= _KILOGRAMS * metre**4
    ratio = _poisson(text)
    if ratio is None:
        ratio = DEFAULT_POISSON
        notes.append(f"No Poisson's ratio was given: it is {ratio:g}.")
    return DeckWall(thickness, young, ratio, heavy, tuple(notes))


def _about(unit: Unit) -> str:
    """Comment on the units of the deck."""
    if unit is Unit.NONE:
        return "Lengths are in the unit of the mesh, which is not known. Keep the others consistent with it."
    own = unit.symbol
    usual = f"stress and Young's modulus N/{own}2, mass N s2/{own}, density N s2/{own}4"
    guess = " The unit of length is a guess that nobody confirmed." if unit.is_guess else ""
    return f"Units: length {own}, force N, time s; so {_KNOWN.get(unit.as_confirmed, usual)}.{guess}"


def _thickness(words: DeckWallText, unit: Unit) -> float | None:
    if words.wall.thickness.strip():
        return parse_thickness(words.wall.thickness, unit)
    return parse_length(f"{words.material.thickness} mm", unit, {}) if words.material else None


def _young(words: DeckWallText) -> float | None:
    """Young's modulus, Pa."""
    if words.young:
        return parse_young_modulus(words.young)
    known = words.material.young if words.material else None
    return None if known is None else _GPA * known


def _poisson(words: DeckWallText) -> float | None:
    if words.poisson:
        return parse_poisson_ratio(words.poisson)
    return words.material.poisson if words.material else None


def _density(words: DeckWallText) -> float | None:
    """Density, g/cm³."""
    if words.wall.density.strip():
        return parse_density(words.wall.density)
    return words.material.density if words.material else None
