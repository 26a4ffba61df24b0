"""Result of a format reader, and normals turned with the surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.mesh import Origin
from apd_viewer.geometry.mesh.normals import turned_normals

_LONGEST = 1e30  # of a normal; the square of a longer one overflows


class Parsed(NamedTuple):
    """Positions (n, 3), triangles (m, 3) and their file, with sentences on it.

    The ``remarks`` say what is strange about the file, and what it has that was not read. The ``unit`` of
    length is the symbol of the one that the file states; without one it is empty.
    """

    V: np.ndarray
    F: np.ndarray
    origin: Origin | None
    remarks: tuple[str, ...] = ()
    unit: str = ""


def turned(V: np.ndarray, U: np.ndarray, F: np.ndarray, N: np.ndarray, normal_of: np.ndarray) -> np.ndarray:
    """Normals ``N`` turned with the surface; zero normals unchanged."""
    good = (np.abs(N) < _LONGEST).all(axis=1)
    if good.all():
        return turned_normals(V, U, F, N, normal_of)
    sane = np.where(good[:, None], N, 0.0)
    return np.where(good[:, None], turned_normals(V, U, F, sane, normal_of), N)
