"""Distance of points from a surface."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.operators import vertex_areas
from apd_viewer.geometry.picking.bounding_hierarchy import (
    BRANCHING,
    BoundingVolumeHierarchy,
    bounding_hierarchy,
)

_BITS = 3  # log2 of BRANCHING
# Points per task of a core, and per check for cancellation.
_PORTION, _CHECKED = 128, 8192


class SurfaceDistance(NamedTuple):
    """Distance of the vertices of one surface from another, mesh units.

    Attributes
    ----------
    largest : float
    rms, mean : float
        Root mean square and mean, each vertex weighted by its area.
    """

    largest: float
    rms: float
    mean: float


def surface_distance(U: np.ndarray, F: np.ndarray, V: np.ndarray, G: np.ndarray) -> SurfaceDistance:
    """Distance of the surface ``U``, ``F`` from the surface ``V``, ``G``.

    Largest over both directions it is the Hausdorff distance, up to the size of the triangles.
    """
    on = used_vertices(F)
    away = np.zeros(len(U))
    away[on] = nearest_triangles(U[on], V, G)[0]
    return distance_summary(away, U, F)


def distance_summary(distances: np.ndarray, U: np.ndarray, F: np.ndarray) -> SurfaceDistance:
    """Summary of the distances (n,) of the vertices of a surface ``U``, ``F``.

    Vertices without a triangle do not count.
    """
    on = used_vertices(F)
    distances, area = distances[on], vertex_areas(U, F)[on]
    weights = area if area.any() else None  # a target may consist of lines
    mean, square = (float(np.average(x, weights=weights)) for x in (distances, distances**2))
    return SurfaceDistance(float(distances.max()), square**0.5, mean)


def nearest_triangles(points: np.ndarray, V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (k,) of the nearest triangle from each point, and its corners (k, 3)."""
    boxes, away = bounding_hierarchy(V, F), np.empty(len(points))
    which = np.empty(len(points), dtype=np.int32)
    with cores_for(max(len(V), len(points))):
        write_distances(points, np.full(points.shape, np.inf), V, *boxes, away, which)
    return away, boxes.F[which].astype(np.int64)


def cancellable_distances(
    is_cancelled: Callable[[], bool],
    points: np.ndarray,
    first_guesses: np.ndarray,
    V: np.ndarray,
    boxes: BoundingVolumeHierarchy,
) -> np.ndarray | None:
    """Distances (k,) of points from a surface; None if ``is_cancelled()`` was True.

    Parameters
    ----------
    is_cancelled : callable
    points, first_guesses, V, boxes
        See :func:`write_distances`.
    """
    found, which = np.empty(len(points)), np.empty(len(points), dtype=np.int32)
    for first in range(0, len(points), _CHECKED):
        if is_cancelled():
            return None
        part = slice(first, first + _CHECKED)
        with cores_for(len(points)):  # acquired per block, as the window may need the cores in between
            write_distances(points[part], first_guesses[part], V, *boxes, found[part], which[part])
    return found


@parallel()
def write_distances(
    points: np.ndarray,
    first_guesses: np.ndarray,
    V: np.ndarray,
    F: np.ndarray,
    corners: np.ndarray,
    level: np.ndarray,
    out: np.ndarray,
    nearest_face: np.ndarray,
) -> None:
    """Write the distances of points from a surface.

    Parameters
    ----------
    points : (k, 3) float array
    first_guesses : (k, 3) float array
        A point of the surface for each of them: the nearer, the faster. Infinite where none is known.
    V : (n, 3) float array
    F, corners, level
        The surface: :func:`apd_viewer.geometry.picking.bounding_hierarchy.bounding_hierarchy` of ``V``.
    out : (k,) float array
    nearest_face : (k,) int array
        Overwritten with the nearest triangles, where ``first_guesses`` is farther than they are.
    """
    count, top = level[1], len(level) - 2
    for portion in prange((len(points) + _PORTION - 1) // _PORTION):
        last = -1
        for i in range(portion * _PORTION, min(len(points), (portion + 1) * _PORTION)):
            px, py, pz = points[i, 0], points[i, 1], points[i, 2]
            x, y, z = px - first_guesses[i, 0], py - first_guesses[i, 1], pz - first_guesses[i, 2]
            best = x * x + y * y + z * z
            if last >= 0:  # neighbouring points often have the same nearest triangle
                best = min(best, _squared_distance(px, py, pz, V, F[last, 0], F[last, 1], F[last, 2]))
            # Stackless traversal: a box is followed by the largest one that starts after its end.
            b, size = 0, top
            while b < count:
                k = level[size] + (b >> (_BITS * size))
                x = max(max(corners[k, 0, 0] - px, px - corners[k, 1, 0]), 0.0)
                y = max(max(corners[k, 0, 1] - py, py - corners[k, 1, 1]), 0.0)
                z = max(max(corners[k, 0, 2] - pz, pz - corners[k, 1, 2]), 0.0)
                near = x * x + y * y + z * z < best
                if near and size > 0:
                    size -= 1
                    continue
                if near:
                    for t in range(BRANCHING * b, min(BRANCHING * (b + 1), len(F))):
                        squared = _squared_distance(px, py, pz, V, F[t, 0], F[t, 1], F[t, 2])
                        if squared < best:
                            best, last = squared, t
                b = ((b >> (_BITS * size)) + 1) << (_BITS * size)
                while size < top and b & ((1 << (_BITS * (size + 1))) - 1) == 0:
                    size += 1
            out[i], nearest_face[i] = np.sqrt(best), last


@njit(inline="always")
def _squared_distance(px: float, py: float, pz: float, V: np.ndarray, i: int, j: int, k: int) -> float:
    """Squared distance of a point from a triangle."""
    ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
    bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
    dx, dy, dz = px - V[i, 0], py - V[i, 1], pz - V[i, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    nn = nx * nx + ny * ny + nz * nz
    # Barycentric coordinates of the projection, times nn.
    b1 = (dy * bz - dz * by) * nx + (dz * bx - dx * bz) * ny + (dx * by - dy * bx) * nz
    b2 = (ay * dz - az * dy) * nx + (az * dx - ax * dz) * ny + (ax * dy - ay * dx) * nz
    if nn > 0.0 and b1 >= 0.0 and b2 >= 0.0 and b1 + b2 <= nn:
        return (dx * nx + dy * ny + dz * nz) ** 2 / nn
    side = min(
        _squared_segment_distance(dx, dy, dz, ax, ay, az), _squared_segment_distance(dx, dy, dz, bx, by, bz)
    )
    return min(side, _squared_segment_distance(dx - ax, dy - ay, dz - az, bx - ax, by - ay, bz - az))


@njit(inline="always")
def _squared_segment_distance(dx: float, dy: float, dz: float, ex: float, ey: float, ez: float) -> float:
    """Squared distance of point ``d`` from the segment from the origin to ``e``."""
    ee = ex * ex + ey * ey + ez * ez
    along = dx * ex + dy * ey + dz * ez
    s = min(max(along / ee, 0.0), 1.0) if ee > 0.0 else 0.0
    x, y, z = dx - s * ex, dy - s * ey, dz - s * ez
    return x * x + y * y + z * z


@parallel()
def displacement_lengths(U: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Distances between corresponding vertices of two shapes, (n,)."""
    out = np.empty(len(U))
    for v in prange(len(U)):
        x, y, z = U[v, 0] - V[v, 0], U[v, 1] - V[v, 1], U[v, 2] - V[v, 2]
        out[v] = np.sqrt(x * x + y * y + z * z)
    return out
