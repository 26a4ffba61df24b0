"""FE decks for CalculiX and Abaqus: shells with their held nodes displaced."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.arrays import diagonal, significant_digits, used_vertices
from apd_viewer.language import tr

DECK_SUFFIX = ".inp"
# Triangles with midside nodes, and without. CalculiX expands them to solid wedges; without midside nodes
# these are far too stiff in bending.
SIX_NODES, THREE_NODES = "S6", "S3"
_STRI65 = "Abaqus calls the elements S6 STRI65; rename them there."
_ABAQUS = "Abaqus does not know OUTPUT=2D, by which CalculiX keeps the numbers of the nodes; remove it there."
_DIGITS = 12  # significant digits: 18 characters with sign, point and exponent; more only for large numbers
_A_LINE = 16  # maximum number of ids per line of a set
_LONGEST = 100  # maximum number of characters of a name in a comment
_STATIC = "0.1, 1., 1e-5"  # initial increment, step period, minimum increment
_MOST_INCREMENTS = 1000
_MOST_MATERIALS = 50  # of a wall distribution


class DeckWall(NamedTuple):
    """Thickness and material of the shell wall, in the units of the deck.

    Attributes
    ----------
    thickness : float
        Mesh units. A wall map is written at the nodes, each with the mean of its elements;
        its moduli are materials.
    young : float
        Young's modulus, newtons per square mesh unit; of a wall map the mean.
    density : float or None
        Newtons times s² per mesh unit to the fourth.
    notes : tuple of str
        Comments: the units, and values left at their defaults.
    """

    thickness: float
    young: float
    poisson: float
    density: float | None
    notes: tuple[str, ...] = ()


class NodeSet(NamedTuple):
    """Node set of the base or a handle: set name, name by the user, vertices (k,)."""

    name: str
    title: str
    vertices: np.ndarray


class DeckRegion(NamedTuple):
    """Element set of a region: its name and its triangles (k,)."""

    title: str
    triangles: np.ndarray


class Deck(NamedTuple):
    """Shell model with wall data and prescribed displacements of the held nodes.

    Attributes
    ----------
    source : str
        Name of the mesh.
    V : (n, 3) float array
        Rest positions, mesh units.
    F : (m, 3) int array
        Triangles without seams.
    used_faces : (k,) int array
        Triangles of ``F`` used as elements.
    steps : sequence of sequences of (k, 3) float arrays
        Displacements of each of the sets ``held_sets`` at the end of each step, mesh units.
    notes : tuple of str
        Comments on the surface.
    element : str
        SIX_NODES or THREE_NODES.
    """

    source: str
    V: np.ndarray
    F: np.ndarray
    used_faces: np.ndarray
    held_sets: Sequence[NodeSet]
    regions: Sequence[DeckRegion]
    steps: Sequence[Sequence[np.ndarray]]
    wall: DeckWall
    notes: tuple[str, ...] = ()
    element: str = SIX_NODES

    @property
    def held_count(self) -> int:
        """Number of held nodes."""
        return sum(len(part.vertices) for part in self.held_sets)


def check_deck(path: str | Path) -> Path:
    """Return ``path`` if its name allows writing a deck, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() != DECK_SUFFIX:
        raise InputError(tr("{name} is not an FE deck; use the ending .inp.").format(name=path.name))
    check_writable(path)
    return path


def write_deck(path: str | Path, deck: Deck) -> None:
    """Write a deck atomically; raises InputError if it cannot be written."""
    with (
        replacing_file(check_deck(path)) as scratch,
        scratch.open("w", encoding="ascii", newline="\n") as stream,
    ):
        stream.writelines(f"{line}\n" for line in _lines(deck))


def _lines(deck: Deck) -> Iterator[str]:
    """Lines of the deck; nodes, those on edges last, and elements count from 1."""
    yield "*HEADING"
    yield _ascii_name(f"Written by apd-viewer from {deck.source}")  # a name may begin with * like a keyword
    renamed = (_STRI65,) if deck.element == SIX_NODES else ()
    yield from (f"** {note}" for note in (*deck.wall.notes, *deck.notes, *renamed, _ABAQUS))
    whole, ends = _with_midsides(deck)
    yield from _mesh_lines(whole)
    yield from _set_lines(whole)
    yield from _wall_lines(whole)
    for shifts in deck.steps:
        pairs = zip(shifts, ends, strict=True)
        moved = [np.concatenate([shift, shift[rows].mean(axis=1)]) for shift, rows in pairs]
        yield from _step_lines(whole.held_sets, moved)


def _with_midsides(deck: Deck) -> tuple[Deck, list[np.ndarray]]:
    """Add the nodes on edges, held with both ends of their edge.

    Returns the deck, and for each set the rows (k, 2) of the ends of its edges.
    """
    if deck.element == THREE_NODES:
        return deck, [np.empty((0, 2), dtype=np.int64)] * len(deck.held_sets)
    F = deck.F[deck.used_faces]
    sides = np.sort(np.stack([F, np.roll(F, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    edges, at = np.unique(sides, axis=0, return_inverse=True)
    count = len(deck.V)
    elements = np.zeros((len(deck.F), 6), dtype=np.int64)
    elements[deck.used_faces] = np.hstack([F, count + at.reshape(-1, 3)])
    held, ends = [], []
    for part in deck.held_sets:
        row = np.full(count, -1)
        row[part.vertices] = np.arange(len(part.vertices))
        inside = (row[edges] >= 0).all(axis=1)
        nodes = np.concatenate([part.vertices, count + np.flatnonzero(inside)])
        held.append(part._replace(vertices=nodes))
        ends.append(row[edges[inside]])
    V = np.concatenate([deck.V, deck.V[edges].mean(axis=1)])
    return deck._replace(V=V, F=elements, held_sets=held), ends


def _mesh_lines(deck: Deck) -> Iterator[str]:
    """Lines of the nodes in the rest shape and of the elements."""
    nodes = used_vertices(deck.F[deck.used_faces])
    size = diagonal(deck.V[nodes])
    yield "*NODE, NSET=ALL"
    for node, point in zip((nodes + 1).tolist(), deck.V[nodes].tolist(), strict=True):
        yield f"{node}, " + ", ".join(_number(x, significant_digits(x, size, _DIGITS)) for x in point)
    yield f"*ELEMENT, TYPE={deck.element}, ELSET=SURFACE"
    for element, corners in zip(
        deck.used_faces.tolist(), (deck.F[deck.used_faces] + 1).tolist(), strict=True
    ):
        yield f"{element + 1}, " + ", ".join(map(str, corners))


def _set_lines(deck: Deck) -> Iterator[str]:
    for part in deck.held_sets:
        yield f"** {part.name}: {_ascii_name(part.title)}"
        yield f"*NSET, NSET={part.name}"
        yield from _rows(part.vertices)
    for number, region in enumerate(deck.regions, start=1):
        if len(region.triangles):
            yield f"** REGION_{number}: {_ascii_name(region.title)}"
            yield f"*ELSET, ELSET=REGION_{number}"
            yield from _rows(region.triangles)


def _wall_lines(deck: Deck) -> Iterator[str]:
    wall, used = deck.wall, deck.used_faces
    mapped = wall.thickness if isinstance(wall.thickness, WallMap) else None
    factors, at = _modulus_groups(mapped, used)
    for number, factor in enumerate(factors, start=1):
        word = f"_{number}" if len(factors) > 1 else ""
        if word:
            yield f"*ELSET, ELSET=SURFACE{word}"
            yield from _rows(used[at == number - 1])
        yield f"*MATERIAL, NAME=WALL{word}"
        yield "*ELASTIC"
        yield f"{_number(wall.young * factor)}, {_number(wall.poisson)}"
        if wall.density is not None:
            yield "*DENSITY"
            yield _number(wall.density)
        nodal = ", NODAL THICKNESS" if mapped else ""
        yield f"*SHELL SECTION, ELSET=SURFACE{word}, MATERIAL=WALL{word}{nodal}"
        yield _number(wall.thickness)
    if mapped:
        F = deck.F[used]
        values = WallMap(mapped, mapped.triangles[used]).at_vertices(F, len(deck.V))
        yield "*NODAL THICKNESS"
        yield from (f"{node + 1}, {_number(values[node])}" for node in used_vertices(F).tolist())


def _modulus_groups(mapped: WallMap | None, used: np.ndarray) -> tuple[list[float], np.ndarray]:
    """Moduli over their mean, one for each material, and materials (k,) of elements.

    Many different ones are gathered in classes of equal width, each with the mean in it.
    """
    factors = np.ones(len(used)) if mapped is None or mapped.young is None else mapped.young.factors[used]
    least, width = factors.min(), np.ptp(factors) / _MOST_MATERIALS
    kind = factors
    if len(np.unique(factors)) > _MOST_MATERIALS:
        kind = np.minimum((factors - least) // width, _MOST_MATERIALS - 1.0)
    groups, at, counts = np.unique(kind, return_inverse=True, return_counts=True)
    means = np.bincount(at, factors) / counts if kind is not factors else groups
    return means.tolist(), at


def _step_lines(held: Sequence[NodeSet], shifts: Sequence[np.ndarray]) -> Iterator[str]:
    """Lines of one step to the displacements (k, 3) of the held nodes."""
    yield f"*STEP, NLGEOM, INC={_MOST_INCREMENTS}"
    yield from ("*STATIC", _STATIC, "*BOUNDARY")
    for part, shift in zip(held, shifts, strict=True):
        if not shift.any():
            yield f"{part.name}, 1, 3"
            continue
        for node, along in zip((part.vertices + 1).tolist(), shift.tolist(), strict=True):
            yield from (f"{node}, {axis}, {axis}, {_number(x)}" for axis, x in enumerate(along, start=1))
    yield from (
        f"*NODE FILE, OUTPUT=2D, FREQUENCY={_MOST_INCREMENTS}",
        "U, RF",
        f"*EL FILE, FREQUENCY={_MOST_INCREMENTS}",
        "S",
        "*END STEP",
    )


def _rows(ids: np.ndarray) -> Iterator[str]:
    """Lines of ids counted from 1, with at most 16 ids each."""
    words = list(map(str, (ids + 1).tolist()))
    return (", ".join(words[k : k + _A_LINE]) for k in range(0, len(words), _A_LINE))


def _number(value: float, digits: int = _DIGITS) -> str:
    """Number in at most 20 characters, the most that FE programs read."""
    text = f"{value + 0.0:.{digits}g}"
    return text if "." in text or "e" in text else text + "."


def _ascii_name(name: str) -> str:
    """A name given by the user, as one line of ASCII."""
    return " ".join(name.split())[:_LONGEST].encode("ascii", "replace").decode()
