"""Visibility of vertices from a viewpoint, by a bounding volume hierarchy.

One ray is answered faster by a look at every triangle: see :mod:`picking`. For a ray to
each of many vertices it is worth sorting the triangles first; then their order in a file does not matter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from apd_viewer.geometry.linalg.threads import cores_for, parallel

FAN = 8  # triangles in a box, boxes in a larger box
_BITS = 3  # of FAN
# Cells along the longest side of the mesh by which triangles are sorted, as a power of two.
_CELL_BITS = 10
_HALF_KEY = 3 * _CELL_BITS // 2
# Rounding must not let a ray miss the box of a triangle that it meets, or pass between two neighbours.
_SLACK, _EDGE = 1e-8, 1e-9
# So near to a vertex, against its distance from the eye, nothing hides it.
TOUCHING = 1e-6
# A triangle is seen edge-on, and hides nothing, if it fills so little of the view.
_EDGE_ON = 1e-12


class Boxes(NamedTuple):
    """Boxes in boxes around the triangles of one shape.

    Attributes
    ----------
    F : (m, 3) int array
        The triangles, neighbours in space next to each other.
    corners : (b, 2, 3) float array
        Low and high corner of the boxes around every ``FAN`` triangles, then around every ``FAN`` of these,
        and so on up to one around all.
    level : (l + 1,) int array
        Where the boxes of each size begin.
    """

    F: np.ndarray
    corners: np.ndarray
    level: np.ndarray


def boxes_in_boxes(U: np.ndarray, F: np.ndarray) -> Boxes:
    """Bounding volume hierarchy of ``F`` (m, 3) at ``U`` (n, 3)."""
    sizes = [(len(F) + FAN - 1) // FAN]
    while sizes[-1] > 1:
        sizes.append((sizes[-1] + FAN - 1) // FAN)
    level = np.cumsum([0, *sizes])
    with cores_for(len(U)):
        T = _in_order(F, _cells(U, F))
        corners = np.empty((level[-1], 2, 3))
        _around_triangles(U, T, _SLACK * np.abs(U).max(initial=0.0), corners[: level[1]])
    for i in range(1, len(sizes)):
        _around_boxes(corners[level[i - 1] : level[i]], corners[level[i] : level[i + 1]])
    return Boxes(T, corners, level)


def visible(eye: np.ndarray, U: np.ndarray, boxes: Boxes, ids: np.ndarray) -> np.ndarray:
    """Mask of the vertices visible from a point.

    One is seen if no triangle that it is not a corner of meets the straight line to it. A triangle nearer to
    it than 1e-6 of its distance from the eye does not hide it, nor does one that is seen exactly edge-on.

    Parameters
    ----------
    eye : (3,) float array
    U : (n, 3) float array
    boxes : Boxes
        The :func:`boxes_in_boxes` of the same ``U``.
    ids : (k,) int array
        The vertices, by the names that the triangles have for them.

    Returns
    -------
    (k,) bool array
    """
    eye = np.ascontiguousarray(eye, dtype=np.float64)
    seen = np.empty(len(ids), dtype=bool)
    with cores_for(len(U)):
        _see(eye, U, np.asarray(ids, dtype=np.int64), boxes.F, boxes.corners, boxes.level, seen)
    return seen


@parallel()
def _see(
    eye: np.ndarray,
    U: np.ndarray,
    ids: np.ndarray,
    F: np.ndarray,
    corners: np.ndarray,
    level: np.ndarray,
    seen: np.ndarray,
) -> None:
    ox, oy, oz = eye[0], eye[1], eye[2]
    count, top = level[1], len(level) - 2
    for i in prange(len(ids)):
        v = ids[i]
        dx, dy, dz = U[v, 0] - ox, U[v, 1] - oy, U[v, 2] - oz
        ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
        # Boxes are walked through without a stack: behind a box comes the largest that begins there.
        b, size, hidden = 0, top, False
        while b < count and not hidden:
            k = level[size] + (b >> (_BITS * size))
            ax, bx = (corners[k, 0, 0] - ox) * ix, (corners[k, 1, 0] - ox) * ix
            ay, by = (corners[k, 0, 1] - oy) * iy, (corners[k, 1, 1] - oy) * iy
            az, bz = (corners[k, 0, 2] - oz) * iz, (corners[k, 1, 2] - oz) * iz
            near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0))
            far = min(min(max(ax, bx), max(ay, by)), min(max(az, bz), 1.0))
            if near <= far and size > 0:
                size -= 1
                continue
            if near <= far:
                for t in range(FAN * b, min(FAN * (b + 1), len(F))):
                    if F[t, 0] != v and F[t, 1] != v and F[t, 2] != v:
                        hidden |= _hides(ox, oy, oz, dx, dy, dz, U, F[t, 0], F[t, 1], F[t, 2])
            b = ((b >> (_BITS * size)) + 1) << (_BITS * size)
            while size < top and b & ((1 << (_BITS * (size + 1))) - 1) == 0:
                size += 1
        seen[i] = not hidden


@njit(inline="always")
def _inverse(d: float) -> float:
    """1 / ``d``, or of zero something huge: infinity times zero would be no number."""
    return 1.0 / d if abs(d) > 1e-290 else 1e290


@njit(inline="always")
def _hides(
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    U: np.ndarray,
    i: int,
    j: int,
    k: int,
) -> bool:
    """True if a triangle blocks the segment from ``o`` along ``d``."""
    ex, ey, ez = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
    gx, gy, gz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
    px, py, pz = dy * gz - dz * gy, dz * gx - dx * gz, dx * gy - dy * gx
    det = ex * px + ey * py + ez * pz
    size = (ex * ex + ey * ey + ez * ez) * (gx * gx + gy * gy + gz * gz) * (dx * dx + dy * dy + dz * dz)
    if det * det <= _EDGE_ON**2 * size:
        return False
    sx, sy, sz = ox - U[i, 0], oy - U[i, 1], oz - U[i, 2]
    u = (sx * px + sy * py + sz * pz) / det
    if u < -_EDGE or u > 1.0 + _EDGE:
        return False
    qx, qy, qz = sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex
    v = (dx * qx + dy * qy + dz * qz) / det
    if v < -_EDGE or u + v > 1.0 + _EDGE:
        return False
    return 0.0 < (gx * qx + gy * qy + gz * qz) / det < 1.0 - TOUCHING


@parallel()
def _cells(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Cell of each triangle along a space-filling curve."""
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
            found |= _spread(min(max(int((middle - low[c]) * scale), 0), last)) << c
        key[t] = found
    return key


@njit(inline="always")
def _spread(x: int) -> int:
    """Ten bits with two zeros between each and the next [Morton 1966]."""
    x = (x | (x << 16)) & 0x030000FF
    x = (x | (x << 8)) & 0x0300F00F
    x = (x | (x << 4)) & 0x030C30C3
    return (x | (x << 2)) & 0x09249249


@njit(cache=True, nogil=True)
def _in_order(F: np.ndarray, key: np.ndarray) -> np.ndarray:
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
def _around_triangles(U: np.ndarray, F: np.ndarray, slack: float, corners: np.ndarray) -> None:
    """Boxes (b, 2, 3) of every ``FAN`` triangles, grown by ``slack``."""
    for b in prange(len(corners)):
        for c in range(3):
            low, high = np.inf, -np.inf
            for t in range(FAN * b, min(FAN * (b + 1), len(F))):
                for d in range(3):
                    low, high = min(low, U[F[t, d], c]), max(high, U[F[t, d], c])
            corners[b, 0, c], corners[b, 1, c] = low - slack, high + slack


@njit(cache=True, nogil=True)
def _around_boxes(inner: np.ndarray, outer: np.ndarray) -> None:
    """Write the ``outer`` (b, 2, 3) boxes around every ``FAN`` of the ``inner`` ones."""
    for b in range(len(outer)):
        for c in range(3):
            low, high = np.inf, -np.inf
            for k in range(FAN * b, min(FAN * (b + 1), len(inner))):
                low, high = min(low, inner[k, 0, c]), max(high, inner[k, 1, c])
            outer[b, 0, c], outer[b, 1, c] = low, high
