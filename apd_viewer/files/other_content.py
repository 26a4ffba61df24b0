"""Content of files with the name of another format."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeVar

from apd_viewer.files.formats.stl import is_binary_stl
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_Key = TypeVar("_Key")

_HEAD = 4096  # bytes in which a file says what it is
_SHOWN = 40  # characters quoted from a text
_XML = rb"\s*(?:<[?!][^>]*>\s*)*<"  # up to the name of the first element
_NUMBER = rb"[ \t]+[-+.\d]\S*"

# Patterns of the beginning. Formats that can be opened, by their suffixes:
_OPENED = {
    ".glb": rb"glTF",
    ".gltf": rb'\s*\{.*"asset"\s*:',
    ".3mf": rb"PK\x03\x04.*3D/",
    ".ply": rb"ply\s",
    ".off": rb"(?:ST)?C?N?4?n?OFF(?:\s|\d)",
    ".vtk": rb"# vtk DataFile",
    ".vtp": _XML + rb'VTKFile\s[^>]*type="PolyData"',
    ".vtu": _XML + rb'VTKFile\s[^>]*type="UnstructuredGrid"',
    ".stl": rb"(?i)\s*solid\b.*\bfacet\s+normal",
    ".obj": rb"(?:[^\x00]*\n)?[ \t]*v" + 3 * _NUMBER + rb"[^\n]*\n",
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
    "STEP": rb"\s*ISO-10303-21",
    "IGES": rb"[^\r\n]{72}S[ 0]{6}1",
    "DXF": rb"(?:\s*999[ \t]*\r?\n[^\n]*\n)*\s*0\s+SECTION\b|AutoCAD Binary DXF",
    "DWG": rb"AC10\d\d",
    "Blender": rb"BLENDER[-_]",
    "Rhino 3DM": rb"3D Geometry File Format",
    "3DS": rb"MM.{4}\x02\x00",
    "COLLADA": _XML + rb"COLLADA\b",
    "X3D": _XML + rb"X3D\b|#X3D",
    "AMF": _XML + rb"(?i:amf)\b",
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
    "SVG": _XML + rb"svg\b",
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


def other_format_message(content: bytes, path: Path) -> str | None:
    """Sentence about a file of another format than its name says, if it is known.

    Parameters
    ----------
    content : bytes
        Text in UTF-8.
    path : Path
    """
    suffix, name = path.suffix.lower(), path.name
    if _begins(content, _WEB_PAGE):
        return tr("{name} holds a web page and no mesh; download the mesh itself.").format(name=name)
    kept = _first(content, _KEPT_ELSEWHERE)
    if kept:
        said = tr("{name} only points to a mesh that {program} keeps elsewhere; get it with “{command}”.")
        return said.format(name=name, program=kept[0], command=kept[1])
    own = ".stl" if is_binary_stl(content) else _first(content, _OPENED)
    if own:
        said = tr("The content of {name} is {format}; rename it to end in {suffix}.")
        return None if own == suffix else said.format(name=name, format=own[1:].upper(), suffix=own)
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


def no_vertices_message(content: bytes, path: Path) -> str:
    """Sentence about a file without a vertex; it may be anything."""
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
