"""Sections of a surface by a plane: contours, their length and the area inside."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import checked_direction, checked_point, mesh_arrays
from apd_viewer.geometry.mesh.components import vertex_components


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
    """

    segments: np.ndarray
    faces: np.ndarray
    contours: int
    length: float
    area: float


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
    >>> cut.contours, f"{cut.length:.2f}", f"{cut.area:.2f}"
    (1, '19.61', '30.59')
    """
    return section(*mesh_arrays(V, F), checked_point(point), checked_direction(normal))


def section(V: np.ndarray, F: np.ndarray, point: np.ndarray, normal: np.ndarray) -> PlaneSection:
    """Section of validated arrays by a plane with a unit normal."""
    height = V @ normal - float(np.dot(point, normal))
    faces = _crossed_triangles(height, F)
    above = (height >= 0.0)[F[faces]]
    if not len(faces):
        return PlaneSection(np.empty((0, 2, 3)), faces, 0, 0.0, 0.0)
    down, up = (_crossed_edges(F[faces], above, falls) for falls in (True, False))
    crossed, ends = np.unique(np.vstack([down, up]), axis=0, return_inverse=True)
    share = height[crossed[:, 0]] / (height[crossed[:, 0]] - height[crossed[:, 1]])
    points = V[crossed[:, 0]] + share[:, None] * (V[crossed[:, 1]] - V[crossed[:, 0]])
    ends = ends.reshape(2, -1).T
    faces, ends = faces[ends[:, 0] != ends[:, 1]], ends[ends[:, 0] != ends[:, 1]]
    segments, number = points[ends], vertex_components(ends[:, [0, 1, 1]], len(points))
    length = float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())
    return PlaneSection(
        segments, faces, int(number.max()) + 1, length, _enclosed_area(segments, ends, normal)
    )


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
