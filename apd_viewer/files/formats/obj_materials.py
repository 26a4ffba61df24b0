"""Materials of an OBJ file: which image its triangles show."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

import numpy as np

from apd_viewer.files.formats.obj_faces import ObjFaces
from apd_viewer.files.formats.text import decoded_text, with_line_feeds
from apd_viewer.files.storage.sibling_files import sibling_content

_LIBRARY = re.compile(rb"\n[ \t]*mtllib[ \t]+([^\n#]+)")
_USED = re.compile(rb"\n[ \t]*usemtl[ \t]+([^\n#]+)")
_FACE = re.compile(rb"\n[ \t]*f[ \t]")
_NEW = re.compile(rb"\n[ \t]*newmtl[ \t]+([^\n#]+)")
_IMAGE = re.compile(rb"\n[ \t]*map_Kd[ \t]+([^\n#]+)", re.IGNORECASE)
_OPTION = re.compile(r"-(?:s|o|t)(?:\s+[-+.\deE]+){1,3}\s+|-mm(?:\s+\S+){2}\s+|-\w+\s+\S+\s+")


def material_images(text: bytes, mesh: Path, faces: ObjFaces) -> tuple[list[str], np.ndarray]:
    """Images of the materials, and the one of each polygon, (p,); -1 is none.

    The images are named relative to the folder of ``mesh``; raises InputError if a material file is outside.
    """
    named = _named_images(text, mesh)
    paths = sorted(set(named.values()))
    uses = list(_USED.finditer(text))
    start = np.array([match.start() for match in uses], dtype=np.int64)
    image = [paths.index(named[name]) if (name := _name(use)) in named else -1 for use in uses]
    begins = np.array([match.start() for match in _FACE.finditer(text)], dtype=np.int64)
    count = len(faces.polygons.start) - 1
    if len(begins) != count:
        return [], np.full(count, -1)
    return paths, np.array([-1, *image])[np.searchsorted(start, begins)]


def _named_images(text: bytes, mesh: Path) -> dict[str, str]:
    """Image of each material, by its name."""
    named = {}
    for library in dict.fromkeys(map(_decoded, _LIBRARY.findall(text))):
        content = sibling_content(library, mesh)
        if content is None:
            continue
        said = b"\n" + with_line_feeds(decoded_text(content)[0])
        folder = posixpath.dirname(library.replace("\\", "/"))
        begins = [*_NEW.finditer(said)]
        for match, end in zip(begins, [*(m.start() for m in begins[1:]), len(said)], strict=True):
            found = _IMAGE.search(said, match.end() - 1, end)
            if found is not None:
                image = _OPTION.sub("", _decoded(found[1])).replace("\\", "/")
                named[_name(match)] = posixpath.join(folder, image)
    return named


def _name(match: re.Match[bytes]) -> str:
    return _decoded(match[1])


def _decoded(name: bytes) -> str:
    return name.decode("utf-8", errors="replace").strip()
