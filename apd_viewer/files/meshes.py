"""Opening of mesh files, and error messages for unreadable ones."""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from apd_viewer.errors import InputError
from apd_viewer.files.formats import obj, off, package_3mf, ply, stl
from apd_viewer.files.formats.cad import BY_DEFAULT, CadDivision, read_cad
from apd_viewer.files.formats.polygon_mesh import EncodedMeshOrigin, ParsedMesh
from apd_viewer.files.formats.text import decoded_text
from apd_viewer.files.gltf.gltf_reader import read_gltf
from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS, READABLE_NAMES, XML_PROLOG, MeshFormat
from apd_viewer.files.storage.regular_files import one_line_message, read_bytes, without_library_warnings
from apd_viewer.files.vtk import legacy, xml_surface
from apd_viewer.geometry.mesh.arrays import checked
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import alternatives, tr

_OF_OTHER_FILES = (".pvd", ".pvtp", ".pvtu", ".pvtk", ".vtm", ".vtmb")
_READERS = {".obj": obj.read_obj, ".off": off.read_off, ".ply": ply.read_ply, ".stl": stl.read_stl}
_READERS |= {".3mf": package_3mf.read_3mf, ".vtk": legacy.read_vtk}
_READERS |= {".vtp": xml_surface.read_vtp, ".vtu": xml_surface.read_vtu}


@checked
def open_mesh(path: str | Path, chord: float | None = None, edge: float | None = None) -> Mesh:
    """Open a mesh file, keeping the order of its vertices and triangles.

    Parameters
    ----------
    path : path
        OBJ, PLY, STL, OFF, GLB, glTF, 3MF, VTP, VTU or legacy VTK. Polygons are split into triangles. STEP
        and IGES need the extra ``cad``.
    chord : float, optional
        Largest distance of the mesh from the surface of a CAD model, in mm; by default 1/2,000 of its
        diagonal.
    edge : float, optional
        Length of the edges of a CAD model's even triangles, in mm; by default 1/60 of its diagonal. 0 leaves
        it as OpenCASCADE divides it.

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
    if (chord, edge) != (None, None) and path.suffix.lower() not in CAD_FORMATS:
        said = tr("{name} is no CAD model, and has triangles already; omit chord and edge, or remesh it.")
        raise InputError(said.format(name=path.name))
    return read_mesh(path, division=CadDivision(chord, edge))


def read_mesh(path: Path, content: bytes | None = None, division: CadDivision = BY_DEFAULT) -> Mesh:
    """Read the mesh in a file or ``content``; raises InputError like open_mesh."""
    try:
        content = read_bytes(path) if content is None else content
        with without_library_warnings():
            V, F, origin, remarks, unit = parsed_mesh(content, path, division)
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
    except InputError:  # already has a user-readable message
        raise
    except ValueError as error:
        raise InputError(invalid_file_message(content or b"", path, error)) from error
    if not len(V):
        raise InputError(no_vertices_message(decoded_text(content)[0], path))
    try:
        return Mesh(V, F, path, origin, remarks, unit)
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def invalid_file_message(content: bytes, path: Path, error: ValueError) -> str:
    """Sentence about a file that cannot be understood."""
    suffix = path.suffix.lower()
    kind = CAD_FORMATS[suffix].name if suffix in CAD_FORMATS else suffix[1:].upper()
    invalid = tr("{name} is not a valid {kind} file ({reason}); export it again.").format(
        name=path.name, kind=kind, reason=one_line_message(error)
    )
    return other_format_message(decoded_text(content)[0], path) or invalid


def check_readable(path: Path, more_suffixes: tuple[str, ...] = ()) -> None:
    """Raise InputError on a missing, unsupported or empty file, before reading it.

    Files with one of ``more_suffixes`` are no meshes, but can be opened too.
    """
    # os.path: Path raises on names that are too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(tr("There is no file {path}; check the name.").format(path=path))
    if not path.is_file():
        raise InputError(tr("{path} is not a file; choose a mesh file.").format(path=path))
    if path.suffix.lower() in _OF_OTHER_FILES and path.suffix.lower() not in more_suffixes:
        raise InputError(
            tr(
                "{name} refers to other files; open one of them, or save the surface as one .vtp file."
            ).format(name=path.name)
        )
    if path.suffix.lower() not in (*MESH_FORMATS, *CAD_FORMATS, *more_suffixes):
        raise InputError(
            tr("{name} is not a supported file type; use {kinds}.").format(
                name=path.name,
                kinds=alternatives(READABLE_NAMES),
            )
        )
    if path.stat().st_size == 0:
        raise InputError(tr("{name} is empty; export the mesh again.").format(name=path.name))


def parsed_mesh(content: bytes, path: Path, division: CadDivision = BY_DEFAULT) -> ParsedMesh:
    """Parse mesh file content in the format of the suffix."""
    kind = path.suffix.lower()
    if kind in CAD_FORMATS:
        return read_cad(content, kind, division)
    text, encoding = decoded_text(content)
    found = read_gltf(text, path) if kind in (".glb", ".gltf") else _READERS[kind](text)
    if encoding is None or found.origin is None:
        return found
    return found._replace(origin=EncodedMeshOrigin(found.origin, encoding))


_Key = TypeVar("_Key")

_HEAD = 4096  # bytes searched at the start and the end of a file
_SHOWN = 40  # maximum number of characters quoted from a text
# Patterns at the start of files in readable formats: OBJ last, as other formats may have such lines, too.
_OPENED = {
    suffix: formats[suffix].opening for formats in (MESH_FORMATS, CAD_FORMATS) for suffix in reversed(formats)
}
_COMPRESSED = {
    "gzip": rb"\x1f\x8b",
    "ZIP": rb"PK\x03\x04",
    "Zstandard": rb"\x28\xb5\x2f\xfd",
    "bzip2": rb"BZh\d1AY&SY",
    "xz": rb"\xfd7zXZ\x00",
    "7z": rb"7z\xbc\xaf\x27\x1c",
    "RAR": rb"Rar!\x1a\x07",
    "LZ4": rb"\x04\x22\x4d\x18",
    "tar": rb".{257}ustar",
}
_KEPT_ELSEWHERE = {
    ("Git LFS", "git lfs pull"): rb"version https://git-lfs\.github\.com/",
    ("git-annex", "git annex get"): rb"\s*(?:\.\./)*(?:\.git)?/?annex/objects/",
}
_WEB_PAGE = rb"(?i)\s*(?:<\?[^>]*>\s*)?(?:<!--[^>]*>\s*)*<(?:!doctype\s+html|html|head|body)\b"
_OTHERS = {
    "FBX": rb"Kaydara FBX Binary|\s*; FBX",
    "DXF": rb"(?:\s*999[ \t]*\r?\n[^\n]*\n)*\s*0\s+SECTION\b|AutoCAD Binary DXF",
    "DWG": rb"AC10\d\d",
    "Blender": rb"BLENDER[-_]",
    "Rhino 3DM": rb"3D Geometry File Format",
    "3DS": rb"MM.{4}\x02\x00",
    "COLLADA": XML_PROLOG + rb"COLLADA\b",
    "X3D": XML_PROLOG + rb"X3D\b|#X3D",
    "AMF": XML_PROLOG + rb"(?i:amf)\b",
    "VRML": rb"#VRML",
    "USD": rb"#usda|PXR-USDC",
    "Gmsh": rb"\$MeshFormat",
    "JT": rb"Version \d+\.\d+ JT",
    "Parasolid": rb"\*\*ABCDEFGHIJ",
    "Draco": rb"DRACO",
    "Alembic": rb"Ogawa",
    "HDF5": rb"\x89HDF\r\n",
    "PCD": rb"# \.PCD",
    "LAS": rb"LASF",
    "NumPy": rb"\x93NUMPY",
    "OLE": rb"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
    "SVG": XML_PROLOG + rb"svg\b",
    "PNG": rb"\x89PNG\r\n",
    "JPEG": rb"\xff\xd8\xff",
    "GIF": rb"GIF8[79]a",
    "WebP": rb"RIFF.{4}WEBP",
    "TIFF": rb"II\*\x00|MM\x00\*",
    "BMP": rb"BM.{4}\x00{4}",
    "PDF": rb"%PDF-",
    "PostScript": rb"%!PS",
    "RTF": rb"\{\\rtf",
}


def recognized_suffix(content: bytes) -> str | None:
    """Suffix of the mesh format of ``content``, by its beginning; None if unknown."""
    return ".stl" if stl.is_binary_stl(content) else _first(content, _OPENED)


def other_format_message(content: bytes, path: Path) -> str | None:
    """Error sentence for content in a known format other than the suffix; else None.

    Parameters
    ----------
    content : bytes
        Text in UTF-8.
    """
    suffix, name = path.suffix.lower(), path.name
    if _begins(content, _WEB_PAGE):
        return tr("{name} holds a web page and no mesh; download the mesh itself.").format(name=name)
    kept = _first(content, _KEPT_ELSEWHERE)
    if kept:
        said = tr("{name} only points to a mesh that {program} keeps elsewhere; get it with “{command}”.")
        return said.format(name=name, program=kept[0], command=kept[1])
    own = recognized_suffix(content)
    if own:
        said = tr("The content of {name} is {format}; rename it to end in {suffix}.")
        is_own = _format_of(own) == _format_of(suffix)
        return None if is_own else said.format(name=name, format=own[1:].upper(), suffix=own)
    packed = _first(content, _COMPRESSED)
    if packed:
        said = tr("{name} is compressed ({format}); unpack it first.")
        return None if (packed, suffix) == ("ZIP", ".3mf") else said.format(name=name, format=packed)
    other = _first(content, _OTHERS)
    if other:
        said = tr(
            "The content of {name} is {format}, which cannot be opened; export the mesh as OBJ, PLY or STL."
        )
        return said.format(name=name, format=other)
    return None


def _format_of(suffix: str) -> MeshFormat | None:
    return MESH_FORMATS.get(suffix) or CAD_FORMATS.get(suffix)


def no_vertices_message(content: bytes, path: Path) -> str:
    """Error sentence for a file without vertices, possibly in another format."""
    known = other_format_message(content, path)
    text = content[:_SHOWN].decode(errors="replace").split("\n", 1)[0].strip()
    if known is None and text and text.isprintable():
        return tr("{name} has no vertices; it begins with “{text}”.").format(name=path.name, text=text)
    return known or tr("{name} has no vertices; export the mesh again.").format(name=path.name)


def _first(content: bytes, patterns: Mapping[_Key, bytes]) -> _Key | None:
    return next((what for what, pattern in patterns.items() if _begins(content, pattern)), None)


def _begins(content: bytes, pattern: bytes) -> bool:
    ends = content[:_HEAD] + content[max(_HEAD, len(content) - _HEAD) :]  # a ZIP archive lists its files last
    return bool(re.match(pattern, ends, re.DOTALL))
