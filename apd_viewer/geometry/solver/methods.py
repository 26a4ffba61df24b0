"""Methods of deformation, by name: their traits, titles and materials."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.arrays import check_argument
from apd_viewer.language import tr

DEFAULT_METHOD = "exact"
DEFAULT_TOLERANCE = 1e-3
# Stiffnesses relative to that of the ARAP cells (Eq. 1 of the paper). The method "local" keeps a tenth of the
# cells, which connects the triangles.
DEFAULT_AREA_STIFFNESS = 20.0
DEFAULT_SHEAR_STIFFNESS = 0.1
DEFAULT_POISSON = 0.4
_LOCAL_RIGIDITY = 0.1
# Largest number of vertices for interactive speed in contact, the same on all machines.
MOST_VERTICES_IN_CONTACT = 40_000
# Largest number of vertices of a wall: the factors of its Hessian then take about 3 GB.
_MOST_WALL_VERTICES = 100_000


@dataclass(frozen=True)
class Method:
    """Method of deformation.

    Attributes
    ----------
    title, short_title : str
        In full, and for legends and tables.
    keeps_sentence, gives_up_sentence : str
        Sentences about what the user gains and pays.
    material : callable
        The :class:`Material` for a bending, an area and a shear stiffness.
    keeps_total_area : bool
        The total area is a goal, at 100 % unless another is given.
    may_keep_total_area : bool
        The total area is a goal if the user says so.
    keeps_calm_parts : bool
        The areas of calm parts are goals beside that of the total area; see :mod:`calm_parts`.
    keeps_only_total_area : bool
        The volume and the areas of regions cannot be goals.
    moves_handles : bool
        Handles give way, so that the method must know which of the held vertices are handle.
    has_tolerance : bool
        The total area is kept to a tolerance, and not to the last digits.
    has_moduli : bool
        Area and shear stiffness matter.
    is_wall : bool
        The surface is a thin elastic wall: thickness and Poisson's ratio matter, and no stiffness.
    is_plain_only : bool
        There is no energy of its own to descend in: all iterations are plain ones.
    may_use_contact : bool
        Walls can be kept apart.
    is_slow : bool
        Takes several times as long as the others.
    """

    title: str
    short_title: str
    keeps_sentence: str
    gives_up_sentence: str
    material: Callable[[float, float, float], Material]
    keeps_total_area: bool = False
    may_keep_total_area: bool = False
    keeps_calm_parts: bool = False
    keeps_only_total_area: bool = False
    moves_handles: bool = False
    has_tolerance: bool = False
    has_moduli: bool = False
    is_wall: bool = False
    is_plain_only: bool = False
    may_use_contact: bool = False
    is_slow: bool = False

    @property
    def description(self) -> str:
        """Sentences on the benefits and drawbacks of the method."""
        return f"{self.keeps_sentence} {self.gives_up_sentence}"

    @property
    def needs_even_triangles(self) -> bool:
        """Triangles resist by themselves, and thin ones are too stiff."""
        return self.has_moduli or self.is_wall

    @property
    def obstacle_problem(self) -> str:
        """Sentence saying that obstacles push nothing; empty if contact can be used."""
        if self.may_use_contact:
            return ""
        sentence = tr("The method {method} cannot use contact: obstacles push nothing.")
        return sentence.format(method=self.title)


def _rigid(stiffness: float, _area: float, _shear: float) -> Material:
    return Material(bending=stiffness)


def _fabric(stiffness: float, area: float, shear: float) -> Material:
    return Material(_LOCAL_RIGIDITY, shear, area, stiffness)


def _coupled(stiffness: float, _area: float, _shear: float) -> Material:
    return Material(coupling=stiffness)


def _wall(_stiffness: float, _area: float, _shear: float) -> Material:
    return Material(thickness=1.0)  # placeholder: wall_material needs the size of the mesh


METHODS = {
    "exact": Method(
        title=tr("Exact"),
        short_title=tr("Exact"),
        keeps_sentence=tr("Keeps the total area exactly and the handles in place."),
        gives_up_sentence=tr("Gives up a little rigidity."),
        material=_rigid,
        keeps_total_area=True,
        keeps_calm_parts=True,
        may_use_contact=True,
    ),
    "local": Method(
        title=tr("Local"),
        short_title=tr("Local"),
        keeps_sentence=tr("Keeps the area of every triangle, like fabric or PET film."),
        gives_up_sentence=tr("Gives up smoothness: it wrinkles."),
        material=_fabric,
        may_keep_total_area=True,
        has_moduli=True,
        may_use_contact=True,
        is_slow=True,
    ),
    "wall": Method(
        title=tr("Wall"),
        short_title=tr("Wall"),
        keeps_sentence=tr("Bends and stretches like a thin elastic wall of its thickness."),
        gives_up_sentence=tr("Gives up speed."),
        material=_wall,
        may_keep_total_area=True,
        is_wall=True,
        may_use_contact=True,
        is_slow=True,
    ),
    "paper": Method(
        title=tr("Paper (Li & Hui)"),
        short_title=tr("Paper"),
        keeps_sentence=tr("Keeps the total area within the tolerance."),
        gives_up_sentence=tr("Lets the handles drift a little."),
        material=_rigid,
        keeps_total_area=True,
        keeps_only_total_area=True,
        moves_handles=True,
        has_tolerance=True,
        is_plain_only=True,
    ),
    "arap": Method(
        title=tr("ARAP"),
        short_title=tr("ARAP"),
        keeps_sentence=tr("Keeps the shape as rigid as possible and the handles in place."),
        gives_up_sentence=tr("Gives up the area."),
        material=_rigid,
        may_use_contact=True,
    ),
    "sr-arap": Method(
        title=tr("SR-ARAP"),
        short_title=tr("SR-ARAP"),
        keeps_sentence=tr("Keeps neighbouring rotations alike, by the stiffness, and the handles in place."),
        gives_up_sentence=tr("Gives up the area, and at stiffness 0 it is ARAP."),
        material=_coupled,
        is_plain_only=True,
    ),
}
# Methods compared in studies, in the order of their area error.
COMPARED_METHODS = ("arap", "paper", "exact", "local")


def method_named(name: str) -> Method:
    """Method by its name; raises InputError if there is none."""
    if not isinstance(name, str) or name not in METHODS:
        raise InputError(
            tr("Unknown method {method!r}; choose one of {methods}.").format(
                method=name, methods=", ".join(METHODS)
            )
        )
    return METHODS[name]


def contact_by_default(method: str, vertices: int) -> bool:
    """True if contact is on by default for a method and a number of vertices."""
    return method_named(method).may_use_contact and vertices <= MOST_VERTICES_IN_CONTACT


def no_contact_warning(method: str, vertices: int, switch: str) -> str:
    """Warning that contact is off by default for a large mesh; otherwise empty."""
    if vertices <= MOST_VERTICES_IN_CONTACT or not method_named(method).may_use_contact:
        return ""
    return tr(
        "Walls may pass through each other: above {most:,} vertices contact is off by default; "
        "turn it on by {switch}."
    ).format(most=MOST_VERTICES_IN_CONTACT, switch=switch)


def checked_method(name: str, handle_of: np.ndarray, obstacles: bool = False) -> Method:
    """Method by name; raises InputError if unknown or if too few vertices are held.

    With ``obstacles``, none need be held.
    """
    method = method_named(name)
    if len(handle_of) == 0 and not obstacles:
        raise InputError(tr("No vertices are held; give the vertices of the base and the handles."))
    if method.moves_handles and ((handle_of > 0).all() or not (handle_of > 0).any()):
        raise InputError(
            tr("The method {method!r} needs base and handle; give the vertices of the handle too.").format(
                method=name
            )
        )
    return method


def method_material(
    method: Method,
    stiffness: float,
    area_stiffness: float,
    shear_stiffness: float,
    yield_radius: float | None = None,
) -> Material:
    """Weights of the method's energy, and its yield curvature.

    Raises InputError on invalid stiffness, and on walls that yield without any.
    """
    check_argument("stiffness", stiffness)
    check_argument("area_stiffness", area_stiffness)
    check_argument("shear_stiffness", shear_stiffness)
    material = method.material(stiffness, area_stiffness, shear_stiffness)
    if yield_radius is None:
        return material
    check_argument("yield_radius", yield_radius)
    if method.is_wall:
        return material
    if not stiffness:
        raise InputError(tr("Walls without bending stiffness keep no creases; enter a stiffness, too."))
    return replace(material, yield_curvature=1.0 / yield_radius)


# Default, least and greatest wall thickness, in bounding-box diagonals; thinner walls are nearly
# inextensible.
_THICKNESS, _THINNEST, _THICKEST = 1e-3, 1e-5, 0.05


def check_wall_size(vertices: int) -> None:
    """Raise InputError if a wall has too many vertices for the memory."""
    if vertices > _MOST_WALL_VERTICES:
        raise InputError(
            tr("The method Wall takes at most {most:,} vertices; choose Local, or reduce the mesh.").format(
                most=_MOST_WALL_VERTICES
            )
        )


def wall_material(
    diagonal: float,
    thickness: float | None,
    poisson: float,
    yield_radius: float | None = None,
    tension_field: bool = False,
    hardening: float = 0.0,
) -> Material:
    """Material of a thin elastic wall; raises InputError unless it is thin.

    Parameters
    ----------
    diagonal : float
        Of the bounding box, mesh units.
    thickness : float or None
        Mesh units, perhaps a wall map; None for a thousandth of the diagonal.
    poisson : float
    yield_radius : float, optional
        Mesh units; by default the wall is elastic.
    tension_field : bool
        Whether the wall wrinkles finer than its mesh.
    hardening : float
        Of its creases.
    """
    check_argument("poisson", poisson)
    check_argument("hardening", hardening)
    if thickness is None:
        thickness = _THICKNESS * diagonal
    check_argument("wall_thickness", thickness)
    every = thickness.triangles if isinstance(thickness, WallMap) else np.array([thickness])
    if every.max() > _THICKEST * diagonal:
        raise InputError(
            tr("A wall is thin: its thickness must be at most {most:.3g} here; check the unit.").format(
                most=_THICKEST * diagonal
            )
        )
    if every.min() < _THINNEST * diagonal:
        raise InputError(
            tr("A wall of {least:.3g} hardly stretches any more here; enter at least that thickness.").format(
                least=_THINNEST * diagonal
            )
        )
    curvature = np.inf if yield_radius is None else 1.0 / yield_radius
    return Material(
        thickness=thickness if isinstance(thickness, WallMap) else float(thickness),
        poisson=float(poisson),
        yield_curvature=curvature,
        hardening=float(hardening),
        is_relaxed=bool(tension_field),
    )
