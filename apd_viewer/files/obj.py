"""Wavefront OBJ: vertices and faces in the order of the file, and the same file with other coordinates.

Libraries split vertices at texture seams or drop some of them; a selection made for the file would
then no longer fit. What is not ``v`` or ``f`` is not read, and comes back as it was; only ``vn`` turns along.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from apd_viewer.files.parsed import Parsed
from apd_viewer.files.polygons import Polygons
from apd_viewer.files.text import Edits, plain
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.geometry.normals import turned_normals

_GAP = rb"(?:[ \t]|\\\r?\n)+"
_VECTOR = rb"^[ \t]*%s" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)"
_POSITION, _NORMAL = (re.compile(_VECTOR % word, re.MULTILINE) for word in (b"v", b"vn"))
_ANY_POSITION = re.compile(rb"^[ \t]*v[ \t\r\n\\]", re.MULTILINE)
_FACE_LINE = re.compile(rb"^f[ \t]([^\n]*)", re.MULTILINE)
_EXTRAS = {
    "texture coordinates": rb"vt",
    "normals": rb"vn",
    "materials": rb"usemtl",
    "groups": rb"[go]",
    "smoothing groups": rb"s",
    "lines": rb"l",
}


@dataclass(frozen=True)
class ObjFile:
    """The content of an OBJ file."""

    content: bytes
    suffix = ".obj"

    @property
    def extras(self) -> tuple[str, ...]:
        """What it holds besides positions and triangles, in words."""
        has = [
            name for name, word in _EXTRAS.items() if re.search(rb"^[ \t]*%s[ \t]" % word, self.content, re.M)
        ]
        colours = re.search(rb"^[ \t]*v(?:[ \t]+[^\s#]+){6}", self.content, re.MULTILINE)
        return (*has, *(["vertex colours"] if colours else []))

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """The file with the positions ``U`` (n, 3), and normals that have turned along."""
        text, edits = plain(self.content), Edits(self.content)
        edits.numbers(_spans(_POSITION, text), mesh.V.ravel(), U.ravel())
        normals = [match.groups() for match in _NORMAL.finditer(text)]
        if normals:
            N = np.array([[float(word) for word in words] for words in normals])
            corners = list(_corners(text))
            polygons = Polygons.of([face for face, _ in corners])
            own = np.array([k for _, normals in corners for k in normals])[polygons.split(mesh.V)]
            turned = turned_normals(mesh.V, U, mesh.F, N, np.where(own < len(N), own, -1))
            edits.numbers(_spans(_NORMAL, text), N.ravel(), turned.ravel())
        return edits.done()


def _spans(pattern: re.Pattern[bytes], text: bytes) -> Iterator[tuple[int, int]]:
    for match in pattern.finditer(text):
        yield from (match.span(1), match.span(2), match.span(3))


def read_obj(content: bytes) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of an OBJ file; polygons become triangles.

    Raises
    ------
    ValueError
        If a ``v`` or ``f`` line cannot be understood; the message says which.
    """
    text = plain(content)
    words = _POSITION.findall(text)
    if len(words) != len(_ANY_POSITION.findall(text)):
        raise ValueError("a vertex has fewer than three coordinates")
    try:
        V = np.array([float(word) for three in words for word in three]).reshape(-1, 3)
    except ValueError as error:
        raise ValueError(_not_understood(text)) from error
    alike = _faces_alike(text)
    polygons = Polygons.of([face for face, _ in _corners(text)]) if alike is None else Polygons.alike(alike)
    return Parsed(V, polygons.triangles(V), ObjFile(content))


def _not_understood(text: bytes) -> str:
    """What to say about the first vertex with a word that is no number."""
    for match in _POSITION.finditer(text):
        try:
            [float(word) for word in match.groups()]
        except ValueError:
            break
    line = text.count(b"\n", 0, match.start()) + 1
    return f"line {line} is not understood: {match[0].decode(errors='replace')[:60]}"


def _faces_alike(text: bytes) -> np.ndarray | None:
    """The vertices (p, k) of all faces from 0, if all are written alike; None if that takes a closer look."""
    if re.search(rb"\\\r?\n|^[ \t]+f[ \t]", text, re.MULTILINE):
        return None
    faces = _FACE_LINE.findall(text)
    joined = b" ; ".join(faces)
    if not faces or any(sign in joined for sign in (b"#", b"-", b".")):
        return None
    first = faces[0].split()
    k, values = len(first), len(first[0].replace(b"/", b" ").split()) if first else 0
    words = joined.replace(b"/", b" ").split()
    width = k * values + 1
    ends = words[width - 1 :: width]
    if not values or len(words) != len(faces) * width - 1 or ends.count(b";") != len(faces) - 1:
        return None
    # As many slashes in every face: 1//2 has as many numbers as 1/2.
    if joined.count(b"/") != len(faces) * faces[0].count(b"/"):
        return None
    del words[width - 1 :: width]
    return np.array([int(word) for word in words[::values]]).reshape(-1, k) - 1


def _corners(text: bytes) -> Iterator[tuple[list[int], list[int]]]:
    """Vertices and normals from 0 of the corners of every face; what is missing is -1."""
    positions = normals = 0
    for number, line in _statements(text.decode("utf-8", errors="replace")):
        kind, _, rest = line.partition(" ")
        if kind == "v":
            positions += 1
        elif kind == "vn":
            normals += 1
        elif kind == "f":
            try:
                words = [word.split("/") for word in rest.split()]
                corners = [_index(word[0], positions) for word in words]
                own = [_index(word[2], normals) if len(word) > 2 and word[2] else -1 for word in words]
            except ValueError as error:
                raise ValueError(f"line {number} is not understood: {line[:60]}") from error
            yield corners, own


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Number of the first line and text of every statement: no comments, no tabs, continued lines joined."""
    held, first = "", 0
    for number, line in enumerate(text.split("\n"), start=1):
        words = line.partition("#")[0].replace("\t", " ").strip()
        first = first if held else number
        held += words
        if held.endswith("\\"):
            held = held[:-1] + " "
        else:
            yield first, held
            held = ""
    if held:
        yield first, held


def _index(word: str, count: int) -> int:
    """Index from 0 that ``7`` or, backwards, ``-1`` names."""
    number = int(word)
    return number - 1 if number > 0 else count + number if number < 0 else -1
