"""Materials of walls, with the sources of their properties."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trc


class WallMaterial(NamedTuple):
    """Properties of a material; None where it has none, or they differ too much.

    Attributes
    ----------
    name : str
        On the command line.
    title : str
    thickness : float
        Of a typical wall, mm.
    density : float or None
        g/cm³.
    young : float or None
        Young's modulus, GPa.
    poisson : float or None
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


# Where a source gives a range, its geometric mean is taken.
WALL_MATERIALS = (
    WallMaterial(
        "pet-bottle",
        tr("PET, wall of a bottle"),
        0.3,
        1.36,
        3.4,
        0.38,
        0.0175,
        tr(
            "Callister, Materials Science and Engineering, 7th ed., appendix B: 2.76 to 4.14 GPa, "
            "yield at 59.3 MPa; MatWeb, mean of 134 grades: 1.36 g/cm³; Poisson's ratio as of PET film"
        ),
    ),
    WallMaterial(
        "pet-film",
        tr("PET film, oriented"),
        0.1,
        1.39,
        4.9,
        0.38,
        0.02,
        tr(
            "DuPont Teijin Films, Mylar, Physical-Thermal Properties, H-37232-3: 490 to 510 kg/mm², "
            "10 kg/mm² at 5 % elongation"
        ),
    ),
    WallMaterial(
        "hdpe",
        tr("HDPE, bottle or film"),
        0.5,
        0.96,
        1.08,
        0.42,
        0.027,
        tr(
            "Callister, Materials Science and Engineering, 7th ed., appendix B: 0.959 g/cm³, 1.08 GPa, "
            "yield at 26.2 to 33.1 MPa; Poisson's ratio as usual for polyethylene, 0.40 to 0.46"
        ),
    ),
    WallMaterial(
        "aluminium-foil",
        tr("Aluminium foil, annealed"),
        0.016,
        2.71,
        69.0,
        0.33,
        0.0005,
        tr(
            "Aluminum Association, Aluminum Standards and Data, 1100-O: 2.71 g/cm³, 68.9 GPa, yield at "
            "34 MPa; thickness of household foil"
        ),
    ),
    WallMaterial(
        "tinplate",
        tr("Tinplate TS275, wall of a can"),
        0.2,
        7.85,
        210.0,
        0.3,
        0.0013,
        tr("EN 10202, TS275: proof strength 275 MPa; EN 1993-1-1, 3.2.6, for the elasticity of steel"),
    ),
    WallMaterial(
        "paper",
        trc("material", "Paper"),
        0.1,
        0.64,
        5.2,
        0.33,
        0.0044,
        tr(
            "Ashby, Materials and the Environment, Paper and cardboard: 480 to 860 kg/m³, 3 to 8.9 GPa, "
            "elastic limit 15 to 34 MPa; Schulgasser, Fibre Science and Technology 19, 297 (1983): "
            "Poisson's ratio 1/3"
        ),
    ),
    WallMaterial(
        "fabric",
        tr("Fabric"),
        0.3,
        None,
        None,
        None,
        None,
        tr("no numbers: weaves differ too much, and their folds do not last; enter the density of yours"),
    ),
)


def wall_material(name: str) -> WallMaterial:
    """Material of a name; raises InputError."""
    for material in WALL_MATERIALS:
        if material.name == name:
            return material
    known = ", ".join(material.name for material in WALL_MATERIALS)
    raise InputError(
        tr("There is no material “{name}”; choose one of {known}.").format(name=name, known=known)
    )


def yield_radius(thickness: float, strain: float) -> float:
    """Radius of a bend whose outermost fibres yield, in the unit of the thickness."""
    return thickness / (2.0 * strain)
