"""Writing of meshes, verified by reading them back."""

import contextlib
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS, WRITABLE_FORMATS, WriteSupport
from apd_viewer.files.meshes import parsed_mesh
from apd_viewer.files.storage.atomic_file import (
    file_write_error,
    is_circular_link,
    is_stream,
    replacing_file,
    resolved_path,
)
from apd_viewer.files.storage.confinement import check_writing
from apd_viewer.files.storage.regular_files import one_line_message, without_library_warnings
from apd_viewer.geometry.mesh.arrays import (
    LARGEST_COORDINATE,
    check_type,
    checked,
    checked_floats,
    largest_coordinate,
)
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.notation import METRES

_ROUNDING = 1e-4  # tolerance of the file read back, relative to the size of the shape
_SINGLE = 2.0**-23  # relative rounding of single precision


def check_mesh_path(path: str | Path) -> Path:
    """Return ``path`` if its name allows writing a mesh, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() in CAD_FORMATS:
        raise InputError(
            tr("{name} cannot be written: {kind} is only read; use {endings}.").format(
                name=path.name,
                kind=CAD_FORMATS[path.suffix.lower()].name,
                endings=", ".join(WRITABLE_FORMATS),
            )
        )
    if path.suffix.lower() not in MESH_FORMATS:
        raise InputError(
            tr("{name} does not have a supported ending; use {endings}.").format(
                name=path.name or path, endings=", ".join(WRITABLE_FORMATS)
            )
        )
    check_writable(path)
    return path


def check_writable(path: Path) -> None:
    """Raise InputError unless ``path`` can be a file or stream in an existing folder."""
    if "\0" in str(path):
        raise InputError(tr("A file name has no null character; choose another."))
    check_writing(path)
    if is_circular_link(path):
        raise InputError(
            tr("{path} is a link that leads to itself; remove it, or choose another name.").format(path=path)
        )
    if not os.path.isdir(path.parent):  # noqa: PTH112
        raise InputError(
            tr("There is no folder {folder}; create it or choose another.").format(folder=path.parent)
        )
    if os.path.isdir(path):  # noqa: PTH112
        raise InputError(
            tr("{path} cannot be written (it is a folder); choose another name.").format(path=path)
        )
    try:
        is_stream(path)
    except OSError as error:
        raise file_write_error(path, error) from error


def check_files(paths: Iterable[Path | None]) -> None:
    """Raise InputError unless all files are distinct and writable; skip None."""
    asked = [path for path in paths if path is not None]
    check_distinct(asked)
    for path in asked:
        check_writable(path)


def check_distinct(paths: Iterable[Path]) -> None:
    """Raise InputError if two of the files are the same."""
    seen = set()
    for path in paths:
        place = resolved_path(path)
        if place in seen:
            raise InputError(
                tr("{name} would be written twice; give each file a name of its own.").format(name=path.name)
            )
        seen.add(place)


class WrittenMesh(NamedTuple):
    """Outcome of writing a mesh.

    Attributes
    ----------
    area : float
        Measured on the file.
    dropped : tuple of str
        Contents of the opened file that are missing from the new one.
    """

    area: float
    dropped: tuple[str, ...]


def suffix_for(mesh: Mesh) -> str:
    """Suffix for storing shapes of ``mesh``: its own if the format allows, else .obj."""
    own = mesh.origin.suffix if mesh.origin else ".obj"
    kind = MESH_FORMATS[own]
    if kind.holds_any_shape:  # saves the trial write below, which takes seconds for large meshes
        return own
    if kind.writing is not WriteSupport.NONE and not kind.has_parts:
        with contextlib.suppress(InputError):  # OBJ can store shapes that the mesh's own format cannot
            check_shapes(mesh, Path(f"shape{own}"), np.ones(len(mesh.V), dtype=bool))
            return own
    return ".obj"


def check_shapes(mesh: Mesh, path: Path, is_moving: np.ndarray) -> None:
    """Raise InputError unless the file of ``mesh`` can store deformed shapes.

    Called before they are computed: ``path`` in the format of the mesh gets a copy of its file, which may be
    unable to store independent displacements of the vertices ``is_moving`` (n,).
    """
    if mesh.origin is not None and mesh.origin.suffix == path.suffix.lower():
        ways = np.random.default_rng(0).uniform(0.0, 1e-3 * np.ptp(mesh.V, axis=0).max(), mesh.V.shape)
        _content(mesh, np.where(is_moving[:, None], mesh.V + ways, mesh.V), path)


def dropped_contents(mesh: Mesh, path: str | Path) -> tuple[str, ...]:
    """Names of contents lost by writing ``mesh`` to ``path``; none in its own format."""
    origin, kind = mesh.origin, Path(path).suffix.lower()
    if origin is None or origin.suffix == kind:
        return ()
    return origin.extras


@checked
def save_mesh(mesh: Mesh, U: np.ndarray, path: str | Path, unit: str | None = None) -> WrittenMesh:
    """Write ``mesh`` with the positions ``U``; the suffix selects the format.

    In its original format, the mesh is the same file with other coordinates; those of unmoved vertices are
    kept digit by digit. In any other format, positions and triangles are written to a new file: PLY, STL and
    GLB in single precision, OBJ and OFF with 15 significant digits. GLB is in metres: lengths in a known unit
    are converted.

    Parameters
    ----------
    mesh : Mesh
    U : (n, 3) float array
        Positions in the order of the file, mesh units.
    path : path
        Replaced only once the new file is whole.
    unit : str or None
        Unit of length: "mm", "cm", "m", "in" or "ft"; empty is none. By default the one of the mesh.

    Raises
    ------
    InputError
        If the file cannot be written.

    Returns
    -------
    Written

    Examples
    --------
    >>> import apd_viewer
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> written = apd_viewer.save_mesh(mesh, 2 * mesh.V, "large.obj")
    >>> f"{written.area:.1f}", written.dropped
    ('1628.5', ())
    """
    check_type("mesh", mesh, Mesh)
    path = check_mesh_path(path)
    if unit and unit not in METRES:
        raise InputError(
            tr("“{unit}” is not a unit of length; use {units}.").format(unit=unit, units=", ".join(METRES))
        )
    U = checked_floats(U, tr("Positions"))
    if U.shape != mesh.V.shape:
        raise InputError(tr("Give {n:,} positions, one for each vertex of the mesh.").format(n=len(mesh.V)))
    if not np.isfinite(U).all():
        raise InputError(tr("A position is not a finite number; nothing was written."))
    if largest_coordinate(U) > LARGEST_COORDINATE:
        raise InputError(
            tr("A position of {largest:.3g} is too large; nothing was written.").format(
                largest=largest_coordinate(U)
            )
        )
    from apd_viewer.geometry.mesh.operators import area  # imported late, since it is slow to load

    metre = _metre_factor(mesh, path, mesh.unit if unit is None else unit)
    content = _content(mesh, metre * U, path)
    try:
        V, F, *_ = parsed_mesh(content, path)
        V = V / metre
    except InputError:  # a link beside the new file leads outside its folder
        raise
    except ValueError:
        V, F = U[:0], mesh.F[:0]
    rounding = _ROUNDING * float(np.ptp(U, axis=0).max())
    if mesh.origin is not None and mesh.origin.suffix == path.suffix.lower():
        rounding = max(rounding, _SINGLE * largest_coordinate(U))  # as coarse as the file was
    if not _is_same_shape(V, F, mesh, U, rounding):
        raise InputError(
            tr("{name} cannot store this shape accurately; choose another format.").format(name=path.name)
        )
    with replacing_file(path) as scratch:
        scratch.write_bytes(content)
    return WrittenMesh(area(V, F), dropped_contents(mesh, path))


def _metre_factor(mesh: Mesh, path: Path, unit: str) -> float:
    """Metres per unit for a new file in metres; else 1."""
    is_new = mesh.origin is None or mesh.origin.suffix != path.suffix.lower()
    return METRES.get(unit, 1.0) if is_new and MESH_FORMATS[path.suffix.lower()].is_in_metres else 1.0


def _is_same_shape(V: np.ndarray, F: np.ndarray, mesh: Mesh, U: np.ndarray, rounding: float) -> bool:
    """True if the file read back is ``mesh`` at ``U``, in any order of vertices."""
    if len(F) != len(mesh.F):
        return False
    is_same_order = V.shape == U.shape and np.array_equal(F, mesh.F)
    there, here = (V, U) if is_same_order else (V[F], U[mesh.F])
    return bool(np.abs(there - here).max() <= rounding)


def _content(mesh: Mesh, U: np.ndarray, path: Path) -> bytes:
    """File content with positions ``U``: the original rewritten, or a new file."""
    kind = path.suffix.lower()
    if mesh.origin is not None and mesh.origin.suffix == kind:
        try:
            return mesh.origin.rewritten_content(mesh, U)
        except InputError as error:
            raise InputError(f"{path.name}: {error}") from error
        except ValueError as error:  # normals are not validated on reading
            raise InputError(
                tr("{name} has normals that cannot be updated ({reason}); choose another format.").format(
                    name=mesh.name, reason=one_line_message(error)
                )
            ) from error
    if kind not in WRITABLE_FORMATS:
        raise InputError(
            tr("{name} is in a format that can only be updated, not created; choose OBJ or PLY.").format(
                name=path.name
            )
        )
    import trimesh  # imported here: slower to import than the rest of a headless run

    size = largest_coordinate(U)
    decimals = min(300, max(0, 15 - math.ceil(math.log10(size)))) if size > 0 else 1
    digits = {"digits": decimals} if MESH_FORMATS[kind].has_digits else {}
    # Exported to memory first: trimesh leaves its file open when the disk is full.
    with without_library_warnings():
        content = trimesh.Trimesh(U, mesh.F, process=False).export(file_type=kind[1:], **digits)
    return content.encode() if isinstance(content, str) else content
