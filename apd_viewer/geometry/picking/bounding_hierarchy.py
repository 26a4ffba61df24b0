"""Bounding volume hierarchy of the triangles of a shape."""

from typing import NamedTuple

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel

BRANCHING = 8  # triangles per box, and boxes per larger box
BRANCHING_BITS = 3  # log2 of BRANCHING
_SLACK = 1e-8  # relative enlargement of a box, so that rounding does not let a ray miss its triangles

# log2 of the number of sorting cells along the longest side of the mesh.
_CELL_BITS = 10


_HALF_KEY = 3 * _CELL_BITS // 2


class BoundingVolumeHierarchy(NamedTuple):
    """Bounding box hierarchy of the triangles of a shape.

    Attributes
    ----------
    F : (m, 3) int array
        The triangles, neighbours in space next to each other.
    corners : (b, 2, 3) float array
        Low and high corner of the boxes around every ``BRANCHING`` triangles, then around every ``BRANCHING``
        of these, and so on up to one around all.
    level : (l + 1,) int array
        Where the boxes of each size begin.
    """

    F: np.ndarray
    corners: np.ndarray
    level: np.ndarray


def bounding_hierarchy(U: np.ndarray, F: np.ndarray) -> BoundingVolumeHierarchy:
    """Bounding volume hierarchy of ``F`` (m, 3) at ``U`` (n, 3)."""
    sizes = [(len(F) + BRANCHING - 1) // BRANCHING]
    while sizes[-1] > 1:
        sizes.append((sizes[-1] + BRANCHING - 1) // BRANCHING)
    level = np.cumsum([0, *sizes])
    with cores_for(len(U)):
        T = _sorted_triangles(F, _morton_keys(U, F))
        corners = np.empty((level[-1], 2, 3))
        _write_triangle_boxes(U, T, _SLACK * np.abs(U).max(initial=0.0), corners[: level[1]])
    for i in range(1, len(sizes)):
        _write_outer_boxes(corners[level[i - 1] : level[i]], corners[level[i] : level[i + 1]])
    return BoundingVolumeHierarchy(T, corners, level)


@parallel()
def _morton_keys(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Sort key of each triangle along a space-filling curve."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for t in range(len(F)):
        for c in range(3):
            low[c], high[c] = min(low[c], U[F[t, 0], c]), max(high[c], U[F[t, 0], c])
    size = max((high - low).max(), 1e-290)
    scale, last = ((1 << _CELL_BITS) - 1) / size, (1 << _CELL_BITS) - 1
    key = np.empty(len(F), dtype=np.int32)
    for t in prange(len(F)):
        found = 0
        for c in range(3):
            middle = (U[F[t, 0], c] + U[F[t, 1], c] + U[F[t, 2], c]) / 3.0
            found |= _spread_bits(min(max(int((middle - low[c]) * scale), 0), last)) << c
        key[t] = found
    return key


@njit(inline="always")
def _spread_bits(x: int) -> int:
    """Ten bits, each followed by two zero bits [Morton 1966]."""
    x = (x | (x << 16)) & 0x030000FF
    x = (x | (x << 8)) & 0x0300F00F
    x = (x | (x << 4)) & 0x030C30C3
    return (x | (x << 2)) & 0x09249249


@njit(cache=True, nogil=True)
def _sorted_triangles(F: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Triangles sorted stably by ``key`` (m,)."""
    order, lower = np.arange(len(F)).astype(np.int32), (1 << _HALF_KEY) - 1
    for half in range(2):
        start = np.zeros((1 << _HALF_KEY) + 1, dtype=np.int64)
        for k in key:
            start[((k >> (half * _HALF_KEY)) & lower) + 1] += 1
        start = np.cumsum(start)
        after = np.empty_like(order)
        for t in order:
            k = (key[t] >> (half * _HALF_KEY)) & lower
            after[start[k]] = t
            start[k] += 1
        order = after
    return F[order]


@parallel()
def _write_triangle_boxes(U: np.ndarray, F: np.ndarray, slack: float, corners: np.ndarray) -> None:
    """Write boxes (b, 2, 3) around ``BRANCHING`` triangles each, with some ``slack``."""
    for b in prange(len(corners)):
        for c in range(3):
            low, high = np.inf, -np.inf
            for t in range(BRANCHING * b, min(BRANCHING * (b + 1), len(F))):
                for d in range(3):
                    low, high = min(low, U[F[t, d], c]), max(high, U[F[t, d], c])
            corners[b, 0, c], corners[b, 1, c] = low - slack, high + slack


@njit(cache=True, nogil=True)
def _write_outer_boxes(inner: np.ndarray, outer: np.ndarray) -> None:
    """Write the ``outer`` boxes (b, 2, 3) around each group of ``inner`` boxes."""
    for b in range(len(outer)):
        for c in range(3):
            low, high = np.inf, -np.inf
            for k in range(BRANCHING * b, min(BRANCHING * (b + 1), len(inner))):
                low, high = min(low, inner[k, 0, c]), max(high, inner[k, 1, c])
            outer[b, 0, c], outer[b, 1, c] = low, high
