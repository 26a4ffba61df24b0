"""Open a mesh from a file, and write deformed positions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.obj import read_obj
from apd_viewer.files.replacing import replacing
from apd_viewer.geometry.mesh import Mesh

FORMATS = (".obj", ".ply", ".stl", ".off", ".glb")
_NAMES = "OBJ, PLY, STL, OFF or GLB"


def open_mesh(path: str | Path) -> Mesh:
    """Open a mesh: vertices and triangles in the order of the file.

    Parameters
    ----------
    path : path
        OBJ, PLY, STL, OFF or GLB. Polygons are split into triangles.

    Raises
    ------
    InputError
        If there is no such file or it holds no usable mesh; the message says what is wrong.
    """
    path = Path(path)
    check_readable(path)
    try:
        V, F = _read(path)
    except OSError as error:
        raise InputError(
            f"{path.name} cannot be read ({error.strerror or error}); check the file."
        ) from error
    except Exception as error:  # readers of foreign formats raise whatever they stumble over
        raise InputError(
            f"{path.name} is not a readable {path.suffix[1:].upper()} file ({error}); export it again."
        ) from error
    try:
        return Mesh(V, F, path)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def check_readable(path: Path) -> None:
    """Raise InputError if already the name and the size of the file tell that it cannot be opened."""
    if not path.exists():
        raise InputError(f"There is no file {path}; check the name.")
    if not path.is_file():
        raise InputError(f"{path} is not a file; choose a mesh in it.")
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path.name} is of a kind that cannot be opened; use {_NAMES}.")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name} is empty; export the mesh again.")


def _read(path: Path) -> tuple[np.ndarray, np.ndarray]:
    if path.suffix.lower() == ".obj":
        return read_obj(path.read_text(encoding="utf-8", errors="replace"))
    import trimesh  # here, because it takes longer to import than all the rest of a headless run

    loaded = trimesh.load(path, process=False, maintain_order=True, force="mesh")
    return np.asarray(loaded.vertices), np.asarray(loaded.faces).reshape(-1, 3)


def check_target(path: str | Path) -> Path:
    """Return ``path`` if a mesh can be written there as far as its name tells, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path.name} does not name a format to write; end it in {', '.join(FORMATS)}.")
    if not path.parent.is_dir():
        raise InputError(f"There is no folder {path.parent}; make it first or choose another.")
    return path


def save_mesh(mesh: Mesh, U: np.ndarray, path: str | Path) -> None:
    """Write the triangles of ``mesh`` with the positions ``U``; the format follows the name.

    PLY, STL and GLB hold single precision; OBJ and OFF are written with 15 significant digits.

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
    """
    import trimesh

    path = check_target(path)
    if np.shape(U) != mesh.V.shape:
        raise InputError(f"There must be {len(mesh.V):,} positions, one for each vertex of the mesh.")
    kind = path.suffix[1:].lower()
    largest = float(np.abs(U).max())
    decimals = min(300, max(0, 15 - math.ceil(math.log10(largest)))) if largest > 0 else 1
    digits = {"digits": decimals} if kind in ("obj", "off") else {}
    with replacing(path) as scratch:
        trimesh.Trimesh(U, mesh.F, process=False).export(scratch, file_type=kind, **digits)
