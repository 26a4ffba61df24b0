"""Impenetrable obstacles to a surface: plates, spheres, capsules."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import checked, checked_direction, checked_point, used_vertices
from apd_viewer.language import tr

_PLATE, _CAPSULE = 3, 2  # number of points that define each
# Circumradius of the triangle representing a plate, in extents of the confined surface.
_ENDLESS = 30.0


@dataclass(frozen=True, eq=False)
class Obstacle:
    """Convex hull of one to three points, thickened by a radius.

    Made by :func:`plate`, :func:`sphere` and :func:`capsule`.

    Attributes
    ----------
    points : (p, 3) float array
        One of a sphere, two of a capsule, three of a plate, mesh units.
    radius : float
        Mesh units; 0 of a plate.

    Examples
    --------
    >>> import apd_viewer
    >>> finger = apd_viewer.sphere((0, 0, 2), 0.5)
    >>> finger.points.tolist(), finger.radius
    ([[0.0, 0.0, 2.0]], 0.5)
    """

    points: np.ndarray
    radius: float

    @property
    def plate_normal(self) -> np.ndarray | None:
        """Unit normal (3,) of a plate; None for others."""
        if len(self.points) != _PLATE:
            return None
        return _normal(self.points)

    def distances_and_directions(self, points: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances (k,) and unit directions (k, 3) from the obstacle to points.

        Parameters
        ----------
        points : (p, 3) float array
            Positions of the obstacle's points.
        X : (k, 3) float array
            Behind a plate distances are negative.
        """
        if len(points) == _PLATE:
            normal = _normal(points)
            return (X - points[0]) @ normal, np.broadcast_to(normal, X.shape)
        away = X - points[0]
        if len(points) == _CAPSULE:
            axis = points[1] - points[0]
            along = np.clip(away @ axis / (axis @ axis), 0.0, 1.0)
            away = away - along[:, None] * axis
        length = np.linalg.norm(away, axis=1)
        return length - self.radius, away / np.maximum(length, np.finfo(float).tiny)[:, None]

    def pairs(self, F: np.ndarray, E: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Element pairs (p, 4) with a surface, and a mask (p,) of the pairs of two edges.

        Parameters
        ----------
        F, E : (m, 3) and (e, 2) int arrays
            Triangles and edges of the surface.
        n : int
            Number of its vertices; the points of the obstacle follow them.
        """
        if len(self.points) == _PLATE:
            vertices = used_vertices(F)
            return _rows(vertices[:, None], range(n, n + 3), after=True), np.zeros(len(vertices), bool)
        ends = [_rows(F, [n + k]) for k in range(len(self.points))]
        along = _rows(E, [n, n + 1]) if len(self.points) == _CAPSULE else np.zeros((0, 4), np.int32)
        pairs = np.concatenate([*ends, along])
        return pairs, np.arange(len(pairs)) >= len(pairs) - len(along)


@checked
def plate(point: np.ndarray, normal: np.ndarray, size: float) -> Obstacle:
    """Plane through ``point`` confining a surface to the side of ``normal``.

    Parameters
    ----------
    point, normal : (3,) float arrays
    size : float
        Extent of all that it is to stop, mesh units.

    Examples
    --------
    >>> import apd_viewer
    >>> floor = apd_viewer.plate((0, 0, 0), (0, 1, 0), size=10)
    >>> floor.points[:, 1].tolist()
    [0.0, 0.0, 0.0]
    """
    point, normal = checked_point(point), checked_direction(normal)
    across = checked_direction(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))]))
    other, r = np.cross(normal, across), _ENDLESS * size
    corners = [(np.cos(a), np.sin(a)) for a in 2.0 * np.pi / 3.0 * np.arange(3)]
    return Obstacle(np.array([point + r * (x * across + y * other) for x, y in corners]), 0.0)


@checked
def sphere(centre: np.ndarray, radius: float) -> Obstacle:
    """Sphere around ``centre`` (3,).

    Examples
    --------
    >>> import apd_viewer
    >>> apd_viewer.sphere((0, 0, 2), radius=0.5).radius
    0.5
    """
    return Obstacle(np.array([checked_point(centre)]), float(radius))


@checked
def capsule(a: np.ndarray, b: np.ndarray, radius: float) -> Obstacle:
    """Cylinder with round ends around the segment from ``a`` to ``b``, both (3,).

    Examples
    --------
    >>> import apd_viewer
    >>> apd_viewer.capsule((-1, 0, 0), (1, 0, 0), radius=0.3).points.tolist()
    [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    ends = np.array([checked_point(a), checked_point(b)])
    if not np.linalg.norm(ends[1] - ends[0]) > 0.0:
        raise InputError(tr("The two ends of a cylinder must be apart."))
    return Obstacle(ends, float(radius))


def shifted_obstacles(obstacles: Sequence[Obstacle], shift: np.ndarray) -> Sequence[Obstacle]:
    """Obstacles moved by ``shift`` (3,)."""
    return [replace(each, points=each.points + shift) for each in obstacles] if shift.any() else obstacles


def _normal(points: np.ndarray) -> np.ndarray:
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    return np.asarray(normal / np.linalg.norm(normal))


def _rows(of_surface: np.ndarray, of_obstacle: range | list[int], after: bool = False) -> np.ndarray:
    """Rows joining the vertices of each surface element with the obstacle's points."""
    own = np.broadcast_to(np.array(of_obstacle), (len(of_surface), len(of_obstacle)))
    return np.ascontiguousarray(np.hstack([of_surface, own] if after else [own, of_surface]), np.int32)
