"""Patches of a surface, and upper bounds of the approach of two patches.

A pair of patches keeps a budget: a lower bound of all unlisted gaps between them. A step from U to W reduces
it only by the approach of the two patches, so that common motion costs nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import prange
from scipy.spatial import KDTree

from apd_viewer.geometry.contact.near_boxes import NearBoxes
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel
from apd_viewer.geometry.mesh.arrays import distinct_keys, used_vertices

# Larger patches mean fewer bounds, but more candidate pairs searched in vain.
_VERTICES_PER_PATCH = 12
_SWEEPS = 6  # iterations of Lloyd's algorithm
# Number of points above which threads pay off: they take six times as long as one for 300 points, and a
# quarter less for 5,000.
_WORTH_THREADS = 2000


class PatchItems(NamedTuple):
    """Indices grouped by patch: ``item[start[p] : start[p + 1]]`` for patch p."""

    start: np.ndarray
    item: np.ndarray

    @classmethod
    def group(cls, patch: np.ndarray, item: np.ndarray, count: int) -> PatchItems:
        """Group indices ``item`` (k,) by their ``patch`` (k,)."""
        start = np.concatenate([[0], np.cumsum(np.bincount(patch, minlength=count))])
        return cls(start, item[np.argsort(patch, kind="stable")])


class Patches:
    """Compact groups of a dozen vertices, with their edges and triangles.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
    E : (e, 2) int array
        The edges of ``F``.

    Attributes
    ----------
    used_vertices : int array
        Vertices with triangles.
    vertices, edges, faces : PatchItems
        Indices by patch; an edge and a triangle belong to the patch of their first vertex.
    covered_vertices : PatchItems
        Vertices of every patch and of its edges and triangles.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, E: np.ndarray) -> None:
        self.used_vertices = used_vertices(F)
        own = _cluster_of_points(V[self.used_vertices])
        self._count = count = int(own.max()) + 1
        self._near_boxes = NearBoxes()
        patch = np.zeros(len(V), np.int64)
        patch[self.used_vertices] = own
        self.vertices = PatchItems.group(own, self.used_vertices, count)
        self.edges = PatchItems.group(patch[E[:, 0]], np.arange(len(E)), count)
        self.faces = PatchItems.group(patch[F[:, 0]], np.arange(len(F)), count)
        who = np.concatenate([own, np.repeat(patch[E[:, 0]], 2), np.repeat(patch[F[:, 0]], 3)])
        both = distinct_keys(who * len(V) + np.concatenate([self.used_vertices, E.ravel(), F.ravel()]))
        self.covered_vertices = PatchItems.group(both // len(V), both % len(V), count)

    def boxes(self, U: np.ndarray) -> np.ndarray:
        """Bounding boxes (p, 6) at ``U`` (n, 3): lower corners, then upper ones."""
        return _boxes(U, *self.covered_vertices)

    def near_pairs(self, boxes: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (k, 2) of patches with boxes within ``gap``, and their distances (k,).

        In ascending order; each patch makes a pair with itself.
        """
        return self._near_boxes.pairs_within(boxes, gap)

    def approach_bounds(self, U: np.ndarray, W: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Upper bounds (k,) of the approach of pairs (k, 2) from ``U`` to ``W``."""
        return _approaches(_motions(U, W, *self.covered_vertices), pairs)


def _cluster_of_points(X: np.ndarray) -> np.ndarray:
    """Cluster number (n,) of each point by Lloyd's algorithm, from zero."""
    count = max(1, len(X) // _VERTICES_PER_PATCH)
    workers = -1 if len(X) > _WORTH_THREADS else 1
    centres = X[np.random.default_rng(0).choice(len(X), count, replace=False)]
    for _ in range(_SWEEPS):
        own = KDTree(centres).query(X, workers=workers)[1]
        size = np.bincount(own, minlength=len(centres))
        sums = np.column_stack([np.bincount(own, x, minlength=len(centres)) for x in X.T])
        centres = sums[size > 0] / size[size > 0][:, None]
    own = KDTree(centres).query(X, workers=workers)[1]
    return np.unique(own, return_inverse=True)[1].ravel()


@parallel()
def _boxes(U: np.ndarray, start: np.ndarray, item: np.ndarray) -> np.ndarray:
    boxes = np.empty((len(start) - 1, 6))
    for p in prange(len(start) - 1):
        for c in range(3):
            low, high = np.inf, -np.inf
            for e in range(start[p], start[p + 1]):
                x = U[item[e], c]
                low, high = min(low, x), max(high, x)
            boxes[p, c], boxes[p, c + 3] = low, high
    return boxes


def pair_keys(pairs: np.ndarray) -> np.ndarray:
    """Keys (k,) of pairs (k, 2), in the same order as they."""
    keys: np.ndarray = pairs[:, 0] << 32 | pairs[:, 1]
    return keys


@njit(cache=True, nogil=True)
def rows_among(keys: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Rows (k,) of ``keys`` (k,) among ``others``, both ascending; -1 if missing."""
    rows, j = np.full(len(keys), -1, np.int32), 0
    for k in range(len(keys)):
        while j < len(others) and others[j] < keys[k]:
            j += 1
        if j < len(others) and others[j] == keys[k]:
            rows[k] = j
    return rows


@parallel()
def _motions(U: np.ndarray, W: np.ndarray, start: np.ndarray, item: np.ndarray) -> np.ndarray:
    """Best-fitting infinitesimal rigid motion of every patch, (p, 11).

    Centre, displacement, angular velocity; then the radius, and the largest displacement that is left.
    """
    motions = np.empty((len(start) - 1, 11))
    for p in prange(len(start) - 1):
        first, last = start[p], start[p + 1]
        cx = cy = cz = sx = sy = sz = 0.0
        for e in range(first, last):
            v = item[e]
            cx, cy, cz = cx + U[v, 0], cy + U[v, 1], cz + U[v, 2]
            sx, sy, sz = sx + W[v, 0], sy + W[v, 1], sz + W[v, 2]
        n = last - first
        cx, cy, cz = cx / n, cy / n, cz / n
        sx, sy, sz = sx / n - cx, sy / n - cy, sz / n - cz
        xx = yy = zz = xy = yz = zx = mx = my = mz = 0.0
        for e in range(first, last):
            v = item[e]
            x, y, z = U[v, 0] - cx, U[v, 1] - cy, U[v, 2] - cz
            dx, dy, dz = W[v, 0] - U[v, 0] - sx, W[v, 1] - U[v, 1] - sy, W[v, 2] - U[v, 2] - sz
            xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
            xy, yz, zx = xy + x * y, yz + y * z, zx + z * x
            mx, my, mz = mx + y * dz - z * dy, my + z * dx - x * dz, mz + x * dy - y * dx
        wx, wy, wz = _spin(yy + zz, zz + xx, xx + yy, xy, yz, zx, mx, my, mz)
        radius = left = 0.0
        for e in range(first, last):
            v = item[e]
            x, y, z = U[v, 0] - cx, U[v, 1] - cy, U[v, 2] - cz
            dx = W[v, 0] - U[v, 0] - sx - (wy * z - wz * y)
            dy = W[v, 1] - U[v, 1] - sy - (wz * x - wx * z)
            dz = W[v, 2] - U[v, 2] - sz - (wx * y - wy * x)
            radius = max(radius, x * x + y * y + z * z)
            left = max(left, dx * dx + dy * dy + dz * dz)
        motions[p, 0], motions[p, 1], motions[p, 2] = cx, cy, cz
        motions[p, 3], motions[p, 4], motions[p, 5] = sx, sy, sz
        motions[p, 6], motions[p, 7], motions[p, 8] = wx, wy, wz
        motions[p, 9], motions[p, 10] = np.sqrt(radius), np.sqrt(left)
    return motions


@njit(inline="always")
def _spin(
    a: float, d: float, f: float, xy: float, yz: float, zx: float, mx: float, my: float, mz: float
) -> tuple[float, float, float]:
    """Angular velocity from moments of inertia and angular momentum, regularised."""
    trace = 1e-6 * (a + d + f) + 1e-300
    a, d, f = a + trace, d + trace, f + trace
    c00, c01, c02 = d * f - yz * yz, yz * zx + xy * f, xy * yz + d * zx
    c11, c12, c22 = a * f - zx * zx, xy * zx + a * yz, a * d - xy * xy
    whole = a * c00 - xy * c01 - zx * c02
    return (
        (c00 * mx + c01 * my + c02 * mz) / whole,
        (c01 * mx + c11 * my + c12 * mz) / whole,
        (c02 * mx + c12 * my + c22 * mz) / whole,
    )


@njit(cache=True, nogil=True)
def _relative_displacement(M: np.ndarray, i: int, j: int, turning: int) -> float:
    """Relative displacement of two patch centres, seen from the patch ``turning``."""
    x, y, z = M[j, 0] - M[i, 0], M[j, 1] - M[i, 1], M[j, 2] - M[i, 2]
    wx, wy, wz = M[turning, 6], M[turning, 7], M[turning, 8]
    a = M[i, 3] - M[j, 3] + wy * z - wz * y
    b = M[i, 4] - M[j, 4] + wz * x - wx * z
    c = M[i, 5] - M[j, 5] + wx * y - wy * x
    return np.sqrt(a * a + b * b + c * c)


@parallel()
def _approaches(M: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Upper bounds (k,) of the approach of patch pairs, valid along the whole step."""
    bounds = np.empty(len(pairs))
    for e in prange(len(pairs)):
        i, j = pairs[e, 0], pairs[e, 1]
        spin = 0.0
        for c in range(6, 9):
            spin += (M[i, c] - M[j, c]) ** 2
        spin = np.sqrt(spin)
        one = _relative_displacement(M, i, j, i) + spin * M[j, 9]
        other = _relative_displacement(M, i, j, j) + spin * M[i, 9]
        bounds[e] = min(one, other) + M[i, 10] + M[j, 10]
    return bounds
