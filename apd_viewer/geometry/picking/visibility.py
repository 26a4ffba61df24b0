"""Visibility of vertices from a viewpoint, by a bounding volume hierarchy.

One ray is answered faster by a look at every triangle: see :mod:`picking`. For a ray to
each of many vertices it is worth sorting the triangles first; then their order in a file does not matter.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.picking.bounding_hierarchy import BRANCHING, BRANCHING_BITS, BoundingHierarchy

_EDGE = 1e-9  # beyond an edge: rounding must not let a ray pass between two neighbours
# Triangles this close to a vertex, relative to its distance from the eye, do not hide it.
TOUCHING_DISTANCE = 1e-6
# A triangle covering less of the view than this is edge-on and hides nothing.
_EDGE_ON = 1e-12


def is_visible(
    eye: np.ndarray,
    U: np.ndarray,
    boxes: BoundingHierarchy,
    ids: np.ndarray,
    touching: float = TOUCHING_DISTANCE,
) -> np.ndarray:
    """Mask of the vertices visible from a point.

    One is seen if no triangle that it is not a corner of meets the straight line to it. A triangle nearer to
    it than ``touching`` of its distance from the eye does not hide it, nor does one that is seen exactly
    edge-on.

    Parameters
    ----------
    eye : (3,) float array
    U : (n, 3) float array
    boxes : BoundingHierarchy
        The :func:`bounding_hierarchy` of the same ``U``.
    ids : (k,) int array
        The vertices, by the names that the triangles have for them.
    touching : float

    Returns
    -------
    (k,) bool array
    """
    eye = np.ascontiguousarray(eye, dtype=np.float64)
    seen = np.empty(len(ids), dtype=bool)
    with cores_for(len(U)):
        _see(
            eye, U, np.asarray(ids, dtype=np.int64), boxes.F, boxes.corners, boxes.level, 1.0 - touching, seen
        )
    return seen


@parallel()
def _see(
    eye: np.ndarray,
    U: np.ndarray,
    ids: np.ndarray,
    F: np.ndarray,
    corners: np.ndarray,
    level: np.ndarray,
    end: float,
    seen: np.ndarray,
) -> None:
    ox, oy, oz = eye[0], eye[1], eye[2]
    count, top = level[1], len(level) - 2
    for i in prange(len(ids)):
        v = ids[i]
        dx, dy, dz = U[v, 0] - ox, U[v, 1] - oy, U[v, 2] - oz
        ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
        # Stackless traversal: after a box comes the largest one starting behind it.
        b, size, hidden = 0, top, False
        while b < count and not hidden:
            k = level[size] + (b >> (BRANCHING_BITS * size))
            ax, bx = (corners[k, 0, 0] - ox) * ix, (corners[k, 1, 0] - ox) * ix
            ay, by = (corners[k, 0, 1] - oy) * iy, (corners[k, 1, 1] - oy) * iy
            az, bz = (corners[k, 0, 2] - oz) * iz, (corners[k, 1, 2] - oz) * iz
            near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0))
            far = min(min(max(ax, bx), max(ay, by)), min(max(az, bz), 1.0))
            if near <= far and size > 0:
                size -= 1
                continue
            if near <= far:
                for t in range(BRANCHING * b, min(BRANCHING * (b + 1), len(F))):
                    if F[t, 0] != v and F[t, 1] != v and F[t, 2] != v:
                        hidden |= _hides(ox, oy, oz, dx, dy, dz, U, F[t, 0], F[t, 1], F[t, 2], end)
            b = ((b >> (BRANCHING_BITS * size)) + 1) << (BRANCHING_BITS * size)
            while size < top and b & ((1 << (BRANCHING_BITS * (size + 1))) - 1) == 0:
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
    end: float,
) -> bool:
    """True if a triangle blocks ``o + t d`` for ``t`` from 0 to ``end``."""
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
    return 0.0 < (gx * qx + gy * qy + gz * qz) / det < end
