"""Vertices and faces of OFF, in the order of the file."""

from __future__ import annotations

import re

import numpy as np

from apd_viewer.files.polygons import fans


def read_off(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and triangles (m, 3) of an OFF file; colours, normals and the like are left out.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    lines = [words for line in text.splitlines() if (words := line.partition("#")[0].strip())]
    head = re.fullmatch(r"(?:ST)?C?N?OFF\b(.*)", lines[0]) if lines else None
    if head is None:
        raise ValueError("it does not begin with OFF")
    lines = ([head[1]] if head[1].strip() else []) + lines[1:]
    if not lines or len(lines[0].split()) < 2:
        raise ValueError("the numbers of vertices and faces are missing")
    n, m = (int(word) for word in lines[0].split()[:2])
    if n < 0 or m < 0 or len(lines) < 1 + n + m:
        raise ValueError(f"it ends before its last face: {n:,} vertices and {m:,} faces were announced")
    positions = [[float(word) for word in line.split()[:3]] for line in lines[1 : 1 + n]]
    if any(len(p) != 3 for p in positions):
        raise ValueError("a vertex has fewer than three coordinates")
    return np.array(positions).reshape(-1, 3), fans(_polygon(line) for line in lines[1 + n : 1 + n + m])


def _polygon(line: str) -> list[int]:
    """Vertices of a face: their number, then they; a colour may follow."""
    words = line.split()
    count = int(words[0])
    if count < 0 or len(words) < 1 + count:
        raise ValueError(f"a face is not whole: {line[:60]}")
    return [int(word) for word in words[1 : 1 + count]]
