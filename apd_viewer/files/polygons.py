"""Polygons as triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def fans(polygons: Iterable[Sequence[int]]) -> np.ndarray:
    """Triangles (m, 3) of the polygons, a fan around the first vertex of each, in their order."""
    triangles = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)
