"""STL, text or binary: three vertices a triangle; new coordinates in place."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from apd_viewer.files.formats.parsed import Parsed
from apd_viewer.files.formats.text import Edits, numbers, plain
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_HEAD = 84  # bytes before the first facet of a binary file; the last four are the number of facets
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_LINE = rb"(?im)^[ \t]*"  # a solid may have any word as its name
_VERTEX = re.compile(_LINE + rb"vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")
_NORMAL = re.compile(_LINE + rb"facet[ \t]+normal[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")
_FACETS, _VERTICES = (re.compile(_LINE + word + rb"\b") for word in (b"facet", b"vertex"))


@dataclass(frozen=True)
class StlFile:
    """The content of an STL file."""

    content: bytes
    is_binary: bool
    suffix = ".stl"

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        facets = np.frombuffer(self.content, _FACET, offset=_HEAD) if self.is_binary else None
        return (tr("facet attributes"),) if facets is not None and facets["attribute"].any() else ()

    @property
    def colors(self) -> None:
        """Vertex colours, not part of the format."""
        return

    def normals(self, _: Mesh) -> None:
        """None: those of the faces follow from the positions."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (3 m, 3) and updated normals."""
        moved = (mesh.V != U).any(axis=1).reshape(-1, 3).any(axis=1)
        if self.is_binary:
            body = bytearray(self.content)
            facets = np.frombuffer(body, _FACET, offset=_HEAD)
            corners = U.reshape(-1, 3, 3)
            facets["corners"][moved] = corners[moved]
            had = moved & facets["normal"].any(axis=1)
            # From the corners as written.
            facets["normal"][had] = _normals(facets["corners"][had].astype(np.float64))
            return bytes(body)
        text, edits = plain(self.content), Edits(self.content)
        edits.numbers(_spans(_VERTEX, text), mesh.V.ravel(), U.ravel())
        old = _numbers(_NORMAL, text)
        if len(old) == len(moved):
            new, had = old.copy(), moved & old.any(axis=1)
            new[had] = _normals(U.reshape(-1, 3, 3)[had])
            edits.numbers(_spans(_NORMAL, text), old.ravel(), new.ravel())
        return edits.done()


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normals of triangles (k, 3, 3); zero without an area."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, size, out=np.zeros_like(across), where=size > 0.0)


def _spans(pattern: re.Pattern[bytes], content: bytes) -> list[tuple[int, int]]:
    return [match.span(k) for match in pattern.finditer(content) for k in (1, 2, 3)]


def _numbers(pattern: re.Pattern[bytes], content: bytes) -> np.ndarray:
    return numbers([word for words in pattern.findall(content) for word in words]).reshape(-1, 3)


def read_stl(content: bytes) -> Parsed:
    """Positions (3 m, 3) and triangles (m, 3) of all solids in an STL file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    # Some binary files begin with "solid" too, but only a binary one has this length.
    m = int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    is_binary = len(content) >= _HEAD and len(content) == _HEAD + m * _FACET.itemsize
    if is_binary:
        V = np.empty((3 * m, 3))
        with np.errstate(invalid="ignore"):  # NaN is refused later
            V.reshape(-1, 3, 3)[...] = np.frombuffer(content, _FACET, offset=_HEAD)["corners"]
    else:
        V = _text(plain(content))
    return Parsed(V, np.arange(len(V)).reshape(-1, 3), StlFile(content, is_binary))


def _text(content: bytes) -> np.ndarray:
    words = content.split(None, 1)
    last = content.rstrip().rpartition(b"\n")[2].split(None, 1)
    if not words or words[0].lower() != b"solid" or not last or last[0].lower() != b"endsolid":
        raise ValueError(tr("it has no solid ... endsolid, and its size is not that of a binary STL file"))
    V = _numbers(_VERTEX, content)
    if len(V) != 3 * len(_FACETS.findall(content)) or len(V) != len(_VERTICES.findall(content)):
        raise ValueError(tr("a facet is incomplete"))
    return V
