"""Histogram of the local area change of a surface, in one pass.

The change of a triangle is measured by ``c = max(r, 1/r) - 1``, r the ratio of its area to the rest area,
separately for growth and shrinkage: half and twice the area are then equally far from no change, without
a logarithm per triangle. The bins are so narrow relative to their distance from zero that any coarser
histogram and any percentile can be derived from them.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.weighted_areas import SLIVER

# Bins per octave of c; octaves range from 2^_LOWEST, the level of rounding, to 2^_HIGHEST.
_STEPS = 64
_LOWEST, _HIGHEST = -40, 10
_BINS = (_HIGHEST - _LOWEST) * _STEPS
# Exponent and leading mantissa bits of a float give the bin number, up to an offset.
_BELOW_STEPS = 52 - int(math.log2(_STEPS))
_BEFORE = (1023 + _LOWEST) * _STEPS - 1
_AT_ONCE = 512  # triangles per block
_PARTS = 4


def _edges() -> np.ndarray:
    """Upper edges (_BINS + 2,) of the bins of the change c, ascending from 0."""
    octaves = np.repeat(2.0 ** np.arange(_LOWEST, _HIGHEST), _STEPS)
    inner = octaves * (1.0 + np.tile(np.arange(_STEPS) / _STEPS, _HIGHEST - _LOWEST))
    return np.concatenate([[0.0], inner, [2.0**_HIGHEST]])


_C = _edges()
_GROWN, _SHRUNK = _C, _C / (1.0 + _C)  # bin edges as relative changes of area
_EITHER = np.union1d(_GROWN, _SHRUNK)
_OCTAVES = np.log2(1.0 + _C)


@dataclass(frozen=True, eq=False)
class LocalChange:
    """Area changes of the triangles, weighted by their rest areas.

    Attributes
    ----------
    mean, p99, largest : float
        Of the change of a triangle's area up or down, relative to its area at rest: the mean, what 99 % of
        the surface do not exceed, and the largest of all.
    below : (k,) float array
        Fraction of the surface with an area ratio below each bin edge, from 0 to 1.
    """

    mean: float
    p99: float
    largest: float
    below: np.ndarray

    def surface_fractions(self, edges: np.ndarray) -> np.ndarray:
        """Surface fractions (b,) between ``edges`` (b + 1,) in log2 of the area ratio."""
        return np.diff(np.interp(edges, _ALL_OCTAVES, self.below))


_ALL_OCTAVES = np.concatenate([-_OCTAVES[:0:-1], _OCTAVES])


def local_change(U: np.ndarray, F: np.ndarray, rest: np.ndarray) -> LocalChange:
    """Area changes of triangles ``F`` at ``U`` (n, 3), with ``rest`` areas (m,)."""
    parts = np.zeros((_PARTS, 2, _BINS + 1))
    found = np.zeros((_PARTS, 2))
    with cores_for(len(U)):
        _bin_triangles(U, F, rest, SLIVER * rest.mean(), parts, found)
    weights, moved, largest = parts.sum(axis=0), found[:, 0].sum(), float(found[:, 1].max())
    total = weights.sum()
    if total == 0.0:
        return LocalChange(0.0, 0.0, 0.0, np.linspace(0.0, 1.0, len(_ALL_OCTAVES)))
    weights /= total
    shrunk, grown = (np.concatenate([[0.0], np.cumsum(side)]) for side in weights)
    either = np.interp(_EITHER, _SHRUNK, shrunk) + np.interp(_EITHER, _GROWN, grown)
    k = int(np.searchsorted(either, 0.99))
    before = either[k - 1]
    part = (0.99 - before) / (either[k] - before)
    p99 = _EITHER[k - 1] + part * (_EITHER[k] - _EITHER[k - 1])
    below = np.concatenate([shrunk[-1] - shrunk[:0:-1], shrunk[-1] + grown])
    return LocalChange(moved / total, min(float(p99), largest), largest, below)


@parallel()
def _bin_triangles(
    U: np.ndarray, F: np.ndarray, rest: np.ndarray, least: float, parts: np.ndarray, found: np.ndarray
) -> None:
    """Bin the triangles in fixed blocks, each into ``parts[p]`` and ``found[p]``.

    There are as many whatever the number of cores, so that the sums are the same.
    """
    share = (len(F) + len(parts) - 1) // len(parts)
    for p in prange(len(parts)):
        first, end = p * share, (p + 1) * share
        found[p, 0], found[p, 1] = _bin_block(U, F[first:end], rest[first:end], least, parts[p])


# Three passes over a block of triangles, the second pure arithmetic, are three times as fast as
# one. Not inlined: inside a parallel loop it would not be vectorized.
@njit(cache=True, nogil=True, error_model="numpy")
def _bin_block(
    U: np.ndarray, F: np.ndarray, rest: np.ndarray, least: float, weights: np.ndarray
) -> tuple[float, float]:
    """Add rest areas to the bins; return the total and the largest change."""
    moved = largest = 0.0
    area, change, ratio = np.empty(_AT_ONCE), np.empty(_AT_ONCE), np.empty(_AT_ONCE)
    bits = change.view(np.int64)
    for first in range(0, len(F), _AT_ONCE):
        count = min(_AT_ONCE, len(F) - first)
        for s in range(count):
            i, j, k = F[first + s, 0], F[first + s, 1], F[first + s, 2]
            ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            area[s] = x * x + y * y + z * z
        for s in range(count):
            area[s] = 0.5 * np.sqrt(area[s])
            change[s] = abs(area[s] - rest[first + s]) / min(area[s], rest[first + s])
            ratio[s] = area[s] / rest[first + s]
        for s in range(count):
            w = rest[first + s]
            if w > least:
                moved += abs(area[s] - w)
                largest = max(largest, abs(ratio[s] - 1.0))
                place = (bits[s] >> _BELOW_STEPS) - _BEFORE
                weights[1 if area[s] >= w else 0, min(max(place, 0), _BINS)] += w
    return moved, largest
