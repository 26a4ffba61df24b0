"""Vertices and faces of Wavefront OBJ, in the order of the file.

Libraries split vertices at texture seams or drop some of them; a selection made for the file would
then no longer fit. Only ``v`` and ``f`` are read here; polygons become fans of triangles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable


def read_obj(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and triangles (m, 3) of an OBJ file.

    Raises
    ------
    ValueError
        If a ``v`` or ``f`` line cannot be understood; the message names the line.
    """
    positions: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for number, line in enumerate(_joined(text.splitlines()), start=1):
        kind, _, rest = line.partition(" ")
        try:
            if kind == "v":
                positions.append([float(word) for word in rest.split()[:3]])
            elif kind == "f":
                ids = [_vertex(word, len(positions)) for word in rest.split()]
                triangles += [(ids[0], ids[k], ids[k + 1]) for k in range(1, len(ids) - 1)]
        except ValueError as error:
            raise ValueError(f"line {number} is not understood: {line[:60]}") from error
    if any(len(p) != 3 for p in positions):
        raise ValueError("a vertex has fewer than three coordinates")
    return np.array(positions).reshape(-1, 3), np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _joined(lines: Iterable[str]) -> Iterable[str]:
    """Lines with tabs as spaces and a trailing backslash joined to the next line."""
    held = ""
    for line in lines:
        line = held + line.replace("\t", " ").strip()
        held = line[:-1] + " " if line.endswith("\\") else ""
        if not held:
            yield line


def _vertex(word: str, count: int) -> int:
    """Index from 0 of the vertex that ``7``, ``7/1``, ``7//3`` or, backwards, ``-1`` names."""
    number = int(word.partition("/")[0])
    return number - 1 if number > 0 else count + number if number < 0 else -1
