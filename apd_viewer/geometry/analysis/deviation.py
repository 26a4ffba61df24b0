"""Deviation of a shape from its rest or target shape, one value per vertex.

Ratios are natural logarithms: twice and half are equally far from zero, and zero is no change. The value of
a vertex without a triangle, or with triangles of no area at rest, is NaN.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.analysis.surface_distance import cancellable_distances, displacement_lengths
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.edges_and_components import boundary_vertices
from apd_viewer.geometry.mesh.operators import face_areas, vertex_areas, vertex_neighbours
from apd_viewer.geometry.mesh.weighted_areas import SLIVER, Patch
from apd_viewer.geometry.picking.bounding_hierarchy import BoundingVolumeHierarchy, bounding_hierarchy

_NEEDLE = 1e-12  # height over length of a triangle without area
_FLAT = 1e-6  # curvature times the size of a mesh that is no bend but rounding


class Deviation:
    """Deviations of a mesh's shapes from its rest shape or a target shape.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions, mesh units.
    F : (m, 3) int array
        Triangles, with the vertices at a seam named by one of them.
    source : (n,) int array
        For each vertex, the representative of its position; empty without seams.
    target : TargetShape, optional
        Shape of comparison for two of the measures.

    Attributes
    ----------
    calmness : callable
        The calmness of each vertex by what is painted, (n,); see :mod:`calm_parts`.
    contact_pressure : callable
        The pressure of contact on each vertex of a shape (n, 3), (n,); see :mod:`contact_pressure`.
    thickness : (n,) float array
        Of the wall at each vertex.
    """

    calmness: Callable[[], np.ndarray]
    contact_pressure: Callable[[np.ndarray], np.ndarray]

    def __init__(
        self, V: np.ndarray, F: np.ndarray, source: np.ndarray, target: TargetShape | None = None
    ) -> None:
        self.target = target
        self.calmness = lambda: np.zeros(len(V))
        self.contact_pressure = lambda _: np.zeros(len(V))
        self.thickness = np.full(len(V), np.nan)
        self._V, self._F = np.ascontiguousarray(V, dtype=np.float64), F
        self._named = np.arange(len(V), dtype=np.int32) if not len(source) else source.astype(np.int32)
        self._patch = Patch(F, len(V))
        self._ratios = np.empty(len(F))
        self._rest_areas = face_areas(self._V, F)
        self._least = SLIVER * float(self._rest_areas.mean())

    def area_change(self, U: np.ndarray) -> np.ndarray:
        """Logarithm of the area ratio of the most changed triangle at each vertex, (n,)."""
        patch = self._patch
        with cores_for(len(U)):
            return area_change(
                U,
                self._F,
                self._rest_areas,
                self._least,
                patch.start,
                patch.corner,
                self._named,
                self._ratios,
            )

    def edge_strain(self, U: np.ndarray) -> np.ndarray:
        """Logarithm of the length ratio of the most strained edge at each vertex, (n,)."""
        patch = self._patch
        with cores_for(len(U)):
            return edge_strain(U, self._V, patch.start, patch.second, patch.third, self._named)

    def wrinkling(self, U: np.ndarray) -> np.ndarray:
        """Shortening of the most shortened triangle at each vertex, (n,), from 0 to 1."""
        patch = self._patch
        with cores_for(len(U)):
            return shortening(U, self._V, patch.start, patch.second, patch.third, self._named)

    def displacement(self, U: np.ndarray) -> np.ndarray:
        """Distance of each vertex from its rest position, (n,), mesh units."""
        with cores_for(len(U)):
            found = displacement_lengths(U, self._V)
        found[self._bare_vertices] = np.nan
        return found

    def bending(self, U: np.ndarray) -> np.ndarray:
        """Mean curvature minus its rest value, (n,), 1 / mesh units; convex is positive."""
        with cores_for(len(U)):
            return self._curvature(U) - self._rest_curvature

    def rest_distance(
        self, U: np.ndarray, is_cancelled: Callable[[], bool] = lambda: False
    ) -> np.ndarray | None:
        """Distance of each vertex from the rest surface, (n,), mesh units.

        It takes some tenths of a second for 100,000 vertices; None if ``is_cancelled()`` has ended it.
        """
        found = cancellable_distances(is_cancelled, U, self._V, self._V, self._boxes)
        if found is not None:
            found[self._bare_vertices] = np.nan
        return found

    def target_distance(
        self, U: np.ndarray, is_cancelled: Callable[[], bool] = lambda: False
    ) -> np.ndarray | None:
        """Distance of each vertex from the target surface, (n,), mesh units.

        It takes as long as :meth:`rest_distance`; None if ``is_cancelled()`` has ended it.
        """
        assert self.target is not None
        found = self.target.distances(U, is_cancelled)
        if found is not None:
            found[self._bare_vertices] = np.nan
        return found

    def target_displacement(self, U: np.ndarray) -> np.ndarray:
        """Distance of each vertex from the same vertex of the target, (n,), mesh units."""
        assert self.target is not None
        found = self.target.vertex_distances(U)
        found[self._bare_vertices] = np.nan
        return found

    def _curvature(self, U: np.ndarray) -> np.ndarray:
        patch = self._patch
        return mean_curvature(U, patch.start, patch.second, patch.third, self._named)

    @cached_property
    def _bare_vertices(self) -> np.ndarray:
        """Vertices without triangles, (k,) int array."""
        return np.flatnonzero((np.diff(self._patch.start) == 0)[self._named])

    @cached_property
    def _rest_curvature(self) -> np.ndarray:
        return self._curvature(self._V)

    @cached_property
    def _boxes(self) -> BoundingVolumeHierarchy:
        return bounding_hierarchy(self._V, self._F)


def tightest_bend(V: np.ndarray, F: np.ndarray, U: np.ndarray) -> float | None:
    """Radius of the tightest bend, mesh units; None for a shape that is not bent.

    One over twice the largest change of the mean curvature, as a mean over each vertex and its neighbours. On
    irregular triangles it is up to 15 % too small. Boundaries do not count.

    Parameters
    ----------
    V, U : (n, 3) float array
        Rest positions and positions.
    F : (m, 3) int array
        Triangles, with the vertices at a seam named by one of them.
    """
    n = len(V)
    bending = Deviation(V, F, np.empty(0, dtype=np.int32)).bending(U)
    weights = vertex_areas(V, F)
    weights[boundary_vertices(F, n)] = 0.0
    weights[~np.isfinite(bending)] = 0.0
    start, neighbour = vertex_neighbours(F, n)
    ring = sp.csr_array((np.ones(len(neighbour)), neighbour, start), shape=(n, n)) + sp.eye_array(n)
    around = ring @ weights
    sums = np.abs(ring @ np.where(weights > 0.0, weights * bending, 0.0))
    curvature = 2.0 * float(np.divide(sums, around, out=np.zeros(n), where=around > 0.0).max(initial=0.0))
    return 1.0 / curvature if curvature * diagonal(V) > _FLAT else None


@parallel()
def area_change(
    U: np.ndarray,
    F: np.ndarray,
    rest: np.ndarray,
    least: float,
    start: np.ndarray,
    corner: np.ndarray,
    representative: np.ndarray,
    ratios: np.ndarray,
) -> np.ndarray:
    """Logarithm of the area ratio of the most changed triangle at each vertex, (n,).

    NaN at a vertex without a triangle of more than ``least`` area at rest; ``ratios`` (m,) is room.
    """
    for t in prange(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        own = 0.5 * np.sqrt(x * x + y * y + z * z)
        ratios[t] = own / rest[t] if rest[t] > least else np.nan
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w, found, largest = representative[v], np.nan, -1.0
        for e in range(start[w], start[w + 1]):
            ratio = ratios[corner[e] // 3]
            if abs(ratio - 1.0) > largest:
                found, largest = ratio, abs(ratio - 1.0)
        out[v] = -np.inf if found == 0.0 else np.log(found)
    return out


@parallel()
def edge_strain(
    U: np.ndarray,
    V: np.ndarray,
    start: np.ndarray,
    second: np.ndarray,
    third: np.ndarray,
    representative: np.ndarray,
) -> np.ndarray:
    """Logarithm of the length ratio of the most strained edge at each vertex, (n,)."""
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w = representative[v]
        # Extremes of the squared ratio, so that one logarithm per vertex is enough.
        most, least = 0.0, np.inf
        for e in range(start[w], start[w + 1]):
            for j in (second[e], third[e]):
                x, y, z = V[j, 0] - V[w, 0], V[j, 1] - V[w, 1], V[j, 2] - V[w, 2]
                before = x * x + y * y + z * z
                if before > 0.0:
                    x, y, z = U[j, 0] - U[w, 0], U[j, 1] - U[w, 1], U[j, 2] - U[w, 2]
                    ratio = (x * x + y * y + z * z) / before
                    most, least = max(most, ratio), min(least, ratio)
        ratio = most if np.sqrt(most) + np.sqrt(least) >= 2.0 else least
        if least == np.inf:
            out[v] = np.nan
        elif ratio == 0.0:
            out[v] = -np.inf
        else:
            out[v] = 0.5 * np.log(ratio)
    return out


@parallel()
def shortening(
    U: np.ndarray,
    V: np.ndarray,
    start: np.ndarray,
    second: np.ndarray,
    third: np.ndarray,
    representative: np.ndarray,
) -> np.ndarray:
    """Largest shortening of the triangles at each vertex, (n,), from 0 to 1.

    That is one less the smallest principal stretch; NaN without a triangle of an area at rest.
    """
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w, least = representative[v], np.inf
        for e in range(start[w], start[w + 1]):
            a, b, c = _plane_edges(V, w, second[e], third[e])
            if c > _NEEDLE * (a + abs(b)):
                p, q, r = _plane_edges(U, w, second[e], third[e])
                # Singular values of the triangular matrix ((xx, xy), (0, yy)).
                xx, yy, xy = p / a, r / c, (q - p * b / a) / c
                least = min(least, 0.5 * abs(np.hypot(xx + yy, xy) - np.hypot(xx - yy, xy)))
        out[v] = np.nan if least == np.inf else max(1.0 - least, 0.0)
    return out


@njit(cache=True, nogil=True)
def _plane_edges(X: np.ndarray, i: int, j: int, k: int) -> tuple[float, float, float]:
    """Edges (a, 0) and (b, c) from ``i`` to ``j`` and ``k``, in their plane."""
    first = second = both = 0.0
    for d in range(3):
        x, y = X[j, d] - X[i, d], X[k, d] - X[i, d]
        first, both, second = first + x * x, both + x * y, second + y * y
    if first == 0.0:
        return 0.0, np.sqrt(second), 0.0
    length = np.sqrt(first)
    return length, both / length, np.sqrt(max(second - both * both / first, 0.0))


@parallel()
def mean_curvature(
    U: np.ndarray, start: np.ndarray, second: np.ndarray, third: np.ndarray, representative: np.ndarray
) -> np.ndarray:
    """Mean curvature at each vertex, (n,), positive if convex from outside.

    The cotangent Laplacian of the positions along the normal, over twice the area that is nearest to the
    vertex [Meyer et al. 2003]: exact where the vertices around it lie on a sphere with it.
    """
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w = representative[v]
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
    zero = 128.5 if signed else 1.5  # half a level up, as the conversion to integers truncates
    for v in prange(len(values)):
        x = values[v]
        shades[v] = np.uint8(0) if np.isnan(x) else np.uint8(min(max(zero + scale * x, 1.0), 255.0))


def extreme_vertices(values: np.ndarray, U: np.ndarray, least_distance: float, most: int) -> np.ndarray:
    """Separated vertices of the largest absolute ``values`` (n,), largest first.

    Parameters
    ----------
    values : (n,) float array
    U : (n, 3) float array
    least_distance : float
        Least distance between the vertices.
    most : int
        Largest number of vertices.
    """
    size = np.where(np.isnan(values), 0.0, np.abs(values))
    found: list[int] = []
    while len(found) < most:
        v = int(size.argmax())
        if size[v] <= 0.0:
            break
        found.append(v)
        size[((U - U[v]) ** 2).sum(axis=1) < least_distance**2] = 0.0
    return np.array(found, dtype=np.int64)
