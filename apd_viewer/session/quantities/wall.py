"""Wall of a mesh, as typed and as numbers, with its mass and stiffness."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.wall_map import WallMap, triangle_wall
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import editable_number
from apd_viewer.session.quantities import wall_material
from apd_viewer.session.quantities.expressions import parse_length, parse_number
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_distribution import WallDistribution

_GRAMS = 1e6  # grams per cubic metre at 1 g/cm³


class WallText(NamedTuple):
    """Wall as typed, and its material.

    The texts are kept as typed: 0.3mm stays 0.3 mm when the unit of the mesh is changed to centimetres.

    Attributes
    ----------
    thickness : str
        A length, such as ``0.3mm``; a bare number is in mesh units. Or a wall distribution, see
        :class:`WallDistribution <apd_viewer.session.quantities.wall_distribution.WallDistribution>`.
    density : str
        Such as ``1380 kg/m3``; a bare number is in g/cm³.
    young : str
        Young's modulus, such as ``2.8GPa``; a bare number is in GPa.
    poisson : str
        Poisson's ratio.
    yield_radius : str
        A length, as the thickness.
    material : WallMaterial or None
        Source of empty values, except for the contact distance of walls.
    """

    thickness: str = ""
    density: str = ""
    young: str = ""
    poisson: str = ""
    yield_radius: str = ""
    material: wall_material.WallMaterial | None = None

    @property
    def field_texts(self) -> tuple[str, ...]:
        """Typed texts and material name, as accepted by :meth:`from_field_texts`."""
        return (*self[:-1], self.material.name if self.material else "")

    @classmethod
    def from_field_texts(cls, *given: str) -> "WallText":
        """Wall from field texts and a material name; an unknown name is ignored."""
        known = {material.name: material for material in wall_material.WALL_MATERIALS}
        *texts, name = (*given, *[""] * len(cls._fields))[: len(cls._fields)]
        return cls._make((*texts, known.get(name)))

    def text(self, unit: Unit) -> str:
        """Material, thickness, density and modulus, with units; empty if none."""
        known = self.material
        thickness, density, young = (word.strip() for word in self[:3])
        thickness = unit.format_length(thickness) if _is_without_unit(thickness) else thickness
        density = f"{density}\u00a0g/cm³" if _is_without_unit(density) else density
        young = f"{young}\u00a0GPa" if _is_without_unit(young) else young
        if known is not None:
            thickness = thickness or f"{editable_number(f'{known.thickness:g}')}\u00a0mm"
        return comma_separated(filter(None, (known and known.title, thickness, density, young)))

    def usable_thickness(self, unit: Unit) -> float | None:
        """Thickness in mesh units, typed or of the material; None if neither is valid."""
        known = "" if self.material is None else f"{self.material.thickness} mm"
        with suppress(InputError):
            return parse_thickness(self.thickness if self.thickness.strip() else known, unit)
        return None

    def contact_distance(self, unit: Unit) -> float | None:
        """Contact distance, mesh units: mean typed thickness; None if none was typed."""
        typed = self._replace(material=None).usable_thickness(unit)
        return None if typed is None else float(typed)

    def usable_density(self) -> float | None:
        """Density in g/cm³, typed or of the material; None if neither is valid."""
        with suppress(InputError):
            return wall_material.parse_density(self.density)
        return None if self.density.strip() or self.material is None else self.material.density


NO_WALL = WallText()


@dataclass(frozen=True)
class Wall:
    """Wall of a mesh as numbers; None if unknown.

    Attributes
    ----------
    unit : Unit
        Of the mesh.
    thickness : float or None
        Mesh units; the mean of a wall map.
    density : float or None
        g/cm³.
    young : float or None
        Young's modulus, Pa.
    yield_radius : float or None
        Walls that are bent to less keep a crease, mesh units.
    """

    unit: Unit = Unit.NONE
    thickness: float | None = None
    density: float | None = None
    young: float | None = None
    poisson: float | None = None
    yield_radius: float | None = None
    material: wall_material.WallMaterial | None = None

    def grams(self, area: float, material_volume: float | None = None) -> float | None:
        """Mass of a rest area in square mesh units, grams; None if unknown.

        For a double wall, the ``material_volume`` between its surfaces, cubic mesh units, replaces the
        thickness.
        """
        metre = self.unit.metres
        if metre is None or self.density is None:
            return None
        if material_volume is not None:
            return _GRAMS * self.density * material_volume * metre**3
        return None if self.thickness is None else _GRAMS * self.density * self.thickness * area * metre**3

    @property
    def nu(self) -> float:
        """Poisson's ratio, or its default if unknown."""
        return wall_material.DEFAULT_POISSON if self.poisson is None else self.poisson

    @property
    def rigidity(self) -> float | None:
        """Bending rigidity ``D = E t³ / (12 (1 - nu²))``, N m; None if unknown."""
        thickness = self._metres
        if thickness is None or self.young is None:
            return None
        return self.young * thickness**3 / (12.0 * (1.0 - self.nu**2))

    def model_stiffness(self, area: float, young: float) -> float | None:
        """Model stiffness with the wall's ratio of bending to stretching.

        ``D / (E t)`` is ``2 stiffness area / young`` in the model, and ``t² / (12 (1 - nu²))`` for the wall.
        None if newtons are unknown.

        Parameters
        ----------
        area : float
            At rest, square mesh units.
        young : float
            Young's modulus times thickness of the model; see :class:`Material`.
        """
        thickness, metre = self._metres, self.unit.metres
        if thickness is None or metre is None or self.young is None:
            return None
        return young * thickness**2 / (24.0 * (1.0 - self.nu**2) * area * metre**2)

    @property
    def _metres(self) -> float | None:
        """Thickness in metres; None if unknown."""
        metre = self.unit.metres
        return None if metre is None or self.thickness is None else self.thickness * metre


def parse_wall(text: WallText, unit: Unit) -> Wall:
    """Wall from a text, for a mesh in a unit; raises InputError.

    A typed modulus or yield radius is the mean of one that differs from place to place.
    """
    known = text.material
    thickness = _optional_number(text.thickness, lambda typed: parse_thickness(typed, unit))
    if known and thickness is None:
        thickness = parse_length(f"{known.thickness} mm", unit, {})
    density = _optional_number(text.density, wall_material.parse_density)
    young = _optional_number(text.young, wall_material.parse_young_modulus)
    mapped = thickness if isinstance(thickness, WallMap) else None
    if mapped and mapped.young:
        young = float(mapped.young) if young is None else young
    poisson = _optional_number(text.poisson, wall_material.parse_poisson_ratio)
    radius = _optional_number(text.yield_radius, lambda typed: parse_length(typed, unit, {}))
    if mapped and mapped.yield_radius:
        radius = float(mapped.yield_radius) if radius is None else radius
    if known:
        density = known.density if density is None else density
        young = wall_material.GPA * known.young if young is None and known.young is not None else young
        poisson = known.poisson if poisson is None else poisson
        radius = known.yield_radius(thickness) if radius is None and thickness is not None else radius
    return Wall(unit, thickness, density, young, poisson, radius, known)


def press_method(wall: Wall, stiffness: float | None, otherwise: str) -> str:
    """Method to press by: "wall" for a known wall without a given ``stiffness``."""
    return "wall" if wall.rigidity is not None and not stiffness else otherwise


def typed_mass(text: WallText, area: float, unit: Unit, material_volume: float | None = None) -> float | None:
    """Mass of a rest area, grams, for a wall as typed; None if nothing is typed.

    Raises
    ------
    InputError
        If one of the two is missing or makes no sense, or the unit of the mesh is not known.
    """
    if not (text.thickness.strip() or text.density.strip() or text.material):
        return None
    if unit is Unit.NONE:
        raise InputError(tr("The mass needs the unit of the mesh; choose it next to the area."))
    if material_volume is not None:
        text = text._replace(thickness="")
    elif not (text.thickness.strip() or text.material):
        raise InputError(tr("The mass needs a wall thickness; enter one such as 0.3mm."))
    grams = parse_wall(text, unit).grams(area, material_volume)
    if grams is None:
        raise InputError(tr("The mass needs a density; enter one such as 1.38 g/cm³."))
    return grams


def parse_thickness(text: str, unit: Unit) -> float:
    """Parse a thickness, in mesh units; raises InputError."""
    if isinstance(text, WallDistribution):
        return text.in_unit(unit)
    thickness = parse_length(text, unit, {})
    if not thickness > 0.0:
        raise InputError(tr("Enter a wall thickness greater than 0, such as 0.3mm."))
    return thickness


def with_part_thickness(wall: WallText, own: str, inside: np.ndarray, mesh: Mesh, unit: Unit) -> WallText:
    """Wall with another thickness in a part of the mesh, as a wall distribution.

    Its name is the range of the thickness.

    Parameters
    ----------
    wall : WallText
    own : str
        Thickness of the part, a length.
    inside : (n,) bool array
        Vertices of the part; a triangle belongs to it by two of its corners.
    mesh, unit : Mesh, Unit

    Raises
    ------
    InputError
        If it is no length, or the wall has no thickness yet.
    """
    thickness, usual = parse_thickness(own, unit), wall.usable_thickness(unit)
    if usual is None:
        raise InputError(tr("Enter a wall thickness greater than 0, such as 0.3mm."))
    V, F = mesh.V, mesh.F
    before = usual if isinstance(usual, WallMap) else triangle_wall(np.full(len(F), usual), V, F)
    after = before.on(V, F, np.where(inside[F].sum(axis=1) >= 2, thickness, before.triangles))
    ends = (editable_number(f"{end:.4g}") for end in (after.triangles.min(), after.triangles.max()))
    name = unit.format_length(" – ".join(dict.fromkeys(ends)))
    return wall._replace(thickness=WallDistribution(name, after, unit.symbol))


def _optional_number(text: str, parse: Callable[[str], float]) -> float | None:
    """Parsed number of a text; None if empty."""
    return parse(text) if text.strip() else None


def _is_without_unit(text: str) -> bool:
    with suppress(InputError):
        parse_number(text, {})
        return True
    return False
