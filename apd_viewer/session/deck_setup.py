"""FE deck of a document: elements, sets, handle displacements and wall."""

import math
from collections.abc import Sequence

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.fe_deck import Deck, DeckRegion, DeckWall, NodeSet
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import document_at, handle_paths
from apd_viewer.session.posing.motion_path import MotionStep, document_along_paths, motion_paths, total_turn
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText, parse_wall
from apd_viewer.session.quantities.wall_material import DEFAULT_POISSON

MOST_STEPS = 1000
# Radians per step: the chord stays within 3.4 % of the radius from the arc.
_TURN = math.radians(30.0)
_ROUNDED = 1e-9
# Minimum area relative to the squared longest edge; flatter triangles have a singular Jacobian.
_NO_AREA = 1e-10
_DEFAULT_THICKNESS = 1e-3  # relative to the diagonal of the mesh
_DEFAULT_YOUNG = 1.0
_KILOGRAMS = 1e3  # kg/m³ per g/cm³
# Consistent derived units, spelled out for common units of length.
_KNOWN = {
    Unit.MILLIMETRE: "stress and Young's modulus MPa, mass tonne, density tonne/mm3",
    Unit.METRE: "stress and Young's modulus Pa, mass kg, density kg/m3",
}


def deck_of(
    document: Document, wall: DeckWall, steps: int | None = None, motion: Sequence[MotionStep] = ()
) -> Deck:
    """FE deck with the held vertices displaced from rest to their targets.

    Parameters
    ----------
    steps : int or None
        Into which the way of the handles is divided, each straight for every node; without, one for each 30°.
    motion : sequence of MotionStep
        Instead of the poses of the document.

    Raises
    ------
    InputError
        If base or handle are missing, or nothing is left to compute.
    """
    if steps is not None and not 1 <= steps <= MOST_STEPS:
        raise InputError(tr("A deck has 1 to {most} steps; enter another number.").format(most=MOST_STEPS))
    document = document.relative_to_rest
    stages = _stages(document, steps, motion)
    document.constraints()  # raises InputError without base or handle
    mesh = document.mesh
    used, notes = _elements(document)
    held = _held_node_sets(document, used_vertices(mesh.joined_F[used]))
    ways = [_shifts(each, held) for each in stages]
    return Deck(mesh.name, mesh.V, mesh.joined_F, used, held, _regions(document, used), ways, wall, notes)


def _stages(document: Document, steps: int | None, motion: Sequence[MotionStep]) -> list[Document]:
    """Documents at the end of each step."""
    paths = motion_paths(document, motion) if motion else handle_paths(document)
    if steps is None:
        steps = max(1, math.ceil(max(total_turn(path) for path in paths) / _TURN - _ROUNDED))
    ended = document_along_paths(document, paths) if motion else document
    return [*(document_at(document, paths, k / steps) for k in range(1, steps)), ended]


def _shifts(document: Document, node_sets: Sequence[NodeSet]) -> list[np.ndarray]:
    """Displacements (k, 3) of each node set from rest to its targets."""
    held, X = document.constraints(), document.mesh.V.copy()
    X[held.fixed] = held.targets
    return [X[part.vertices] - document.mesh.V[part.vertices] for part in node_sets]


def _elements(document: Document) -> tuple[np.ndarray, tuple[str, ...]]:
    """Indices of the triangles used as elements, and comments on omitted ones."""
    F, V = document.mesh.joined_F, document.mesh.V
    sides = V[np.roll(F, -1, axis=1)] - V[F]
    longest = (sides**2).sum(axis=2).max(axis=1)
    flat = ~(memo.triangle_areas(V, F) > _NO_AREA * longest)
    is_held = document.labels != FREE
    part = memo.triangle_components(F)
    loose = ~np.isin(part, part[is_held[F].any(axis=1) & ~flat])
    notes = []
    if flat.any():
        notes.append(f"Left out: {np.count_nonzero(flat)} triangles without area.")
    if (loose & ~flat).any():
        count = np.count_nonzero(loose & ~flat)
        notes.append(f"Left out: {count} triangles of connected parts without base or handle.")
    used = np.flatnonzero(~flat & ~loose)
    if not len(used):
        raise InputError(tr("No triangle with an area touches base or handle; paint the part to compute."))
    return used, tuple(notes)


def _held_node_sets(document: Document, nodes: np.ndarray) -> list[NodeSet]:
    """Node sets of base and handles; empty sets are omitted."""
    names = [("BASE", tr("Base"), BASE)]
    for k, handle in enumerate(document.handles):
        names.append(("HANDLE" if k == 0 else f"HANDLE_{k + 1}", handle.name, HANDLE + k))
    found = [NodeSet(name, title, nodes[document.labels[nodes] == code]) for name, title, code in names]
    return [part for part in found if len(part.vertices)]


def _regions(document: Document, used: np.ndarray) -> list[DeckRegion]:
    """Element sets of the regions."""
    inside = document.member[document.mesh.joined_F[used]]
    whole = (inside == inside[:, :1]).all(axis=1)
    return [
        DeckRegion(region.name, used[whole & (inside[:, 0] == number)])
        for number, region in enumerate(document.regions, start=1)
    ]


def deck_wall(text: WallText, unit: Unit, size: float) -> DeckWall:
    """Wall in the units of a deck, with comments on default values.

    The units are consistent: the mesh unit, newtons and seconds.

    Parameters
    ----------
    unit : Unit
        Of the mesh.
    size : float
        Diagonal of the bounding box of the mesh, for the default of the thickness.

    Raises
    ------
    InputError
        If something is no quantity, or needs the unit of the mesh.
    """
    metre = unit.metres
    if metre is None and (text.young or text.density.strip() or text.material):
        raise InputError(tr("A material needs the unit of the mesh; choose it, or add --unit mm."))
    wall, notes = parse_wall(text, unit), [_unit_comment(unit)]
    thickness, young, heavy = wall.thickness, _DEFAULT_YOUNG, None
    if thickness is None:
        thickness = _DEFAULT_THICKNESS * size
        notes.append("No thickness was given: it is a thousandth of the diagonal of the mesh.")
    if wall.young is not None and metre is not None:
        young = wall.young * metre**2
    else:
        notes.append("No Young's modulus was given: it is 1. Shapes do not depend on it; stresses do.")
    if wall.density is not None and metre is not None:
        heavy = wall.density * (_KILOGRAMS * metre**4)
    else:
        notes.append("No density was given: none is needed for this step.")
    if wall.poisson is None:
        notes.append(f"No Poisson's ratio was given: it is {DEFAULT_POISSON}.")
    return DeckWall(thickness, young, wall.nu, heavy, tuple(notes))


def _unit_comment(unit: Unit) -> str:
    """Comment on the units of the deck."""
    if unit is Unit.NONE:
        return "Lengths are in the unit of the mesh, which is not known. Keep the others consistent with it."
    own = unit.symbol
    usual = f"stress and Young's modulus N/{own}2, mass N s2/{own}, density N s2/{own}4"
    guess = " The unit of length is a guess that nobody confirmed." if unit.is_guess else ""
    return f"Units: length {own}, force N, time s; so {_KNOWN.get(unit.as_confirmed, usual)}.{guess}"
