"""Wall of an FE deck in consistent units: the mesh unit, newtons and seconds."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.files.fe_deck import DeckWall
from apd_viewer.language import tr
from apd_viewer.session.quantities.elastic_wall import DEFAULT_POISSON, metres, poisson_ratio, young_modulus
from apd_viewer.session.quantities.expressions import length
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall, density, thickness_from
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


class WallWords(NamedTuple):
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


def deck_wall(words: WallWords, unit: Unit, size: float) -> DeckWall:
    """Wall in the units of a deck, with comments on what nobody gave.

    Parameters
    ----------
    words : WallWords
    unit : Unit
        Of the mesh.
    size : float
        Diagonal of the bounding box of the mesh, for the default of the thickness.

    Raises
    ------
    InputError
        If something is no quantity, or needs the unit of the mesh.
    """
    metre = metres(unit)
    if metre is None and (words.young or words.wall.density.strip() or words.material):
        raise InputError(tr("A material needs the unit of the mesh; choose it, or add --unit mm."))
    notes = [_about(unit)]
    thickness = _thickness(words, unit)
    if thickness is None:
        thickness = _DEFAULT_THICKNESS * size
        notes.append("No thickness was given: it is a thousandth of the diagonal of the mesh.")
    young = _young(words)
    if young is None or metre is None:
        young, metre = _DEFAULT_YOUNG, metre or 1.0
        notes.append("No Young's modulus was given: it is 1. Shapes do not depend on it; stresses do.")
    else:
        young *= metre**2
    heavy = _density(words)
    if heavy is None:
        notes.append("No density was given: none is needed for this step.")
    else:
        heavy *= _KILOGRAMS * metre**4
    ratio = _poisson(words)
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
    return f"Units: length {own}, force N, time s; so {_KNOWN.get(unit.confirmed, usual)}.{guess}"


def _thickness(words: WallWords, unit: Unit) -> float | None:
    if words.wall.thickness.strip():
        return thickness_from(words.wall.thickness, unit)
    return length(f"{words.material.thickness} mm", unit, {}) if words.material else None


def _young(words: WallWords) -> float | None:
    """Young's modulus, Pa."""
    if words.young:
        return young_modulus(words.young)
    known = words.material.young if words.material else None
    return None if known is None else _GPA * known


def _poisson(words: WallWords) -> float | None:
    if words.poisson:
        return poisson_ratio(words.poisson)
    return words.material.poisson if words.material else None


def _density(words: WallWords) -> float | None:
    """Density, g/cm³."""
    if words.wall.density.strip():
        return density(words.wall.density)
    return words.material.density if words.material else None
