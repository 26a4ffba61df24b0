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


class Faces(NamedTuple):
    """Polygons, and the normals (c,) of their corners from 0; -1 for missing ones."""

    polygons: Polygons
    normal: np.ndarray


def faces_of(text: bytes) -> Faces:
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
    normal = [k for _, own in corners for k in own]
    return Faces(Polygons.of([face for face, _ in corners]), np.array(normal, dtype=np.int64))


def _faces_alike(text: bytes) -> Faces | None:
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
    has_normal = len(corners[0].split(b"/")) == 3 and not corners[0].endswith(b"/")
    normal = values[:, -1] if has_normal else np.full(len(values), -1)
    return Faces(Polygons.alike(values[:, 0].reshape(-1, len(corners))), normal)


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
