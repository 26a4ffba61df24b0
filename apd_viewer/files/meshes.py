"""Open a mesh from a file, and write deformed positions."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.foreign import read_3mf
from apd_viewer.files.formats.gltf import read_gltf
from apd_viewer.files.formats.obj import read_obj
from apd_viewer.files.formats.off import read_off
from apd_viewer.files.formats.parsed import Parsed
from apd_viewer.files.formats.ply import read_ply
from apd_viewer.files.formats.stl import read_stl
from apd_viewer.files.storage.atomic_file import replacing
from apd_viewer.files.storage.reading import in_one_line
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

# In which any mesh can be written; a glTF only where it came from one.
WRITTEN = (".obj", ".ply", ".stl", ".off", ".glb")
FORMATS = (*WRITTEN, ".gltf", ".3mf")
_NAMES = tr("OBJ, PLY, STL, OFF, GLB, glTF or 3MF")
_ROUNDING = 1e-4  # of what is written, relative to its size: beyond that it is another shape
_LARGEST = 1e38  # coordinate: single precision holds no larger ones, and areas of larger ones overflow
_READERS = {".obj": read_obj, ".ply": read_ply, ".stl": read_stl, ".off": read_off, ".3mf": read_3mf}


def open_mesh(path: str | Path) -> Mesh:
    """Open a mesh: vertices and triangles in the order of the file.

    Parameters
    ----------
    path : path
        OBJ, PLY, STL, OFF, GLB, glTF or 3MF. Polygons are split into triangles.

    Raises
    ------
    InputError
        If there is no such file or it holds no usable mesh; the message says what is wrong.
    """
    path = Path(path)
    check_readable(path)
    return read_mesh(path)


def read_mesh(path: Path, content: bytes | None = None) -> Mesh:
    """Read the mesh in a file or ``content``; raises InputError like open_mesh."""
    try:
        V, F, origin = _parsed(_read(path) if content is None else content, path)
    except OSError as error:
        raise InputError(
            tr("{name} cannot be read ({reason}); check the file.").format(
                name=path.name, reason=error.strerror or error
            )
        ) from error
    except MemoryError as error:
        raise InputError(
            tr("{name} is too large for the memory; make the mesh coarser.").format(name=path.name)
        ) from error
    except ValueError as error:
        raise InputError(
            tr("{name} is not a readable {kind} file ({reason}); export it again.").format(
                name=path.name, kind=path.suffix[1:].upper(), reason=in_one_line(error)
            )
        ) from error
    try:
        mesh = Mesh(V, F, path, origin)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error
    largest = _largest(V)
    if largest > _LARGEST:
        raise InputError(
            tr("{name} has coordinates as large as {largest:.3g}; repair the file.").format(
                name=path.name, largest=largest
            )
        )
    return mesh


def _largest(X: np.ndarray) -> float:
    """Largest absolute coordinate."""
    return max(float(X.max()), -float(X.min()))


def check_readable(path: Path, also: tuple[str, ...] = ()) -> None:
    """Raise InputError on an unsupported name or size, before reading.

    What ends in one of ``also`` is no mesh, but can be opened too.
    """
    # os.path and not Path: it says no where Path raises, as for a name that is too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(tr("There is no file {path}; check the name.").format(path=path))
    if not path.is_file():
        raise InputError(tr("{path} is not a file; choose a mesh in it.").format(path=path))
    if path.suffix.lower() not in (*FORMATS, *also):
        raise InputError(
            tr("{name} is of a kind that cannot be opened; use {kinds}.").format(name=path.name, kinds=_NAMES)
        )
    if path.stat().st_size == 0:
        raise InputError(tr("{name} is empty; export the mesh again.").format(name=path.name))


def _read(path: Path) -> bytes:
    return path.read_bytes()


def _parsed(content: bytes, path: Path) -> Parsed:
    kind = path.suffix.lower()
    if kind in (".glb", ".gltf"):
        return read_gltf(content, path)
    return _READERS[kind](content)


def check_target(path: str | Path) -> Path:
    """Return ``path`` if its name allows writing a mesh, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            tr("{name} does not name a format to write; end it in {endings}.").format(
                name=path.name, endings=", ".join(WRITTEN)
            )
        )
    if not os.path.isdir(path.parent):  # noqa: PTH112
        raise InputError(
            tr("There is no folder {folder}; make it first or choose another.").format(folder=path.parent)
        )
    if os.path.isdir(path):  # noqa: PTH112
        raise InputError(
            tr("{path} cannot be written (it is a folder); choose another name.").format(path=path)
        )
    return path


class Written(NamedTuple):
    """Outcome of writing a mesh.

    Attributes
    ----------
    area : float
        Measured on the file.
    dropped : tuple of str
        What the file that it was opened from has, and the new one has not.
    """

    area: float
    dropped: tuple[str, ...]


def dropped(mesh: Mesh, path: str | Path) -> tuple[str, ...]:
    """Losses of writing ``mesh`` to ``path``, in words; none in its own format."""
    origin, kind = mesh.origin, Path(path).suffix.lower()
    if origin is None or origin.suffix == kind:
        return ()
    return origin.extras


def save_mesh(mesh: Mesh, U: np.ndarray, path: str | Path) -> Written:
    """Write ``mesh`` with the positions ``U``; the format follows the name.

    In the format that the mesh was opened from it is the same file with other coordinates: what did not move
    stands there as it stood, digit by digit. In any other, positions and triangles are written anew: PLY, STL
    and GLB hold single precision then, OBJ and OFF 15 significant digits.

    Parameters
    ----------
    mesh : Mesh
    U : (n, 3) float array
        Positions in the order of the file, mesh units.
    path : path
        Replaced only once the new file is whole.

    Raises
    ------
    InputError
        If the file cannot be written.

    Returns
    -------
    Written
    """
    path = check_target(path)
    if np.shape(U) != mesh.V.shape:
        raise InputError(
            tr("There must be {n:,} positions, one for each vertex of the mesh.").format(n=len(mesh.V))
        )
    if not np.isfinite(U).all():
        raise InputError(tr("A position is not a finite number; nothing was written."))
    if _largest(U) > _LARGEST:
        raise InputError(
            tr("A position is as large as {largest:.3g}; nothing was written.").format(largest=_largest(U))
        )
    from apd_viewer.geometry.mesh.operators import area  # loads what the first picture must not wait for

    content = _content(mesh, U, path)
    try:
        V, F, _ = _parsed(content, path)
    except ValueError:
        V, F = U[:0], mesh.F[:0]
    if not _holds(V, F, mesh, U):
        raise InputError(
            tr("{name} would not hold the shape as it is; choose another format to write.").format(
                name=path.name
            )
        )
    with replacing(path) as scratch:
        scratch.write_bytes(content)
    return Written(area(V, F), dropped(mesh, path))


def _holds(V: np.ndarray, F: np.ndarray, mesh: Mesh, U: np.ndarray) -> bool:
    """True if the file read back equals ``mesh`` at ``U``, up to corner names."""
    if len(F) != len(mesh.F):
        return False
    there, here = (V, U) if V.shape == U.shape else (V[F], U[mesh.F])
    rounding = _ROUNDING * max(_largest(U), float(np.ptp(U, axis=0).max()))
    return bool(np.abs(there - here).max() <= rounding)


def _content(mesh: Mesh, U: np.ndarray, path: Path) -> bytes:
    """File content at ``U``: the original rewritten, or a new file."""
    kind = path.suffix.lower()
    if mesh.origin is not None and mesh.origin.suffix == kind:
        try:
            return mesh.origin.rewritten(mesh, U)
        except InputError as error:
            raise InputError(f"{path.name}: {error}") from error
        except ValueError as error:  # normals, which nobody has looked at yet
            raise InputError(
                tr(
                    "{name} has normals that are not understood ({reason}); choose another format to write."
                ).format(name=mesh.name, reason=in_one_line(error))
            ) from error
    if kind not in WRITTEN:
        raise InputError(
            tr("{name} is of a kind that is not written anew; choose OBJ or PLY.").format(name=path.name)
        )
    import trimesh  # here, because it takes longer to import than all the rest of a headless run

    largest = _largest(U)
    decimals = min(300, max(0, 15 - math.ceil(math.log10(largest)))) if largest > 0 else 1
    digits = {"digits": decimals} if kind in (".obj", ".off") else {}
    # To memory first: trimesh leaves its file open when the disk is full.
    content = trimesh.Trimesh(U, mesh.F, process=False).export(file_type=kind[1:], **digits)
    return content.encode() if isinstance(content, str) else content
