"""Patches of a surface, and bounds of how much nearer two of them come.

A pair of patches keeps a budget: a lower bound of all gaps between them that are not listed. A way from U to
W takes from it only what brings the two nearer, so that motion in common costs nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, prange
from scipy.spatial import KDTree

from apd_viewer.geometry.linalg.threads import parallel

# Larger patches are fewer, and more of what is searched is in vain.
_VERTICES_PER_PATCH = 12
_SWEEPS = 6  # of Lloyd's algorithm
_PORTION = 512


class Grouped(NamedTuple):
    """Items of every patch: ``item[start[p] : start[p + 1]]``."""

    start: np.ndarray
    item: np.ndarray

    @classmethod
    def of(cls, patch: np.ndarray, item: np.ndarray, count: int) -> Grouped:
        """Group items (k,) by their patch (k,)."""
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
    used : int array
        Vertices with triangles.
    vertices, edges, faces : Grouped
        Those of every patch; an edge and a triangle belong to the patch of their first vertex.
    reached : Grouped
        Vertices of every patch and of its edges and triangles.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, E: np.ndarray) -> None:
        self.used = np.unique(F)
        own = _clustered(V[self.used])
        self._count = count = int(own.max()) + 1
        patch = np.zeros(len(V), np.int64)
        patch[self.used] = own
        self.vertices = Grouped.of(own, self.used, count)
        self.edges = Grouped.of(patch[E[:, 0]], np.arange(len(E)), count)
        self.faces = Grouped.of(patch[F[:, 0]], np.arange(len(F)), count)
        who = np.concatenate([own, np.repeat(patch[E[:, 0]], 2), np.repeat(patch[F[:, 0]], 3)])
        both = np.unique(who * len(V) + np.concatenate([self.used, E.ravel(), F.ravel()]))
        self.reached = Grouped.of(both // len(V), both % len(V), count)

    def boxes(self, U: np.ndarray) -> np.ndarray:
        """Bounding boxes (p, 6) at ``U`` (n, 3): lower corners, then upper ones."""
        return _boxes(U, *self.reached)

    def near(self, boxes: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (k, 2) of patches with boxes within ``gap``, and their distances (k,).

        In ascending order; each patch makes a pair with itself.
        """
        middle, size = (boxes[:, :3] + boxes[:, 3:]) / 2, np.linalg.norm(boxes[:, 3:] - boxes[:, :3], axis=1)
        # Few patches are large; they ask for themselves, so that they do not widen the search of all.
        usual = float(np.median(size))
        large = np.flatnonzero(size > 2.0 * usual)
        tree = KDTree(middle)
        found = [tree.query_pairs(gap + 2.0 * usual, output_type="ndarray")]
        found.append(np.column_stack([np.arange(len(boxes))] * 2))
        if len(large):
            around = tree.query_ball_point(middle[large], gap + (size[large] + size.max()) / 2)
            found += [
                np.column_stack([np.full(len(near), i), near]) for i, near in zip(large, around, strict=True)
            ]
        both = np.sort(np.concatenate(found), axis=1).astype(np.int64)
        key = np.sort(both[:, 0] * self._count + both[:, 1])
        key = key[np.diff(key, prepend=-1) > 0]
        pairs = np.column_stack([key // self._count, key % self._count])
        apart = _box_distances(boxes, pairs)
        close = apart <= gap
        return pairs[close], apart[close]

    def approaches(self, U: np.ndarray, W: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Upper bounds (k,) of the approach of pairs (k, 2) from ``U`` to ``W``."""
        return _approaches(_motions(U, W, *self.reached), pairs)


def _clustered(X: np.ndarray) -> np.ndarray:
    """Cluster of every point by Lloyd's algorithm, numbered from zero."""
    count = max(1, len(X) // _VERTICES_PER_PATCH)
    centres = X[np.random.default_rng(0).choice(len(X), count, replace=False)]
    for _ in range(_SWEEPS):
        own = KDTree(centres).query(X, workers=-1)[1]
        size = np.bincount(own, minlength=len(centres))
        sums = np.column_stack([np.bincount(own, x, minlength=len(centres)) for x in X.T])
        centres = sums[size > 0] / size[size > 0][:, None]
    own = KDTree(centres).query(X, workers=-1)[1]
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


@njit(cache=True, nogil=True)
def _box_distances(boxes: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    apart = np.empty(len(pairs))
    for e in range(len(pairs)):
        i, j = pairs[e, 0], pairs[e, 1]
        q = 0.0
        for c in range(3):
            d = max(boxes[j, c] - boxes[i, c + 3], boxes[i, c] - boxes[j, c + 3])
            if d > 0.0:
                q += d * d
        apart[e] = np.sqrt(q)
    return apart


@parallel()
def _motions(U: np.ndarray, W: np.ndarray, start: np.ndarray, item: np.ndarray) -> np.ndarray:
    """Best infinitesimal rigid motion of every patch, (p, 11).

    Centre, displacement, angular velocity; then the radius, and the largest displacement that is left.
    """
    motions = np.empty((len(start) - 1, 11))
    for p in prange(len(start) - 1):
        first, last = start[p], start[p + 1]
        centre, shift = np.zeros(3), np.zeros(3)
        for e in range(first, last):
            v = item[e]
            for c in range(3):
                centre[c] += U[v, c] / (last - first)
                shift[c] += (W[v, c] - U[v, c]) / (last - first)
        inertia, moment = np.zeros((3, 3)), np.zeros(3)
        for e in range(first, last):
            v = item[e]
            x, y, z = U[v, 0] - centre[0], U[v, 1] - centre[1], U[v, 2] - centre[2]
            dx, dy = W[v, 0] - U[v, 0] - shift[0], W[v, 1] - U[v, 1] - shift[1]
            dz = W[v, 2] - U[v, 2] - shift[2]
            inertia[0, 0] += y * y + z * z
            inertia[1, 1] += x * x + z * z
            inertia[2, 2] += x * x + y * y
            inertia[0, 1] -= x * y
            inertia[1, 2] -= y * z
            inertia[0, 2] -= z * x
            moment[0] += y * dz - z * dy
            moment[1] += z * dx - x * dz
            moment[2] += x * dy - y * dx
        spin = _solved(inertia, moment)
        radius = left = 0.0
        for e in range(first, last):
            v = item[e]
            x, y, z = U[v, 0] - centre[0], U[v, 1] - centre[1], U[v, 2] - centre[2]
            dx = W[v, 0] - U[v, 0] - shift[0] - (spin[1] * z - spin[2] * y)
            dy = W[v, 1] - U[v, 1] - shift[1] - (spin[2] * x - spin[0] * z)
            dz = W[v, 2] - U[v, 2] - shift[2] - (spin[0] * y - spin[1] * x)
            radius = max(radius, x * x + y * y + z * z)
            left = max(left, dx * dx + dy * dy + dz * dz)
        motions[p, 0:3], motions[p, 3:6], motions[p, 6:9] = centre, shift, spin
        motions[p, 9], motions[p, 10] = np.sqrt(radius), np.sqrt(left)
    return motions


@njit(cache=True, nogil=True)
def _solved(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solution of a regularised symmetric (3, 3) system, upper triangle given."""
    trace = 1e-6 * (A[0, 0] + A[1, 1] + A[2, 2]) + 1e-300
    a, d, f = A[0, 0] + trace, A[1, 1] + trace, A[2, 2] + trace
    p, q, r = A[0, 1], A[0, 2], A[1, 2]
    c00, c01, c02 = d * f - r * r, r * q - p * f, p * r - d * q
    c11, c12, c22 = a * f - q * q, p * q - a * r, a * d - p * p
    whole = a * c00 + p * c01 + q * c02
    x = np.empty(3)
    x[0] = (c00 * b[0] + c01 * b[1] + c02 * b[2]) / whole
    x[1] = (c01 * b[0] + c11 * b[1] + c12 * b[2]) / whole
    x[2] = (c02 * b[0] + c12 * b[1] + c22 * b[2]) / whole
    return x


@njit(cache=True, nogil=True)
def _seen_from(M: np.ndarray, i: int, j: int, turning: int) -> float:
    """Difference of the displacements of two centres, seen from a patch that turns."""
    x, y, z = M[j, 0] - M[i, 0], M[j, 1] - M[i, 1], M[j, 2] - M[i, 2]
    wx, wy, wz = M[turning, 6], M[turning, 7], M[turning, 8]
    a = M[i, 3] - M[j, 3] + wy * z - wz * y
    b = M[i, 4] - M[j, 4] + wz * x - wx * z
    c = M[i, 5] - M[j, 5] + wx * y - wy * x
    return np.sqrt(a * a + b * b + c * c)


@parallel()
def _approaches(M: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """See :meth:`Patches.approaches`; linear in time, so it holds on the whole way."""
    bounds = np.empty(len(pairs))
    for e in prange(len(pairs)):
        i, j = pairs[e, 0], pairs[e, 1]
        spin = 0.0
        for c in range(6, 9):
            spin += (M[i, c] - M[j, c]) ** 2
        spin = np.sqrt(spin)
        one = _seen_from(M, i, j, i) + spin * M[j, 9]
        other = _seen_from(M, i, j, j) + spin * M[i, 9]
        bounds[e] = min(one, other) + M[i, 10] + M[j, 10]
    return bounds
