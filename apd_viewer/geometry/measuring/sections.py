"""Sections of a surface by a plane: contours, area inside, and volume below."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import checked_direction, checked_point, mesh_arrays
from apd_viewer.geometry.mesh.edges_and_components import vertex_components
from apd_viewer.geometry.mesh.weld import Weld


class PlaneSection(NamedTuple):
    """Contours of the intersection of a plane and a surface.

    Attributes
    ----------
    segments : (s, 2, 3) float array
        Start and end of the cut through each triangle, mesh units.
    faces : (s,) int array
        Those triangles.
    contours : int
        Number of connected contours.
    length : float
        Of all contours together, mesh units.
    area : float
        Enclosed area, squared mesh units; that of holes and cavities is subtracted. NaN if a contour is open,
        or faces along it are flipped.
    volume_below : float
        Enclosed volume on the side opposite to the normal, cubic mesh units. NaN if the surface is open or
        not manifold there, or faces are flipped.
    """

    segments: np.ndarray
    faces: np.ndarray
    contours: int
    length: float
    area: float
    volume_below: float


def plane_section(V: np.ndarray, F: np.ndarray, point: np.ndarray, normal: np.ndarray) -> PlaneSection:
    """Cut a surface by a plane.

    A vertex in the plane counts as above it. So the contours are the border of what is below, and closed
    where the surface is.

    Parameters
    ----------
    V : (n, 3) float array
        Positions.
    F : (m, 3) int array
        Triangles, counter-clockwise seen from outside.
    point, normal : (3,) float arrays
        A point of the plane, and a vector perpendicular to it of any length.

    Returns
    -------
    PlaneSection
        Without segments where the plane misses the surface; its length and area are 0 there.

    Raises
    ------
    InputError
        If ``point`` is no place or ``normal`` no direction.

    Examples
    --------
    >>> import apd_viewer
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> cut = apd_viewer.plane_section(mesh.V, mesh.F, point=(0, 10, 0), normal=(0, 1, 0))
    >>> cut.contours, f"{cut.length:.2f}", f"{cut.area:.2f}", f"{cut.volume_below:.1f}"
    (1, '19.61', '30.59', '286.1')
    """
    V, F = mesh_arrays(V, F)
    seamless = Weld.from_positions(V, F).representative[F]  # coincident vertices are one place
    return section(V, seamless, checked_point(point), checked_direction(normal))


def section(V: np.ndarray, F: np.ndarray, point: np.ndarray, normal: np.ndarray) -> PlaneSection:
    """Section of validated arrays by a plane with a unit normal."""
    height = V @ normal - float(np.dot(point, normal))
    faces = _crossed_triangles(height, F)
    faces = faces[(F[faces] != np.roll(F[faces], 1, axis=1)).all(axis=1)]
    above = (height >= 0.0)[F[faces]]
    below = abs(volume_below(V, F, height, normal)) if is_closed_below(F, height) else float("nan")
    if not len(faces):
        return PlaneSection(np.empty((0, 2, 3)), faces, 0, 0.0, 0.0, below)
    down, up = (_crossed_edges(F[faces], above, falls) for falls in (True, False))
    crossed, ends = np.unique(np.vstack([down, up]), axis=0, return_inverse=True)
    share = height[crossed[:, 0]] / (height[crossed[:, 0]] - height[crossed[:, 1]])
    points = V[crossed[:, 0]] + share[:, None] * (V[crossed[:, 1]] - V[crossed[:, 0]])
    ends = ends.reshape(2, -1).T
    segments, number = points[ends], vertex_components(ends[:, [0, 1, 1]], len(points))
    length = float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())
    return PlaneSection(
        segments, faces, int(number.max()) + 1, length, _enclosed_area(segments, ends, normal), below
    )


def is_closed_below(F: np.ndarray, height: np.ndarray) -> bool:
    """True if each edge with an end below height 0 is used once in each direction.

    Triangles with a corner twice do not count.

    Parameters
    ----------
    F : (m, 3) int array
    height : (n,) float array
        Of the vertices.
    """
    a, b = F.ravel().astype(np.int64), np.roll(F, -1, axis=1).ravel().astype(np.int64)
    below = height < 0.0
    used = np.repeat((np.roll(F, -1, axis=1) != F).all(axis=1), 3) & (below[a] | below[b])
    a, b, n = a[used], b[used], len(height)
    forward = np.sort(a * n + b)
    return bool((np.diff(forward) > 0).all() and np.array_equal(forward, np.sort(b * n + a)))


def volume_below(V: np.ndarray, F: np.ndarray, height: np.ndarray, normal: np.ndarray) -> float:
    """Signed volume inside a surface below height 0, where it is closed.

    By the divergence theorem: the field ``height * normal`` has divergence 1, and vanishes in the plane.

    Parameters
    ----------
    V : (n, 3) float array
    F : (m, 3) int array
    height : (n,) float array
        Of the vertices, along ``normal``.
    normal : (3,) float array
        A unit vector.
    """
    T = F[(height < 0.0)[F].any(axis=1)]
    return volume_below_level(projected_areas(V, T, normal), np.sort(height[T]), 0.0)


def projected_areas(V: np.ndarray, F: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Signed areas (m,) of triangles seen along a unit normal."""
    areas: np.ndarray = 0.5 * (np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]) @ normal)
    return areas


def volume_below_level(projected: np.ndarray, heights: np.ndarray, level: float) -> float:
    """Signed volume below a level, inside triangles that are closed there.

    Parameters
    ----------
    projected : (m,) float array
        Their :func:`projected_areas`.
    heights : (m, 3) float array
        Of their corners, each row ascending.
    """
    wet = heights[:, 0] < level
    return -float((projected[wet] * _mean_depths(level - heights[wet])).sum())


def _mean_depths(depth: np.ndarray) -> np.ndarray:
    """Integral of the positive part of linear functions over triangles, per area.

    Parameters
    ----------
    depth : (k, 3) float array
        Values at the corners, each row descending from a positive one.
    """
    most, middle, least = depth.T
    mean = (most + middle + least) / 3.0
    tip = middle <= 0.0
    a, b, c = most[tip], middle[tip], least[tip]
    mean[tip] = a**3 / (3.0 * (a - b) * (a - c))
    cut = (middle > 0.0) & (least < 0.0)
    a, b, c = most[cut], middle[cut], least[cut]
    mean[cut] -= c**3 / (3.0 * (c - a) * (c - b))
    return mean


@njit(cache=True, nogil=True)
def _crossed_triangles(height: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Triangles with corners on both sides of the plane at height 0."""
    found, count = np.empty(len(F), dtype=np.int64), 0
    for t in range(len(F)):
        above = (height[F[t, 0]] >= 0.0) + (height[F[t, 1]] >= 0.0) + (height[F[t, 2]] >= 0.0)
        if 0 < above < 3:
            found[count] = t
            count += 1
    return found[:count].copy()


def _crossed_edges(F: np.ndarray, above: np.ndarray, falls: bool) -> np.ndarray:
    """Edge (s, 2) of each triangle falling below the plane, or else rising above it."""
    after = np.roll(above, -1, axis=1)
    corner = np.argmax(above & ~after if falls else ~above & after, axis=1)
    rows = np.arange(len(F))
    return np.sort(np.column_stack([F[rows, corner], F[rows, (corner + 1) % 3]]), axis=1)


def _enclosed_area(segments: np.ndarray, ends: np.ndarray, normal: np.ndarray) -> float:
    """Area inside contours; NaN unless the segments form closed loops."""
    starts, stops = np.sort(ends, axis=0).T
    if not np.array_equal(starts, stops) or (np.diff(starts) == 0).any():
        return float("nan")
    p, q = (segments - segments[0, 0]).transpose(1, 0, 2)
    return 0.5 * abs(float(np.cross(p, q).sum(axis=0) @ normal))
