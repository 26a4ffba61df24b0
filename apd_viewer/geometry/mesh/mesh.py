"""Triangle mesh in file order, and its welded counterpart for the solver."""

from __future__ import annotations

import contextlib
import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import (
    check_argument,
    check_mesh,
    checked_floats,
    checked_integers,
    diagonal,
    extents,
    frozen,
    mesh_size,
    used_vertices,
)
from apd_viewer.geometry.mesh.normals import CornerNormals
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.geometry.mesh.weld import WELD_TOLERANCE, Weld
from apd_viewer.language import tr


class Origin(Protocol):
    """Source file of a mesh, rewritable with other coordinates."""

    @property
    def suffix(self) -> str:
        """Suffix of the file name in lower case, identifying the format."""

    @property
    def extras(self) -> tuple[str, ...]:
        """File contents besides positions and triangles, in words."""

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours, (n, 3) uint8, or None; raises ValueError if damaged."""

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals (k, 3), and the index of the normal of each corner of ``mesh``, (m, 3).

        -1 is none. None without normals; ValueError if they are damaged.
        """

    def texture(self, mesh: Mesh) -> Texture | None:
        """Texture of ``mesh``, or None without one.

        ValueError if it is damaged, InputError if an image cannot be read.
        """

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with the positions ``U`` (n, 3) of the vertices of ``mesh``."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices and triangles in file order, never reordered or merged.

    Attributes
    ----------
    V : (n, 3) float64 array
        Rest positions, mesh units, read-only.
    F : (m, 3) int64 array
        Triangles, counter-clockwise seen from outside, read-only.
    path : Path or None
        File that the mesh came from; None without one.
    origin : Origin or None
        Contents of that file, to write it with other coordinates.
    remarks : tuple of str
        Sentences: what is strange about that file, and what it has that was not read.
    unit : str
        Symbol of the unit of length, such as ``mm``, where the file states it; else empty.

    Examples
    --------
    >>> import apd_viewer
    >>> mesh = apd_viewer.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh.V[mesh.F].shape  # corners of each triangle
    (1, 3, 3)
    """

    V: np.ndarray
    F: np.ndarray
    path: Path | None = field(default=None)
    origin: Origin | None = field(default=None)
    remarks: tuple[str, ...] = field(default=())
    unit: str = field(default="")

    def __post_init__(self) -> None:
        V, F = self.V, self.F
        for name, without in (("path", None), ("origin", None), ("remarks", ()), ("unit", "")):
            if (given := getattr(self, name)) is not without:
                check_argument(name, given)
        if self.path is not None:
            object.__setattr__(self, "path", Path(self.path))
        if self.origin is None:  # file readers give valid and unshared arrays
            V, F = checked_floats(V, tr("Vertices")), checked_integers(F, tr("Faces"))
        check_mesh(V, F)
        object.__setattr__(self, "V", frozen(V))
        object.__setattr__(self, "F", frozen(F))

    def __setstate__(self, state: dict[str, object]) -> None:
        """Restore the state of a copy, with read-only arrays."""
        self.__dict__.update(state)
        frozen(self.V)
        frozen(self.F)

    @classmethod
    def from_checked_arrays(
        cls,
        V: np.ndarray,
        F: np.ndarray,
        path: Path | None = None,
        origin: Origin | None = None,
        weld: tuple[np.ndarray, np.ndarray] | None = None,
        remarks: tuple[str, ...] = (),
        unit: str = "",
    ) -> Mesh:
        """Mesh of validated read-only arrays, with its weld if known."""
        mesh = cls.__new__(cls)
        mesh.__dict__.update(V=V, F=F, path=path, origin=origin, remarks=remarks, unit=unit)
        if weld is not None:
            mesh.__dict__["weld"] = Weld.from_maps(V, *weld)
        return mesh

    def baked(self, U: np.ndarray) -> Mesh:
        """The mesh with rest positions ``U`` (n, 3), read-only; welds are kept.

        It came from the same file, and is written into it as a deformed shape would be.
        """
        read = self.origin.mesh if isinstance(self.origin, BakedOrigin) else self
        origin = BakedOrigin(read.origin, read) if read.origin is not None else None
        return Mesh.from_checked_arrays(
            U, self.F, self.path, origin, self._weld_maps, self.remarks, self.unit
        )

    def welded(self) -> Mesh:
        """The mesh with nearly touching seams welded; vertices and file are unchanged.

        Boundary vertices within 1e-4 of the size of the mesh, and within half of the shorter boundary edge
        there, move together from now on.

        Examples
        --------
        >>> import apd_viewer
        >>> V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 1e-5], [0, 1, 1e-5], [1, 1, 0]]
        >>> mesh = apd_viewer.Mesh(V, [[0, 1, 2], [3, 5, 4]])
        >>> mesh.joined_F.tolist(), mesh.welded().joined_F.tolist()
        ([[0, 1, 2], [3, 5, 4]], [[0, 1, 2], [1, 5, 2]])
        """
        return self.welded_to(self.weld.with_seams(self.V, self.F, self.opposite_half_edges).representative)

    def welded_to(self, representative: np.ndarray) -> Mesh:
        """The mesh with each vertex welded to the one in ``representative`` (n,)."""
        weld = Weld.from_representatives(self.V, representative)
        joined = weld.first, weld.inverse
        return Mesh.from_checked_arrays(
            self.V, self.F, self.path, self.origin, joined, self.remarks, self.unit
        )

    @property
    def has_welded_seams(self) -> bool:
        """True if the weld closes gaps wider than rounding."""
        return self.weld.target_tolerance > 4.0 * WELD_TOLERANCE * mesh_size(self.V, self.F)

    def without_path(self) -> Mesh:
        """Copy of the mesh without its path."""
        origin = self.origin
        if isinstance(origin, BakedOrigin):
            origin = BakedOrigin(origin.origin, origin.mesh.without_path())
        return Mesh.from_checked_arrays(
            self.V, self.F, None, origin, self._weld_maps, self.remarks, self.unit
        )

    @property
    def _weld_maps(self) -> tuple[np.ndarray, np.ndarray]:
        return self.weld.first, self.weld.inverse

    @cached_property
    def weld(self) -> Weld:
        """Map between the vertices of the file and those of the welded solve mesh."""
        return Weld.from_positions(self.V, self.F)

    @cached_property
    def colors(self) -> np.ndarray | None:
        """Vertex colours of the file, (n, 3) uint8; None if missing or damaged."""
        with contextlib.suppress(ValueError):  # damaged colours: the mesh is usable without them
            colors = None if self.origin is None else self.origin.colors
            if colors is not None and colors.shape == self.V.shape:
                return frozen(colors)
        return None

    @cached_property
    def corner_normals(self) -> CornerNormals | None:
        """Normals of the file; None if missing or damaged."""
        if isinstance(self.origin, BakedOrigin):
            return self.origin.mesh.corner_normals
        with contextlib.suppress(ValueError):  # damaged normals: the mesh is usable without them
            if self.origin is not None and (found := self.origin.normals(self)) is not None:
                return CornerNormals.from_normals(*found, self.V, self.F)
        return None

    @cached_property
    def texture(self) -> tuple[Texture | None, str | None]:
        """Texture of the file, if any, and a sentence if it cannot be shown."""
        if isinstance(self.origin, BakedOrigin):
            return self.origin.mesh.texture
        try:
            return (None if self.origin is None else self.origin.texture(self)), None
        except InputError as error:
            return None, str(error)
        except ValueError:  # damaged texture: the mesh is usable without it
            return None, None

    @cached_property
    def joined_F(self) -> np.ndarray:
        """Triangles with each vertex replaced by the first at its position."""
        return self.weld.representative[self.F]

    @cached_property
    def opposite_half_edges(self) -> np.ndarray:
        """Opposite half-edge of each half-edge of :attr:`joined_F`, (m, 3) int32.

        ``3 t + k`` is the one from corner k of triangle t to the next; negative where there is none.
        """
        from apd_viewer.geometry.mesh import edges_and_components  # imported here: numba takes long to load

        return frozen(edges_and_components.opposite_half_edges(self.joined_F, len(self.V)))

    @property
    def named_lengths(self) -> dict[str, float]:
        """Lengths by name, mesh units: box sides X, Y, Z, longest side L, diagonal D."""
        used = self.V[used_vertices(self.F)]
        sides = dict(zip("XYZ", extents(used).tolist(), strict=True))
        return {**sides, "L": max(sides.values()), "D": diagonal(used)}

    @cached_property
    def digest(self) -> str:
        """SHA-256 of positions and triangles, hexadecimal, for equality tests."""
        V, F = self.V.astype("<f8"), self.F.astype("<i8")
        return hashlib.sha256(str(V.shape).encode() + V.tobytes() + F.tobytes()).hexdigest()

    @property
    def name(self) -> str:
        """File name for display, or "mesh"."""
        return self.path.name if self.path else "mesh"

    @property
    def stem(self) -> str:
        """File name without suffix, for naming files derived from the mesh."""
        return self.path.stem if self.path else "mesh"


@dataclass(frozen=True, eq=False)
class DerivedOrigin:
    """Origin based on another one, with the same contents.

    Attributes
    ----------
    origin : Origin
    """

    origin: Origin

    @property
    def suffix(self) -> str:
        """Suffix of the file name."""
        return self.origin.suffix

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents of the file besides positions and triangles."""
        return self.origin.extras

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours of the file."""
        return self.origin.colors

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals of the file, and the index of each corner's normal."""
        return self.origin.normals(mesh)

    def texture(self, mesh: Mesh) -> Texture | None:
        """Texture of the file."""
        return self.origin.texture(mesh)

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3)."""
        return self.origin.rewritten_content(mesh, U)


@dataclass(frozen=True, eq=False)
class BakedOrigin(DerivedOrigin):
    """Origin of a mesh with baked rest positions.

    Attributes
    ----------
    mesh : Mesh
        As it was read from ``origin``.
    """

    mesh: Mesh

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours of the file."""
        return self.mesh.colors

    def normals(self, _: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals of the file, for the undeformed mesh."""
        return self.origin.normals(self.mesh)

    def texture(self, _: Mesh) -> Texture | None:
        """Texture of the file."""
        return self.mesh.texture[0]

    def rewritten_content(self, _: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3); unmoved vertices as written."""
        return self.origin.rewritten_content(self.mesh, U)
