"""Reading of animations: the mesh of a file, and its shapes one after another."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import PC2_HEADER
from apd_viewer.files.animations.animation_shapes import blender_vertex_order
from apd_viewer.files.gltf.gltf_reader import keyed_positions
from apd_viewer.files.mesh_formats import GLTF_FORMATS, SERIES
from apd_viewer.files.meshes import check_readable, open_mesh, read_mesh
from apd_viewer.files.storage.regular_files import one_line_message, read_content, sibling_content
from apd_viewer.geometry.mesh.arrays import LARGEST_COORDINATE, frozen, largest_coordinate
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr


class OpenedAnimation(NamedTuple):
    """Mesh of an animation, and its shapes (n, 3), the first one that of the mesh."""

    mesh: Mesh
    shapes: Iterator[np.ndarray]


def open_animation(path: Path) -> OpenedAnimation:
    """Open the mesh of a file, with its shapes if it has several.

    A series (``.pvd``) has a file for each shape; glTF has morph targets. The shapes are read as they are
    asked for, and raise the same error.

    Raises
    ------
    InputError
        If there is no such file or it holds no usable mesh.
    """
    check_readable(path, (SERIES,))
    suffix = path.suffix.lower()
    if suffix == SERIES:
        return _open_series(path)
    mesh = open_mesh(path)
    return OpenedAnimation(mesh, _gltf_shapes(path, mesh) if suffix in GLTF_FORMATS else iter(()))


def _open_series(path: Path) -> OpenedAnimation:
    names = _series_names(path)
    mesh = _series_mesh(path, names[0])

    def shapes() -> Iterator[np.ndarray]:
        yield mesh.V
        for name in names[1:]:
            other = _series_mesh(path, name)
            if other.V.shape != mesh.V.shape or not np.array_equal(other.F, mesh.F):
                said = tr("{name} in {series} has other triangles than the first mesh; open it by itself.")
                raise InputError(said.format(name=other.name, series=path.name))
            yield other.V

    return OpenedAnimation(mesh, shapes())


def _series_names(path: Path) -> list[str]:
    """Names of the files of a series, in order of time; raises InputError."""
    try:
        rows = [row.attrib for row in ElementTree.fromstring(read_content(path)).iter("DataSet")]
        times = [float(row.get("timestep", k)) for k, row in enumerate(rows)]
    except (ElementTree.ParseError, LookupError, ValueError) as error:  # also of an unknown encoding
        raise _damaged(path, error) from error
    if not rows:
        raise InputError(tr("{name} lists no files; export it again.").format(name=path.name))
    if len(set(times)) < len(times):
        said = tr("{name} lists several files at one time; save the surface as one .vtp file.")
        raise InputError(said.format(name=path.name))
    return [rows[k].get("file", "") for k in np.argsort(times)]


def _series_mesh(path: Path, name: str) -> Mesh:
    place = path.parent / name.replace("\\", "/")
    try:
        content = sibling_content(name, path)
    except OSError as error:
        said = tr("{name} cannot be read ({reason}); check the file.")
        raise InputError(said.format(name=place.name, reason=error.strerror or error)) from error
    if content is None:
        said = tr("{name}, which {series} refers to, is missing; put it back beside it.")
        raise InputError(said.format(name=name, series=path.name))
    check_readable(place)
    return read_mesh(place, content)


def _gltf_shapes(path: Path, mesh: Mesh) -> Iterator[np.ndarray]:
    """Shapes of an animation of morph weights; none without one."""
    try:
        for X in keyed_positions(read_content(path), path):
            yield _checked(X, mesh)
    except InputError:  # already has a user-readable message
        raise
    except ValueError as error:
        raise _damaged(path, error) from error


def read_point_cache(path: Path, mesh: Mesh) -> Iterator[np.ndarray]:
    """Shapes (n, 3) from a PC2 or MDD file written for ``mesh``.

    Vertices that the cache leaves out lie with those at the same place, or stay at rest.

    Raises
    ------
    InputError
        If the file is damaged or was written for another mesh.
    """
    content, points = read_content(path), blender_vertex_order(mesh)
    try:
        kind, start, count, size = _cache_layout(content, path.suffix.lower())
        if len(content) < start + 12 * count * size:
            raise ValueError(tr("it ends too early"))
    except struct.error as error:  # its words are for programmers
        raise _damaged(path, ValueError(tr("it ends too early"))) from error
    except ValueError as error:
        raise _damaged(path, error) from error
    if size != len(points):
        said = tr("{name} has {n:,} points, and {mesh} has {m:,}; open the mesh that it was written of.")
        raise InputError(said.format(name=path.name, n=size, mesh=mesh.name, m=len(points)))
    shapes = np.frombuffer(content, kind, 3 * count * size, start).reshape(count, size, 3)
    source = _cache_rows(mesh, points)
    for X in shapes:
        U = np.where(source[:, None] >= 0, X[source], mesh.V).astype(np.float64)
        try:
            yield _checked(U, mesh)
        except ValueError as error:
            raise _damaged(path, error) from error


def _cache_layout(content: bytes, suffix: str) -> tuple[str, int, int, int]:
    """Type of the numbers, their first byte, and the counts of shapes and points."""
    if suffix == ".pc2":
        signature, _, size, _, _, count = PC2_HEADER.unpack_from(content)
        if not signature.startswith(b"POINTCACHE2"):
            raise ValueError(tr("it is another type of file"))
        kind, start = "<f4", PC2_HEADER.size
    else:
        count, size = struct.unpack_from(">ii", content)
        kind, start = ">f4", 8 + 4 * count
    if count < 1 or size < 1:
        raise ValueError(tr("it has no shapes"))
    return kind, start, count, size


def _cache_rows(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Row of each vertex (n,) among the ``points`` of a cache; -1 where it has none."""
    rows = np.full(len(mesh.V), -1)
    rows[points] = np.arange(len(points))
    of_weld = np.full(len(mesh.V), -1)
    of_weld[mesh.weld.representative[points]] = rows[points]
    return np.where(rows >= 0, rows, of_weld[mesh.weld.representative])


def _checked(X: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Read-only shape ``X`` (n, 3) of the mesh; raises ValueError unless it is one."""
    if X.shape != mesh.V.shape or not np.isfinite(X).all() or largest_coordinate(X) > LARGEST_COORDINATE:
        raise ValueError(tr("one of its shapes does not fit the mesh"))
    return mesh.V if np.array_equal(X, mesh.V) else frozen(X)


def _damaged(path: Path, error: Exception) -> InputError:
    said = tr("{name} is not a valid {kind} file ({reason}); export it again.")
    kind, reason = path.suffix[1:].upper(), one_line_message(error)
    return InputError(said.format(name=path.name, kind=kind, reason=reason))
