"""Open a mesh from a file, and write deformed positions."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.obj import read_obj
from apd_viewer.files.off import read_off
from apd_viewer.files.ply import read_ply
from apd_viewer.files.replacing import replacing
from apd_viewer.files.stl import read_stl
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
    # os.path and not Path: it says no where Path raises, as for a name that is too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(f"There is no file {path}; check the name.")
    if not path.is_file():
        raise InputError(f"{path} is not a file; choose a mesh in it.")
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path.name} is of a kind that cannot be opened; use {_NAMES}.")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name} is empty; export the mesh again.")


def _read(path: Path) -> tuple[np.ndarray, np.ndarray]:
    kind = path.suffix.lower()
    if kind == ".glb":
        return _read_glb(path)
    if kind in (".obj", ".off"):
        text = path.read_text(encoding="utf-8-sig", errors="replace")
        return read_obj(text) if kind == ".obj" else read_off(text)
    return read_ply(path.read_bytes()) if kind == ".ply" else read_stl(path.read_bytes())


def _read_glb(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """All meshes of the scene, each where its node puts it, in the order of the file."""
    import trimesh  # here, because it takes longer to import than all the rest of a headless run

    scene = trimesh.load_scene(path, process=False, maintain_order=True, skip_materials=True)
    order = {name: k for k, name in enumerate(scene.geometry)}
    placed = sorted((order[scene.graph[node][1]], node) for node in scene.graph.nodes_geometry)
    V, F, count = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], 0
    for _, node in placed:
        M, name = scene.graph[node]
        part = scene.geometry[name]
        if hasattr(part, "faces"):
            V.append(part.vertices @ M[:3, :3].T + M[:3, 3])
            F.append(part.faces + count)
            count += len(part.vertices)
    return np.vstack(V), np.vstack(F)


def check_target(path: str | Path) -> Path:
    """Return ``path`` if a mesh can be written there as far as its name tells, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path.name} does not name a format to write; end it in {', '.join(FORMATS)}.")
    if not os.path.isdir(path.parent):  # noqa: PTH112
        raise InputError(f"There is no folder {path.parent}; make it first or choose another.")
    if os.path.isdir(path):  # noqa: PTH112
        raise InputError(f"{path} cannot be written (it is a folder); choose another name.")
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
    if not np.isfinite(U).all():
        raise InputError("A position is not a finite number; nothing was written.")
    kind = path.suffix[1:].lower()
    largest = float(np.abs(U).max())
    if kind not in ("obj", "off") and largest > float(np.finfo(np.float32).max):
        raise InputError(f"{path.name} cannot hold coordinates as large as {largest:.3g}; use OBJ or OFF.")
    decimals = min(300, max(0, 15 - math.ceil(math.log10(largest)))) if largest > 0 else 1
    digits = {"digits": decimals} if kind in ("obj", "off") else {}
    # To memory first: trimesh leaves its file open when the disk is full.
    content = trimesh.Trimesh(U, mesh.F, process=False).export(file_type=kind, **digits)
    with replacing(path) as scratch:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)
