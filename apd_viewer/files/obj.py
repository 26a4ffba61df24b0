"""Vertices and faces of Wavefront OBJ, in the order of the file.

Libraries split vertices at texture seams or drop some of them; a selection made for the file would
then no longer fit. Only ``v`` and ``f`` are read here; polygons become fans of triangles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.polygons import fans

if TYPE_CHECKING:
    from collections.abc import Iterator


def read_obj(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and triangles (m, 3) of an OBJ file.

    Raises
    ------
    ValueError
        If a ``v`` or ``f`` line cannot be understood; the message names the line.
    """
    positions: list[list[float]] = []
    polygons: list[list[int]] = []
    for number, line in _statements(text):
        kind, _, rest = line.partition(" ")
        try:
            if kind == "v":
                positions.append([float(word) for word in rest.split()[:3]])
            elif kind == "f":
                polygons.append([_vertex(word, len(positions)) for word in rest.split()])
        except ValueError as error:
            raise ValueError(f"line {number} is not understood: {line[:60]}") from error
    if any(len(p) != 3 for p in positions):
        raise ValueError("a vertex has fewer than three coordinates")
    return np.array(positions).reshape(-1, 3), fans(polygons)


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


def _vertex(word: str, count: int) -> int:
    """Index from 0 of the vertex that ``7``, ``7/1``, ``7//3`` or, backwards, ``-1`` names."""
    number = int(word.partition("/")[0])
    return number - 1 if number > 0 else count + number if number < 0 else -1
