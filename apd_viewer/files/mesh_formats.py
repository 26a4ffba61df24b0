"""Mesh formats, and the table of their properties.

The formats to open, offer and write, their names and the suffixes in packages follow from the rows. The
readers are in meshes.py, so that the help of the command line loads faster.
"""

from enum import Enum
from typing import NamedTuple


class WriteSupport(Enum):
    """Meshes that can be written in a format."""

    ANY = "any mesh"
    OWN = "a mesh that was read from one"
    NONE = "no"


class MeshFormat(NamedTuple):
    """File format of meshes, an entry of ``MESH_FORMATS``.

    Attributes
    ----------
    opening : bytes
        Pattern of its beginning, by which a misnamed file is known.
    writing : WriteSupport
        ANY is by trimesh.
    holds_any_shape : bool
        No trial need show that it can store a deformed shape.
    has_digits : bool
        Export takes a number of decimals.
    has_parts : bool
        Whether it may refer to files beside it.
    """

    name: str
    opening: bytes
    writing: WriteSupport = WriteSupport.OWN
    holds_any_shape: bool = False
    has_digits: bool = False
    is_in_metres: bool = False
    has_parts: bool = False


XML_PROLOG = rb"\s*(?:<[?!][^>]*>\s*)*<"  # up to the name of the root element
_NUMBER = rb"[ \t]+[-+.\d]\S*"

MESH_FORMATS = {
    ".obj": MeshFormat(
        "OBJ",
        rb"(?:[^\x00]*\n)?[ \t]*v" + 3 * _NUMBER + rb"[^\n]*\n",
        WriteSupport.ANY,
        holds_any_shape=True,
        has_digits=True,
    ),
    ".ply": MeshFormat("PLY", rb"ply\s", WriteSupport.ANY),
    ".stl": MeshFormat("STL", rb"(?i)\s*solid\b.*\bfacet\s+normal", WriteSupport.ANY, holds_any_shape=True),
    ".off": MeshFormat(
        "OFF", rb"(?:ST)?C?N?4?n?OFF(?:\s|\d)", WriteSupport.ANY, holds_any_shape=True, has_digits=True
    ),
    ".glb": MeshFormat("GLB", rb"glTF", WriteSupport.ANY, is_in_metres=True),
    ".gltf": MeshFormat("glTF", rb'\s*\{.*"asset"\s*:', has_parts=True),
    ".3mf": MeshFormat("3MF", rb"PK\x03\x04.*3D/", WriteSupport.NONE),
    ".vtp": MeshFormat("VTP", XML_PROLOG + rb'VTKFile\s[^>]*type="PolyData"'),
    ".vtu": MeshFormat("VTU", XML_PROLOG + rb'VTKFile\s[^>]*type="UnstructuredGrid"'),
    ".vtk": MeshFormat("VTK", rb"# vtk DataFile"),
}
# Models that the libraries of an extra divide into triangles.
_STEP = MeshFormat("STEP", rb"\s*ISO-10303-21", WriteSupport.NONE)
_IGES = MeshFormat("IGES", rb"[^\r\n]{72}S[ 0]{6}1", WriteSupport.NONE)
CAD_FORMATS = {".stp": _STEP, ".step": _STEP, ".igs": _IGES, ".iges": _IGES}
READABLE_NAMES = tuple(dict.fromkeys(each.name for each in (MESH_FORMATS | CAD_FORMATS).values()))
# Files of several shapes: a list of mesh files, glTF, and points of a mesh in another file.
SERIES, GLTF_FORMATS, POINT_CACHES = ".pvd", (".glb", ".gltf"), (".pc2", ".mdd")
WRITABLE_FORMATS = tuple(suffix for suffix, each in MESH_FORMATS.items() if each.writing is WriteSupport.ANY)
