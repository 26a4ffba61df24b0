"""A triangle mesh as the user's file has it, and the welded mesh that is solved."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from apd_viewer.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path


def frozen(array: np.ndarray) -> np.ndarray:
    """Return ``array`` marked read-only (in place: no copy)."""
    array.flags.writeable = False
    return array


class Origin(Protocol):
    """The file that a mesh came from, which can be written again with other coordinates."""

    @property
    def suffix(self) -> str:
        """Of its name, in small letters: tells the format."""

    @property
    def extras(self) -> tuple[str, ...]:
        """What it holds besides positions and triangles, in words."""

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """The file with the positions ``U`` (n, 3) of the vertices of ``mesh``."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices and triangles in the order of the file: never reordered, never merged.

    Attributes
    ----------
    V : (n, 3) float64 array
        Rest positions, mesh units, read-only.
    F : (m, 3) int64 array
        Triangles, counter-clockwise seen from outside, read-only.
    path : Path or None
        Where the mesh came from.
    origin : Origin or None
        What came from there.
    """

    V: np.ndarray
    F: np.ndarray
    path: Path | None = field(default=None)
    origin: Origin | None = field(default=None)

    def __post_init__(self) -> None:
        V = numbers(self.V, "Vertices")
        # What is read from a file has whole numbers already.
        F = self.F if self.origin else whole_numbers(self.F, "Faces")
        check_mesh(V, F)
        object.__setattr__(self, "V", frozen(V))
        object.__setattr__(self, "F", frozen(F))

    @cached_property
    def weld(self) -> Weld:
        """The maps between the file's vertices and the vertices of the solve."""
        return Weld.of(self.V)

    @cached_property
    def joined_F(self) -> np.ndarray:
        """Triangles with every vertex named by the first at its position: connected across seams."""
        return self.weld.first[self.weld.inverse[self.F]]

    @property
    def name(self) -> str:
        """File name for people, or "mesh"."""
        return self.path.name if self.path else "mesh"


@dataclass(frozen=True, eq=False)
class Weld:
    """Which file vertices share a position and are therefore one vertex of the solve.

    Files repeat vertices at texture seams, and STL repeats all of them: without welding such a
    mesh falls apart into loose triangles. Only bitwise equal positions are joined.

    Attributes
    ----------
    first : (k,) int array
        For every vertex of the solve the first file vertex at its position.
    inverse : (n,) int array
        For every file vertex its vertex of the solve.
    """

    first: np.ndarray
    inverse: np.ndarray

    @classmethod
    def of(cls, V: np.ndarray) -> Weld:
        """Weld the positions ``V`` (n, 3); the order of the file is kept."""
        order = np.lexsort((np.arange(len(V)), V[:, 2], V[:, 1], V[:, 0]))
        new = np.ones(len(V), dtype=bool)
        new[1:] = (V[order[1:]] != V[order[:-1]]).any(axis=1)
        leader = order[np.flatnonzero(new)[np.cumsum(new) - 1]]
        representative = np.empty(len(V), dtype=np.int64)
        representative[order] = leader
        first, inverse = np.unique(representative, return_inverse=True)
        return cls(frozen(first), frozen(inverse))

    def spread(self, U: np.ndarray) -> np.ndarray:
        """The positions ``U`` (k, 3) of the vertices of the solve, for all vertices of the file, (n, 3)."""
        return U.copy() if len(U) == len(self.inverse) else U[self.inverse]


def numbers(given: object, what: str) -> np.ndarray:
    """Copy what a caller gave into a float64 array, or raise InputError."""
    try:
        array = np.asarray(given)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "iuf":
        raise InputError(f"{what} must be an array of real numbers with rows of equal length.")
    return array.astype(np.float64)


def whole_numbers(given: object, what: str) -> np.ndarray:
    """Copy what a caller gave into an int64 array, or raise InputError where that would round."""
    array = numbers(given, what)
    if not (np.abs(array) < 2.0**53).all() or (array != np.rint(array)).any():
        raise InputError(f"{what} must be whole numbers: ids of vertices, counted from 0.")
    return array.astype(np.int64)


def check_mesh(V: np.ndarray, F: np.ndarray) -> None:
    """Raise InputError unless ``V`` (n, 3) and ``F`` (m, 3) describe a triangle mesh with an area."""
    if V.ndim != 2 or V.shape[1] != 3:
        raise InputError(f"Vertices must be an (n, 3) array, not {V.shape}; give one row x y z a vertex.")
    if F.ndim != 2 or F.shape[1] != 3:
        raise InputError(
            f"Faces must be an (m, 3) array of triangles, not {F.shape}; triangulate the mesh first."
        )
    if len(F) == 0:
        raise InputError("There are no faces in it; export the mesh as a surface.")
    bad = np.flatnonzero(~np.isfinite(V).all(axis=1))
    if len(bad):
        raise InputError(
            f"{counted(len(bad), 'vertex has', 'vertices have')} a coordinate that is not a number "
            f"(the first is vertex {bad[0]}); repair the file."
        )
    missing = int(((F < 0) | (len(V) <= F)).any(axis=1).sum())
    if missing:
        raise InputError(
            f"{counted(missing, 'face refers', 'faces refer')} to missing vertices "
            f"(there are {len(V):,}); repair the file or export it again."
        )


def counted(number: int, one: str, many: str) -> str:
    """A number with its noun and verb: ``counted(2, "face has", "faces have")`` is "2 faces have"."""
    return f"{number:,} {one if number == 1 else many}"
