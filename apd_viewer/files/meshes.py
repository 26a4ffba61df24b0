"""Open a mesh from a file, and write deformed positions."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.obj import read_obj
from apd_viewer.files.formats.off import read_off
from apd_viewer.files.formats.package_3mf import read_3mf
from apd_viewer.files.formats.parsed_mesh import EncodedMeshOrigin, ParsedMesh
from apd_viewer.files.formats.ply import read_ply
from apd_viewer.files.formats.stl import read_stl
from apd_viewer.files.formats.text import decoded_text
from apd_viewer.files.gltf.gltf_reader import read_gltf
from apd_viewer.files.other_content import no_vertices_message, other_format_message
from apd_viewer.files.storage.regular_files import one_line_message, read_bytes, without_library_warnings
from apd_viewer.files.vtk.legacy import read_vtk
from apd_viewer.files.vtk.xml_surface import read_vtp, read_vtu
from apd_viewer.geometry.mesh.checked_arguments import checked
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

# Formats for writing any mesh; .gltf and those of VTK only for a mesh read from one.
WRITABLE_FORMATS = (".obj", ".ply", ".stl", ".off", ".glb")
VTK_FORMATS = (".vtp", ".vtu", ".vtk")
MESH_FORMATS = (*WRITABLE_FORMATS, ".gltf", ".3mf", *VTK_FORMATS)
_OF_OTHER_FILES = (".pvd", ".pvtp", ".pvtu", ".pvtk", ".vtm", ".vtmb")
_NAMES = tr("OBJ, PLY, STL, OFF, GLB, glTF, 3MF, VTP, VTU or VTK")
LARGEST_COORDINATE = 1e38  # coordinate: larger ones exceed single precision, and their areas overflow
_READERS = {".obj": read_obj, ".ply": read_ply, ".stl": read_stl, ".off": read_off, ".3mf": read_3mf}
_READERS |= {".vtp": read_vtp, ".vtu": read_vtu, ".vtk": read_vtk}


@checked
def open_mesh(path: str | Path) -> Mesh:
    """Open a mesh: vertices and triangles in the order of the file.

    Parameters
    ----------
    path : path
        OBJ, PLY, STL, OFF, GLB, glTF, 3MF, VTP, VTU or legacy VTK. Polygons are split into triangles.

    Raises
    ------
    InputError
        If there is no such file or it holds no usable mesh; the message says what is wrong.

    Examples
    --------
    >>> import apd_viewer
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> mesh.V.shape, mesh.F.shape
    ((13010, 3), (26016, 3))
    """
    path = Path(path)
    check_readable(path)
    return read_mesh(path)


def read_mesh(path: Path, content: bytes | None = None) -> Mesh:
    """Read the mesh in a file or ``content``; raises InputError like open_mesh."""
    try:
        content = read_bytes(path) if content is None else content
        with without_library_warnings():
            V, F, origin, remarks, unit = parsed_mesh(content, path)
    except OSError as error:
        raise InputError(
            tr("{name} cannot be read ({reason}); check the file.").format(
                name=path.name, reason=error.strerror or error
            )
        ) from error
    except MemoryError as error:
        raise InputError(
            tr("{name} does not fit into memory; reduce the mesh first.").format(name=path.name)
        ) from error
    except InputError:  # already a sentence
        raise
    except ValueError as error:
        raise InputError(_about_invalid(content or b"", path, error)) from error
    if not len(V):
        raise InputError(no_vertices_message(decoded_text(content)[0], path))
    try:
        mesh = Mesh(V, F, path, origin, remarks, unit)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error
    size = largest_coordinate(V)
    if size > LARGEST_COORDINATE:
        raise InputError(
            tr("{name} has coordinates as large as {size:.3g}; repair the file.").format(
                name=path.name, size=size
            )
        )
    return mesh


def _about_invalid(content: bytes, path: Path, error: ValueError) -> str:
    invalid = tr("{name} is not a valid {kind} file ({reason}); export it again.").format(
        name=path.name, kind=path.suffix[1:].upper(), reason=one_line_message(error)
    )
    return other_format_message(decoded_text(content)[0], path) or invalid


def largest_coordinate(X: np.ndarray) -> float:
    """Largest absolute coordinate."""
    return max(float(X.max()), -float(X.min()))


def check_readable(path: Path, more_suffixes: tuple[str, ...] = ()) -> None:
    """Raise InputError on an unsupported name or size, before reading.

    What ends in one of ``more_suffixes`` is no mesh, but can be opened too.
    """
    # os.path: Path raises on names that are too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(tr("There is no file {path}; check the name.").format(path=path))
    if not path.is_file():
        raise InputError(tr("{path} is not a file; choose a mesh file.").format(path=path))
    if path.suffix.lower() in _OF_OTHER_FILES:
        raise InputError(
            tr(
                "{name} refers to other files; open one of them, or save the surface as one .vtp file."
            ).format(name=path.name)
        )
    if path.suffix.lower() not in (*MESH_FORMATS, *more_suffixes):
        raise InputError(
            tr("{name} is not a supported file type; use {kinds}.").format(name=path.name, kinds=_NAMES)
        )
    if path.stat().st_size == 0:
        raise InputError(tr("{name} is empty; export the mesh again.").format(name=path.name))


def parsed_mesh(content: bytes, path: Path) -> ParsedMesh:
    """Read a mesh in the format of its suffix."""
    text, encoding = decoded_text(content)
    kind = path.suffix.lower()
    found = read_gltf(text, path) if kind in (".glb", ".gltf") else _READERS[kind](text)
    if encoding is None or found.origin is None:
        return found
    return found._replace(origin=EncodedMeshOrigin(found.origin, encoding))
