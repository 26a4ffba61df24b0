"""Triangles of STL, text or binary: three vertices of their own each, in the order of the file."""

from __future__ import annotations

import numpy as np

_HEAD = 84  # bytes before the first facet of a binary file; the last four are the number of facets
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(content: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Positions (3 m, 3) and triangles (m, 3) of an STL file; several solids stand one after the other.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    # Some binary files begin with "solid" too; their length cannot lie.
    m = int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    if len(content) >= _HEAD and len(content) == _HEAD + m * _FACET.itemsize:
        V = np.frombuffer(content, _FACET, offset=_HEAD)["corners"].reshape(-1, 3).astype(np.float64)
    else:
        V = _text(content.decode("utf-8", errors="replace"))
    return V, np.arange(len(V)).reshape(-1, 3)


def _text(text: str) -> np.ndarray:
    lines = [line.split() for line in text.lower().splitlines() if line.strip()]
    if not lines or lines[0][0] != "solid" or lines[-1][0] != "endsolid":
        raise ValueError("it does not go from solid to endsolid, and its length is not that of a binary file")
    corners = [words[1:] for words in lines if words[0] == "vertex"]
    if len(corners) % 3 or any(len(corner) != 3 for corner in corners):
        raise ValueError("a facet is not whole")
    return np.array([[float(word) for word in corner] for corner in corners]).reshape(-1, 3)
