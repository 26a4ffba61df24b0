"""Deviation of a shape from its rest shape, a value per vertex.

Ratios are natural logarithms: twice and half are equally far from zero, and zero is no change. A vertex
without a triangle, or whose triangles had no area at rest, has no value: it is not a number.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numba import prange

from apd_viewer.geometry.analysis.surface_distance import distances
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.measures import Patch
from apd_viewer.geometry.picking.visibility import Boxes, boxes_in_boxes

# Below so much of the mean area of a vertex, its area says nothing.
_SLIVER = 1e-12
# Vertices between two looks at whether somebody still wants to know.
_PORTION = 8192


class Deviation:
    """A rest shape, for comparison with other shapes of the same mesh.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions, mesh units.
    F : (m, 3) int array
        Triangles, with the vertices at a seam named by one of them.
    source : (n,) int array
        For each vertex the one that its place is named by; empty if there is no seam.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, source: np.ndarray) -> None:
        self._V, self._F = np.ascontiguousarray(V, dtype=np.float64), F
        self._named = np.arange(len(V), dtype=np.int32) if not len(source) else source.astype(np.int32)
        self._patch = Patch(F, len(V))
        self._faces = np.empty(len(F))
        with cores_for(len(V)):
            self._rest_areas = self._star_areas(self._V)

    def area(self, U: np.ndarray) -> np.ndarray:
        """Logarithm of the area around each vertex against rest, (n,)."""
        with cores_for(len(U)):
            now = self._star_areas(U)
            return _log_ratio(now, self._rest_areas, self._named, self._least)

    def strain(self, U: np.ndarray) -> np.ndarray:
        """Largest logarithmic edge strain at each vertex, (n,)."""
        patch = self._patch
        with cores_for(len(U)):
            return _edge_strain(U, self._V, patch.start, patch.second, patch.third, self._named)

    def displacement(self, U: np.ndarray) -> np.ndarray:
        """Distance of each vertex from its rest position, (n,), mesh units."""
        with cores_for(len(U)):
            found = _displacement(U, self._V)
        found[self._bare] = np.nan
        return found

    def bending(self, U: np.ndarray) -> np.ndarray:
        """Mean curvature less that at rest, (n,), 1 / mesh units, positive if convex."""
        with cores_for(len(U)):
            return self._curvature(U) - self._rest_curvature

    def distance(self, U: np.ndarray, enough: Callable[[], bool] = lambda: False) -> np.ndarray | None:
        """Distance of each vertex from the rest surface, (n,), mesh units.

        It takes some tenths of a second for 100,000 vertices; None if ``enough()`` has ended it.
        """
        boxes, found = self._boxes, np.empty(len(U))
        for first in range(0, len(U), _PORTION):
            if enough():
                return None
            part = slice(first, first + _PORTION)
            with cores_for(len(U)):  # not for all: the window may want the cores in between
                distances(U[part], self._V[part], self._V, boxes.F, boxes.corners, boxes.level, found[part])
        found[self._bare] = np.nan
        return found

    def _star_areas(self, U: np.ndarray) -> np.ndarray:
        return _star_areas(U, self._F, self._patch.start, self._patch.corner, self._faces)

    def _curvature(self, U: np.ndarray) -> np.ndarray:
        patch = self._patch
        return _mean_curvature(U, patch.start, patch.second, patch.third, self._named)

    @cached_property
    def _least(self) -> float:
        return _SLIVER * float(np.nanmean(self._rest_areas))

    @cached_property
    def _bare(self) -> np.ndarray:
        """The vertices without a triangle, (k,) int array."""
        return np.flatnonzero(np.isnan(self._rest_areas[self._named]))

    @cached_property
    def _rest_curvature(self) -> np.ndarray:
        return self._curvature(self._V)

    @cached_property
    def _boxes(self) -> Boxes:
        return boxes_in_boxes(self._V, self._F)


@parallel()
def _star_areas(
    U: np.ndarray, F: np.ndarray, start: np.ndarray, corner: np.ndarray, faces: np.ndarray
) -> np.ndarray:
    """Area of the triangles around each vertex, (n,), NaN without one."""
    for t in prange(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        faces[t] = 0.5 * np.sqrt(x * x + y * y + z * z)
    areas = np.empty(len(U))
    for v in prange(len(U)):
        total = np.nan if start[v] == start[v + 1] else 0.0
        for e in range(start[v], start[v + 1]):
            total += faces[corner[e] // 3]
        areas[v] = total
    return areas


@parallel()
def _log_ratio(now: np.ndarray, rest: np.ndarray, named: np.ndarray, least: float) -> np.ndarray:
    out = np.empty(len(named))
    for v in prange(len(named)):
        w = named[v]
        if not rest[w] > least:
            out[v] = np.nan
        else:
            out[v] = np.log(now[w] / rest[w]) if now[w] > 0.0 else -np.inf
    return out


@parallel()
def _edge_strain(
    U: np.ndarray,
    V: np.ndarray,
    start: np.ndarray,
    second: np.ndarray,
    third: np.ndarray,
    named: np.ndarray,
) -> np.ndarray:
    out = np.empty(len(named))
    for v in prange(len(named)):
        w = named[v]
        # Squares of the largest and the smallest ratio: one logarithm a vertex is enough.
        most, least = 0.0, np.inf
        for e in range(start[w], start[w + 1]):
            for j in (second[e], third[e]):
                x, y, z = V[j, 0] - V[w, 0], V[j, 1] - V[w, 1], V[j, 2] - V[w, 2]
                before = x * x + y * y + z * z
                if before > 0.0:
                    x, y, z = U[j, 0] - U[w, 0], U[j, 1] - U[w, 1], U[j, 2] - U[w, 2]
                    ratio = (x * x + y * y + z * z) / before
                    most, least = max(most, ratio), min(least, ratio)
        if least == np.inf:
            out[v] = np.nan
        elif least == 0.0:
            out[v] = -np.inf
        else:
            out[v] = 0.5 * np.log(most if most * least >= 1.0 else least)
    return out


@parallel()
def _displacement(U: np.ndarray, V: np.ndarray) -> np.ndarray:
    out = np.empty(len(U))
    for v in prange(len(U)):
        x, y, z = U[v, 0] - V[v, 0], U[v, 1] - V[v, 1], U[v, 2] - V[v, 2]
        out[v] = np.sqrt(x * x + y * y + z * z)
    return out


@parallel()
def _mean_curvature(
    U: np.ndarray, start: np.ndarray, second: np.ndarray, third: np.ndarray, named: np.ndarray
) -> np.ndarray:
    """Mean curvature at each vertex, (n,), positive if convex from outside.

    The cotangent Laplacian of the positions along the normal, over twice the area that is nearest to the
    vertex [Meyer et al. 2003]: exact where the vertices around it lie on a sphere with it.
    """
    out = np.empty(len(named))
    for v in prange(len(named)):
        w = named[v]
        area = lx = ly = lz = nx = ny = nz = 0.0
        for e in range(start[w], start[w + 1]):
            j, k = second[e], third[e]
            ax, ay, az = U[j, 0] - U[w, 0], U[j, 1] - U[w, 1], U[j, 2] - U[w, 2]
            bx, by, bz = U[k, 0] - U[w, 0], U[k, 1] - U[w, 1], U[k, 2] - U[w, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double = np.sqrt(x * x + y * y + z * z)
            if double > 0.0:
                aa, bb, ab = (
                    ax * ax + ay * ay + az * az,
                    bx * bx + by * by + bz * bz,
                    ax * bx + ay * by + az * bz,
                )
                at_j, at_k = (aa - ab) / double, (bb - ab) / double  # cotangents
                if ab < 0.0:
                    area += 0.25 * double
                elif at_j < 0.0 or at_k < 0.0:
                    area += 0.125 * double
                else:
                    area += 0.125 * (aa * at_k + bb * at_j)
                lx += at_k * ax + at_j * bx
                ly += at_k * ay + at_j * by
                lz += at_k * az + at_j * bz
                nx, ny, nz = nx + x, ny + y, nz + z
        length = np.sqrt(nx * nx + ny * ny + nz * nz)
        out[v] = np.nan
        if area > 0.0 and length > 0.0:
            out[v] = -0.25 * (lx * nx + ly * ny + lz * nz) / (length * area)
    return out


def write_shades(values: np.ndarray, signed: bool, reach: float, shades: np.ndarray) -> None:
    """Quantise ``values`` (n,) to ``shades`` (n,) uint8; the scale ends at ``reach``.

    With a sign -reach, 0 and reach are 1, 128 and 255, without one 0 and reach are 1 and 255; what is beyond
    is as the end, and 0 is no value.
    """
    with cores_for(len(values)):
        _write_shades(values, signed, reach, shades)


@parallel()
def _write_shades(values: np.ndarray, signed: bool, reach: float, shades: np.ndarray) -> None:
    scale = (127.0 if signed else 254.0) / reach
    zero = 128.5 if signed else 1.5  # truncated, it is rounded
    for v in prange(len(values)):
        x = values[v]
        shades[v] = np.uint8(0) if np.isnan(x) else np.uint8(min(max(zero + scale * x, 1.0), 255.0))


def worst(values: np.ndarray, U: np.ndarray, apart: float, most: int) -> np.ndarray:
    """Vertices of the largest absolute ``values`` (n,), worst first, kept apart.

    Parameters
    ----------
    values : (n,) float array
    U : (n, 3) float array
    apart : float
        Their least distance.
    most : int
        How many at most.
    """
    size = np.where(np.isnan(values), 0.0, np.abs(values))
    found: list[int] = []
    while len(found) < most:
        v = int(size.argmax())
        if size[v] <= 0.0:
            break
        found.append(v)
        size[((U - U[v]) ** 2).sum(axis=1) < apart**2] = 0.0
    return np.array(found, dtype=np.int64)


def warm_up() -> None:
    """Compile all of it, or load it from the cache."""
    V = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    change = Deviation(V, np.array([[0, 1, 2]], dtype=np.int32), np.empty(0, dtype=np.int32))
    V.flags.writeable = False
    shades = np.zeros((3, 4), dtype=np.uint8)[:, 3]
    for measured in (change.area, change.strain, change.displacement, change.bending, change.distance):
        values = measured(V)
        assert values is not None
        write_shades(values, True, 1.0, shades)
