"""Wavefront OBJ: vertices and faces in file order; new coordinates in place.

Libraries split vertices at texture seams or drop some of them; a selection made for the file would
then no longer fit. What is not ``v`` or ``f`` is not read, and comes back as it was; only ``vn`` turns along.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from apd_viewer.files.formats.parsed import Parsed, turned
from apd_viewer.files.formats.polygons import Polygons
from apd_viewer.files.formats.text import Edits, numbers, plain
from apd_viewer.files.formats.vertex_colors import guessed
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_GAP = rb"(?:[ \t]|\\\r?\n)+"
# Searching for a preceding line end is much faster than for a line start.
_VECTOR = rb"\n[ \t]*%s" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)"
_POSITION, _NORMAL = (re.compile(_VECTOR % word) for word in (b"v", b"vn"))
_COLORED = re.compile(rb"\n[ \t]*v" + 3 * (_GAP + rb"\S+") + 3 * (_GAP + rb"([^\s#]+)"))
_ANY_POSITION = re.compile(rb"\n[ \t]*v[ \t\r\n\\]")
_FACE = re.compile(rb"\nf[ \t]([^\n]*)")
_FACE_BEGINS = re.compile(rb"\n[ \t]*f[ \t]")
_CORNER, _NUMBER = re.compile(rb"\d+(?:/\d*){0,2}"), re.compile(rb"\d+")
_EXTRAS = (
    (tr("texture coordinates"), rb"vt"),
    (tr("normals"), rb"vn"),
    (tr("materials"), rb"usemtl"),
    (tr("groups"), rb"[go]"),
    (tr("smoothing groups"), rb"s"),
    (tr("lines"), rb"l"),
)


@dataclass(frozen=True)
class ObjFile:
    """The content of an OBJ file."""

    content: bytes
    suffix = ".obj"

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        has = [name for name, word in _EXTRAS if re.search(rb"^[ \t]*%s[ \t]" % word, self.content, re.M)]
        colours = re.search(rb"^[ \t]*v(?:[ \t]+[^\s#]+){6}", self.content, re.MULTILINE)
        return (*has, *([tr("vertex colours")] if colours else []))

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours, (n, 3) uint8, if each vertex has one."""
        text = _lines(self.content)
        first = _ANY_POSITION.search(text)
        if first is None or not _COLORED.match(text, first.start()):
            return None
        words = _COLORED.findall(text)
        if len(words) != len(_ANY_POSITION.findall(text)):
            return None
        return guessed(numbers([word for row in words for word in row]).reshape(-1, 3))

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and turned normals."""
        text, edits = _lines(self.content), Edits(self.content)
        edits.numbers(_spans(_POSITION, text), mesh.V.ravel(), U.ravel())
        normals = [word for words in _NORMAL.findall(text) for word in words]
        if normals:
            N = numbers(normals).reshape(-1, 3)
            corners = list(_corners(text))
            polygons = Polygons.of([face for face, _ in corners])
            own = np.array([k if k < len(N) else -1 for _, normals in corners for k in normals])
            new = turned(mesh.V, U, mesh.F, N, own[polygons.split(mesh.V)])
            edits.numbers(_spans(_NORMAL, text), N.ravel(), new.ravel())
        return edits.done()


def _lines(content: bytes) -> bytes:
    """Content framed by line ends."""
    return b"\n%s\n" % plain(content)


def _spans(pattern: re.Pattern[bytes], text: bytes) -> Iterator[tuple[int, int]]:
    """Spans of the numbers in the content after its first line end."""
    for match in pattern.finditer(text):
        yield from ((match.start(k) - 1, match.end(k) - 1) for k in (1, 2, 3))


def read_obj(content: bytes) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of an OBJ file; polygons become triangles.

    Raises
    ------
    ValueError
        If a ``v`` or ``f`` line cannot be understood; the message says which.
    """
    text = _lines(content)
    words = _POSITION.findall(text)
    if len(words) != len(_ANY_POSITION.findall(text)):
        raise ValueError(tr("a vertex has fewer than three coordinates"))
    try:
        V = np.fromiter(map(float, chain.from_iterable(words)), np.float64, 3 * len(words)).reshape(-1, 3)
    except ValueError as error:
        raise ValueError(_not_understood(text)) from error
    alike = _faces_alike(text)
    polygons = Polygons.of([face for face, _ in _corners(text)]) if alike is None else Polygons.alike(alike)
    return Parsed(V, polygons.triangles(V), ObjFile(content))


def _not_understood(text: bytes) -> str:
    """Error sentence for the first vertex with a malformed number."""
    for match in _POSITION.finditer(text):
        try:
            [float(word) for word in match.groups()]
        except ValueError:
            break
    line = text.count(b"\n", 0, match.start() + 1)
    return tr("line {line} is not valid: {text}").format(
        line=line, text=match[0].strip().decode(errors="replace")[:60]
    )


def _faces_alike(text: bytes) -> np.ndarray | None:
    """Vertices (p, k) of all faces from 0 if written alike, else None."""
    face = None if b"\\\n" in text or b"\\\r\n" in text else _FACE.search(text)
    corners = face[1].split() if face else []
    if not corners or not _CORNER.fullmatch(corners[0]):
        return None
    alike = rb"\nf" + (rb"[ \t]+" + _NUMBER.sub(rb"\\d+", corners[0])) * len(corners) + rb"(?=[ \t]*\r?\n)"
    faces = re.findall(alike, text)
    if len(faces) != len(_FACE_BEGINS.findall(text)):
        return None
    joined = b"".join(faces).replace(b"/", b" ").replace(b"\nf", b"")
    values = len(_NUMBER.findall(corners[0]))
    # Overflowing numbers become the largest one, and no file has that many vertices.
    return np.fromstring(joined, np.int64, sep=" ")[::values].reshape(-1, len(corners)) - 1


def _corners(text: bytes) -> Iterator[tuple[list[int], list[int]]]:
    """Vertices and normals from 0 of all face corners; -1 for missing ones."""
    positions = normals = 0
    for number, line in _statements(text[1:].decode("utf-8", errors="replace")):
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
                raise ValueError(
                    tr("line {line} is not valid: {text}").format(line=number, text=line[:60])
                ) from error
            yield corners, own


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Statements with their line numbers: continued lines joined, no comments."""
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
    """Index from 0 of a word such as ``7``, or ``-1`` from the end."""
    number = int(word)
    return number - 1 if number > 0 else count + number if number < 0 else -1
