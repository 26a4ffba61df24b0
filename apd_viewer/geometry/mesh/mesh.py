"""A triangle mesh in file order, and the welded mesh of the solve."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trn

if TYPE_CHECKING:
    from pathlib import Path


def frozen(array: np.ndarray) -> np.ndarray:
    """Return ``array`` marked read-only (in place: no copy)."""
    array.flags.writeable = False
    return array


class Origin(Protocol):
    """Source file of a mesh, rewritable with other coordinates."""

    @property
    def suffix(self) -> str:
        """Of its name, in small letters: tells the format."""

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""

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
        V, F = self.V, self.F
        if self.origin is None:  # what is read from a file is as it should be, and nobody else has it
            V, F = numbers(V, tr("Vertices")), whole_numbers(F, tr("Faces"))
        check_mesh(V, F)
        object.__setattr__(self, "V", frozen(V))
        object.__setattr__(self, "F", frozen(F))

    @classmethod
    def trusted(
        cls,
        V: np.ndarray,
        F: np.ndarray,
        path: Path | None = None,
        origin: Origin | None = None,
        weld: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> Mesh:
        """Mesh of read-only arrays already checked, with its weld if known."""
        mesh = cls.__new__(cls)
        mesh.__dict__.update(V=V, F=F, path=path, origin=origin)
        if weld is not None:
            mesh.__dict__["weld"] = Weld.between(V, *weld)
        return mesh

    def baked(self, U: np.ndarray) -> Mesh:
        """The mesh with rest positions ``U`` (n, 3), read-only; welds are kept.

        It came from the same file, and is written into it as a deformed shape would be.
        """
        read = self.origin.mesh if isinstance(self.origin, Baked) else self
        origin = Baked(read, read.origin) if read.origin is not None else None
        return Mesh.trusted(U, self.F, self.path, origin, (self.weld.first, self.weld.inverse))

    def homeless(self) -> Mesh:
        """The mesh without its path."""
        origin = self.origin
        if isinstance(origin, Baked):
            origin = Baked(origin.mesh.homeless(), origin.origin)
        return Mesh.trusted(self.V, self.F, None, origin, (self.weld.first, self.weld.inverse))

    @cached_property
    def weld(self) -> Weld:
        """The maps between the file's vertices and the vertices of the solve."""
        return Weld.of(self.V, self.F)

    @cached_property
    def joined_F(self) -> np.ndarray:
        """Triangles with each vertex replaced by the first at its position."""
        return self.weld.first[self.weld.inverse[self.F]]

    @cached_property
    def digest(self) -> str:
        """SHA-256 of positions and triangles, hexadecimal, for equality tests."""
        V, F = self.V.astype("<f8"), self.F.astype("<i8")
        return hashlib.sha256(str(V.shape).encode() + V.tobytes() + F.tobytes()).hexdigest()

    @property
    def name(self) -> str:
        """File name for people, or "mesh"."""
        return self.path.name if self.path else "mesh"

    @property
    def stem(self) -> str:
        """Name without suffix, for files derived from the mesh."""
        return self.path.stem if self.path else "mesh"


@dataclass(frozen=True, eq=False)
class Baked:
    """Origin of a mesh with baked rest positions.

    Attributes
    ----------
    mesh : Mesh
        As it was read.
    origin : Origin
        Of that.
    """

    mesh: Mesh
    origin: Origin

    @property
    def suffix(self) -> str:
        """Of the file's name."""
        return self.origin.suffix

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents of the file besides positions and triangles."""
        return self.origin.extras

    def rewritten(self, _: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3); unmoved vertices as written."""
        return self.origin.rewritten(self.mesh, U)


# Vertices at a border that lie closer than that, in diagonals of the bounding box, are joined.
TOLERANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Weld:
    """Map of file vertices at one position to one vertex of the solve.

    Files repeat vertices at texture seams, and STL repeats all of them: without welding such a mesh falls
    apart into loose triangles. Equal positions are joined; at borders, where rounding leaves cracks, also
    those within :data:`TOLERANCE` of each other.

    Attributes
    ----------
    first : (k,) int array
        For every vertex of the solve the first file vertex at its position.
    inverse : (n,) int array
        For every file vertex its vertex of the solve.
    offset : (n, 3) float array or None
        How far every file vertex lies from the position that it is joined at; None if nowhere.
    """

    first: np.ndarray
    inverse: np.ndarray
    offset: np.ndarray | None = None

    @classmethod
    def of(cls, V: np.ndarray, F: np.ndarray | None = None) -> Weld:
        """Weld positions ``V`` (n, 3) in file order; ``F`` (m, 3) gives borders."""
        order = np.lexsort((np.arange(len(V)), V[:, 2], V[:, 1], V[:, 0]))
        new = np.ones(len(V), dtype=bool)
        new[1:] = (V[order[1:]] != V[order[:-1]]).any(axis=1)
        leader = order[np.flatnonzero(new)[np.cumsum(new) - 1]]
        representative = np.empty(len(V), dtype=np.int64)
        representative[order] = leader
        if F is not None:
            representative = _cracks_closed(V, F, representative)
        first, inverse = np.unique(representative, return_inverse=True)
        return cls.between(V, first, inverse)

    @classmethod
    def between(cls, V: np.ndarray, first: np.ndarray, inverse: np.ndarray) -> Weld:
        """The weld with these maps of the positions ``V`` (n, 3)."""
        first, inverse = frozen(first), frozen(inverse)
        if len(first) == len(inverse):
            return cls(first, inverse)
        offset = V - V[first[inverse]]
        return cls(first, inverse, frozen(offset) if offset.any() else None)

    @property
    def slack(self) -> float:
        """Tolerance between targets of welded vertices, in box diagonals."""
        return 0.0 if self.offset is None else 4.0 * TOLERANCE

    def offset_of(self, ids: np.ndarray) -> np.ndarray | float:
        """Offset of the file vertices ``ids`` from their welded positions."""
        return 0.0 if self.offset is None else self.offset[ids]

    def everywhere(self, ids: np.ndarray) -> np.ndarray:
        """File vertices ``ids`` with all others at their positions, ascending."""
        if len(self.first) == len(self.inverse):
            return ids
        covered = np.zeros(len(self.first), dtype=bool)
        covered[self.inverse[ids]] = True
        return np.flatnonzero(covered[self.inverse])

    def spread(self, U: np.ndarray) -> np.ndarray:
        """Positions ``U`` (k, 3) of solve vertices spread to the file's, (n, 3)."""
        if len(U) == len(self.inverse):
            return U.copy()
        spread = U[self.inverse]
        return spread if self.offset is None else spread + self.offset


def _cracks_closed(V: np.ndarray, F: np.ndarray, representative: np.ndarray) -> np.ndarray:
    """Representatives joining border vertices across cracks; neighbours stay apart."""
    corners = representative[F]
    a, b = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    edge = a != b
    key = np.minimum(a, b)[edge] * len(V) + np.maximum(a, b)[edge]
    key.sort()
    alone = np.ones(len(key), dtype=bool)
    alone[1:] &= key[1:] != key[:-1]
    alone[:-1] &= key[:-1] != key[1:]
    if not alone.any():
        return representative
    from scipy.spatial import KDTree  # most meshes have no cracks, and the window opens before it is loaded

    border = np.unique(np.concatenate([key[alone] // len(V), key[alone] % len(V)]))
    near = TOLERANCE * np.linalg.norm(np.ptp(V[corners.ravel()], axis=0))
    pairs = border[np.sort(KDTree(V[border]).query_pairs(near, output_type="ndarray"), axis=1)]
    pairs = pairs[~np.isin(pairs[:, 0] * len(V) + pairs[:, 1], key)]
    joined = representative.copy()
    for low, high in pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist():
        joined[high] = joined[low]
    return joined[representative]


def numbers(given: object, what: str) -> np.ndarray:
    """Float64 copy of a caller's array, or InputError."""
    try:
        array = np.asarray(given)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "iuf":
        raise InputError(
            tr("{what} must be an array of real numbers with rows of equal length.").format(what=what)
        )
    return array.astype(np.float64)


def whole_numbers(given: object, what: str) -> np.ndarray:
    """Int64 copy of a caller's array, or InputError if that would round."""
    array = numbers(given, what)
    if not (np.abs(array) < 2.0**53).all() or (array != np.rint(array)).any():
        raise InputError(
            tr("{what} must be whole numbers: ids of vertices, counted from 0.").format(what=what)
        )
    return array.astype(np.int64)


def check_mesh(V: np.ndarray, F: np.ndarray) -> None:
    """Raise InputError unless ``V`` (n, 3), ``F`` (m, 3) are a mesh with area."""
    if V.ndim != 2 or V.shape[1] != 3:
        raise InputError(
            tr("Vertices must be an (n, 3) array, not {shape}; give one row x y z a vertex.").format(
                shape=V.shape
            )
        )
    if F.ndim != 2 or F.shape[1] != 3:
        raise InputError(
            tr("Faces must be an (m, 3) array of triangles, not {shape}; triangulate the mesh first.").format(
                shape=F.shape
            )
        )
    if len(F) == 0:
        raise InputError(tr("There are no faces in it; export the mesh as a surface."))
    if not np.isfinite(V).all():
        bad = np.flatnonzero(~np.isfinite(V).all(axis=1))
        said = trn(
            "{n:,} vertex has a coordinate that is not a number (the first is vertex {first}); "
            "repair the file.",
            "{n:,} vertices have a coordinate that is not a number (the first is vertex {first}); "
            "repair the file.",
            len(bad),
        )
        raise InputError(said.format(n=len(bad), first=bad[0]))
    if F.min() < 0 or F.max() >= len(V):
        missing = int(((F < 0) | (len(V) <= F)).any(axis=1).sum())
        said = trn(
            "{n:,} face refers to missing vertices (there are {there:,}); "
            "repair the file or export it again.",
            "{n:,} faces refer to missing vertices (there are {there:,}); "
            "repair the file or export it again.",
            missing,
        )
        raise InputError(said.format(n=missing, there=len(V)))
