"""Sequence of mesh shapes, each stored in its own file.

A point cache contains no vertex ids: its points are assigned to the vertices of a mesh in order. The order
must therefore be that of an imported mesh, not that of its file.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from apd_viewer.geometry.analysis.scalars import Scalars, shape_scalars
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.mesh import BakedOrigin, Mesh
from apd_viewer.notation import METRES


@dataclass(frozen=True, eq=False)
class Animation:
    """Sequence of mesh shapes, loaded one at a time to save memory.

    Attributes
    ----------
    labels, member : (n,) int arrays
        Base, free or handle, and number of the region, of each vertex.
    files : sequence of Path
        A ``.npy`` file for each shape, (n, 3) positions in the order of the mesh.
    times : sequence of float
        Of each shape, ascending: the part of a motion, or iterations.
    target : TargetShape or None
        Another mesh to compare with.
    on_read : callable
        Called before each shape is read, with its number.
    unit : str or None
        Symbol of the unit of length, empty if unknown; None is that of the mesh.
    up_frame : (3, 3) array
        Directions of an upright front view: right, up and towards the viewer, in rows.
    """

    mesh: Mesh
    labels: np.ndarray
    member: np.ndarray
    files: Sequence[Path]
    times: Sequence[float]
    target: TargetShape | None = None
    on_read: Callable[[int], object] = lambda _: None
    unit: str | None = None
    up_frame: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __len__(self) -> int:
        return len(self.files)

    def __iter__(self) -> Iterator[np.ndarray]:
        for number, path in enumerate(self.files):
            self.on_read(number)
            yield np.load(path)

    @property
    def metres(self) -> float:
        """Metres in the unit of length; 1 if that is unknown."""
        return METRES.get(self.mesh.unit if self.unit is None else self.unit, 1.0)

    def scalars(self, U: np.ndarray) -> Scalars:
        """Scalars of a shape (n, 3)."""
        return shape_scalars(self.mesh, U, self.labels, self.member, self.target)

    @cached_property
    def blender_vertex_order(self) -> np.ndarray:
        """Indices (k,) of the vertices kept by Blender's importer, in its order."""
        return blender_vertex_order(self.mesh)


class ShapeRecorder:
    """Recorder of an unknown number of shapes in a bounded number of files.

    When all files are used, every other one is deleted, and from then on every other shape is skipped; the
    latest shape is always kept.

    Parameters
    ----------
    folder : Path
        Existing, and of its own.
    most : int
        Even.
    """

    def __init__(self, folder: Path, most: int) -> None:
        self._folder, self._most = folder, most
        self._kept: list[int] = []
        self._stride, self._count = 1, 0

    def add(self, U: np.ndarray) -> None:
        """Record a shape (n, 3)."""
        kept = self._kept
        if kept and kept[-1] % self._stride:  # drop the latest shape if it does not fit the stride
            self._path(kept.pop()).unlink()
        if len(kept) == self._most:
            for number in kept[1::2]:
                self._path(number).unlink()
            del kept[1::2]
            self._stride *= 2
        np.save(self._path(self._count), U)
        kept.append(self._count)
        self._count += 1

    def _path(self, number: int) -> Path:
        return self._folder / f"{number}.npy"

    @property
    def files(self) -> list[Path]:
        """``.npy`` files of the kept shapes, in order."""
        return [self._path(number) for number in self._kept]

    @property
    def numbers(self) -> list[float]:
        """Indices of the kept shapes among all recorded ones, from 0."""
        return [float(number) for number in self._kept]


# Formats whose importer drops vertices without a face.
_FACES_ALONE = (".obj", ".glb", ".gltf")


def blender_vertex_order(mesh: Mesh) -> np.ndarray:
    """Indices (k,) of the vertices kept by Blender's importer, in its order.

    STL has no vertices but corners: those equal in single precision become one vertex, in order of first
    appearance. From OBJ and glTF only the vertices of faces are imported; from all other formats, and for a
    mesh without a file, all vertices.
    """
    read = mesh.origin.mesh if isinstance(mesh.origin, BakedOrigin) else mesh
    suffix = mesh.origin.suffix if mesh.origin else ""
    if suffix == ".stl":
        corners = read.V.astype(np.float32) + np.float32(0.0)  # adding 0.0 turns -0.0 into 0.0
        return np.sort(np.unique(corners, axis=0, return_index=True)[1])
    return used_vertices(mesh.F) if suffix in _FACES_ALONE else np.arange(len(mesh.V))
