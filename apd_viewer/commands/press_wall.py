"""The wall of a mesh to press: its options and their consequences."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.weld_option import naming_unit_option
from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.total_curvature import total_curvature
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.language import comma_separated, tr
from apd_viewer.presentation.number_format import format_short
from apd_viewer.session.quantities.elastic_wall import (
    DEFAULT_POISSON,
    ElasticWall,
    metres_per_unit,
    parse_poisson_ratio,
    parse_pressure,
    parse_young_modulus,
    underestimate_factor,
)
from apd_viewer.session.quantities.expressions import parse_length, parse_number
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.quantities.wall_mass import parse_density, parse_thickness
from apd_viewer.session.quantities.wall_materials import (
    WALL_MATERIALS,
    WallMaterial,
    wall_material,
    yield_radius,
)

_GPA = 1e9
_GRAMS = 1e6  # in a cubic metre of 1 g/cm³


@dataclass(frozen=True)
class PressWall:
    """Wall of a mesh to press.

    Attributes
    ----------
    unit : Unit
        Of the mesh.
    material : WallMaterial or None
    thickness : float or None
        Mesh units.
    contact_distance : float or None
        Distance that walls keep, mesh units; None for the usual one.
    yield_radius : float or None
        Walls that are bent to less keep a crease, mesh units.
    density : float or None
        g/cm³.
    elastic : ElasticWall or None
        What newtons follow from.
    """

    unit: Unit
    material: WallMaterial | None
    thickness: float | None
    contact_distance: float | None
    yield_radius: float | None
    density: float | None
    elastic: ElasticWall | None

    def grams(self, area: float) -> float | None:
        """Mass of an area in square mesh units; None if it is not known."""
        metre = metres_per_unit(self.unit)
        if metre is None or self.thickness is None or self.density is None:
            return None
        return _GRAMS * self.density * self.thickness * area * metre**3

    def newton_conversion(self, material: Material, rest: RestMesh) -> NewtonConversion | None:
        """Conversion of the loads of a model of a material; None if it is not known."""
        metre, stiffness = metres_per_unit(self.unit), material.bending
        if self.elastic is None or metre is None or not stiffness > 0.0:
            return None
        own = self.elastic.model_stiffness(rest.area, metre, material.young)
        curvature = total_curvature(rest.solve_mesh.V, rest.solve_mesh.F)
        per_load = self.elastic.newtons_per_load(stiffness, rest.area, metre)
        return NewtonConversion(per_load, metre, own, stiffness, curvature)

    @property
    def text(self) -> str:
        """Words on all that is known of it; empty if nothing is."""
        elastic = self.elastic
        said = [
            self.material and self.material.title,
            None if self.thickness is None else self.unit.format_length(format_short(self.thickness)),
            None if self.density is None else f"{format_short(self.density)}\u00a0g/cm³",
            None if elastic is None else f"{format_short(elastic.young / _GPA)}\u00a0GPa",
            None
            if elastic is None
            else tr("Poisson's ratio {ratio}").format(ratio=format_short(elastic.poisson)),
            None
            if self.yield_radius is None
            else tr("yields below a radius of {radius}").format(
                radius=self.unit.format_length(format_short(self.yield_radius))
            ),
        ]
        return comma_separated(filter(None, said))


@dataclass(frozen=True)
class NewtonConversion:
    """Conversion of the model's loads, for a wall that bends and hardly stretches.

    Attributes
    ----------
    newtons_per_load : float
        Newtons of a load of 1.
    metres_per_unit : float
        Metres in a mesh unit.
    stiffness, pressed_stiffness : float
        That of the wall, and the one that it is pressed with.
    curvature : float
        Total curvature of the shape at rest.
    """

    newtons_per_load: float
    metres_per_unit: float
    stiffness: float
    pressed_stiffness: float
    curvature: float

    def underestimate_factor(self, stretching: float) -> float:
        """Largest error of newtons by the share of the energy in stretching, a factor."""
        return underestimate_factor(self.pressed_stiffness / self.stiffness, stretching, self.curvature)

    @property
    def joules_per_work(self) -> float:
        """Joules of a work of 1."""
        return self.newtons_per_load * self.metres_per_unit

    def gas_amount(self, pascals: float, volume: float, area: float) -> float:
        """Pressure of a gas times its volume in mesh units, in areas of the surface."""
        return pascals * self.metres_per_unit**2 / self.newtons_per_load * abs(volume) / area

    @property
    def newtons_per_millimetre(self) -> float:
        """N/mm of an apparent stiffness of 1."""
        return 1e-3 * self.newtons_per_load / self.metres_per_unit


def add_wall_options(parser: Parser) -> None:
    """Options of the wall."""
    parser.add_argument(
        "--unit", choices=SYMBOLS, default="", help=tr("unit of length of the mesh; of a session, its own")
    )
    parser.add_argument(
        "--material",
        metavar="NAME",
        help=tr("material of the wall: {names}").format(
            names=", ".join(material.name for material in WALL_MATERIALS)
        ),
    )
    for option, metavar, what in (
        (
            "--thickness",
            "LENGTH",
            tr("of the wall, and distance that walls keep, such as 0.3mm; default: 1/1000 of the diagonal"),
        ),
        (
            "--gas",
            "PRESSURE",
            tr(
                "gas that is enclosed, openings capped: 1atm where newtons are known, or pressure times "
                "volume in areas of the surface; default: it leaves freely"
            ),
        ),
        ("--density", "D", tr("of the material, such as 1.38 (g/cm³), for the mass")),
        ("--young", "E", tr("Young's modulus, such as 2.8GPa, for loads in newtons")),
        ("--poisson", "NU", tr("Poisson's ratio; default: 0.4, or that of the material")),
        (
            "--yield-radius",
            "LENGTH",
            tr("walls bent to less than this radius keep a crease; default: none do, or as of the material"),
        ),
    ):
        parser.add_argument(option, metavar=metavar, help=what)


@naming_unit_option()
def press_wall(options: argparse.Namespace, unit: Unit) -> PressWall:
    """Wall of a command line, for a mesh in a unit; raises InputError."""
    material = None if options.material is None else wall_material(options.material)
    if unit is Unit.NONE and (material or options.young is not None):
        raise InputError(tr("A material needs the unit of the mesh; add --unit mm, cm, m, in or ft."))
    apart = None if options.thickness is None else parse_thickness(options.thickness, unit)
    thickness = apart
    if material and apart is None:
        thickness = parse_length(f"{material.thickness} mm", unit, {})
    heavy = material.density if material else None
    if options.density is not None:
        heavy = parse_density(options.density)
    elastic = _elastic(options, material, thickness, metres_per_unit(unit))
    return PressWall(
        unit, material, thickness, apart, _radius(options, material, thickness, unit), heavy, elastic
    )


def parse_gas(text: str | None, newtons: NewtonConversion | None, rest: RestMesh) -> float | None:
    """Pressure times volume of the gas, in areas, from a text; raises InputError."""
    if text is None:
        return None
    pascals = parse_pressure(text)
    if pascals is None:
        return parse_number(text, {})
    if newtons is None:
        raise InputError(
            tr("A pressure with a unit needs newtons; add --material, or --thickness and --young.")
        )
    volume = rest.volume if rest.caps is None else rest.volume_capped
    return newtons.gas_amount(pascals, volume or 0.0, rest.area)


def _radius(
    options: argparse.Namespace, material: WallMaterial | None, thickness: float | None, unit: Unit
) -> float | None:
    """Yield radius as asked for, or of the material where walls are stiff at all."""
    if options.yield_radius is not None:
        return parse_length(options.yield_radius, unit, {})
    if material is None or material.yield_strain is None or thickness is None or not options.stiffness:
        return None
    return yield_radius(thickness, material.yield_strain)


def _elastic(
    options: argparse.Namespace,
    material: WallMaterial | None,
    thickness: float | None,
    metre: float | None,
) -> ElasticWall | None:
    young = None if material is None or material.young is None else _GPA * material.young
    poisson = material.poisson if material else None
    if options.young is not None:
        young = parse_young_modulus(options.young)
        if thickness is None:
            raise InputError(tr("Newtons need the thickness of the wall as well; add --thickness."))
        if not options.stiffness:
            raise InputError(tr("Newtons need walls that resist bending; add --stiffness 0.001."))
    if options.poisson is not None:
        poisson = parse_poisson_ratio(options.poisson)
    if young is None or thickness is None or metre is None:
        return None
    return ElasticWall(thickness * metre, young, DEFAULT_POISSON if poisson is None else poisson)
