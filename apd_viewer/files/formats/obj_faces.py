"""Faces of an OBJ file: vertices and normals of their corners."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.polygons import Polygons
from apd_viewer.language import tr

_FACE = re.compile(rb"\nf[ \t]([^\n]*)")
_FACE_BEGINS = re.compile(rb"\n[ \t]*f[ \t]")
_CORNER, _NUMBER = re.compile(rb"\d+(?:/\d*){0,2}"), re.compile(rb"\d+")
_BEYOND = 1 << 62  # index of no normal


class ObjFaces(NamedTuple):
    """Polygons, with the normals and texture coordinates (c,) of their corners.

    Numbers from 0; -1 for missing ones.
    """

    polygons: Polygons
    normal: np.ndarray
    texture: np.ndarray


def parse_faces(text: bytes) -> ObjFaces:
    """Faces of a text framed by line ends.

    Raises
    ------
    ValueError
        If an ``f`` line cannot be understood; the message says which.
    """
    alike = _faces_alike(text)
    if alike is not None:
        return alike
    corners = list(_corners(text))
    normal, texture = (
        np.array([min(max(k, -1), _BEYOND) for face in corners for k in face[at]], dtype=np.int64)
        for at in (1, 2)
    )
    return ObjFaces(Polygons.from_faces([face[0] for face in corners]), normal, texture)


def _faces_alike(text: bytes) -> ObjFaces | None:
    """Faces written alike, much faster; else None."""
    face = None if b"\\\n" in text or b"\\\r\n" in text else _FACE.search(text)
    corners = face[1].split() if face else []
    if not corners or not _CORNER.fullmatch(corners[0]):
        return None
    alike = rb"\nf" + (rb"[ \t]+" + _NUMBER.sub(rb"\\d+", corners[0])) * len(corners) + rb"(?=[ \t]*\r?\n)"
    faces = re.findall(alike, text)
    if len(faces) != len(_FACE_BEGINS.findall(text)):
        return None
    joined = b"".join(faces).replace(b"/", b" ").replace(b"\nf", b"")
    # Overflowing numbers become the largest one, and no file has that many vertices.
    values = np.fromstring(joined, np.int64, sep=" ").reshape(-1, len(_NUMBER.findall(corners[0]))) - 1
    words, none = corners[0].split(b"/"), np.full(len(values), -1)
    normal = values[:, -1] if len(words) == 3 and words[2] else none
    texture = values[:, 1] if len(words) > 1 and words[1] else none
    return ObjFaces(Polygons.from_array(values[:, 0].reshape(-1, len(corners))), normal, texture)


def _corners(text: bytes) -> Iterator[tuple[list[int], list[int], list[int]]]:
    """Vertices, normals and texture coordinates of each face, from 0; -1 is none."""
    counts = {"v": 0, "vn": 0, "vt": 0}
    for number, line in _statements(text[1:].decode("utf-8", errors="replace")):
        kind, _, rest = line.partition(" ")
        if kind in counts:
            counts[kind] += 1
        elif kind == "f":
            try:
                words = [word.split("/") for word in rest.split()]
                corners = [_index(word[0], counts["v"]) for word in words]
                normals = [_index(word[2], counts["vn"]) if word[2:] and word[2] else -1 for word in words]
                texture = [_index(word[1], counts["vt"]) if word[1:] and word[1] else -1 for word in words]
            except ValueError as error:
                raise ValueError(
                    tr("line {line} is not valid: {text}").format(line=number, text=line[:60])
                ) from error
            yield corners, normals, texture


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
