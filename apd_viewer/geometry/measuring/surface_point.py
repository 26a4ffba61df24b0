"""Points of a surface, carried along by its deformation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.surface_distance import nearest_triangles
from apd_viewer.geometry.mesh.arrays import checked_floats, checked_integers, is_whole_number
from apd_viewer.language import tr

_ROUNDING = 1e-6  # tolerance for rounding of typed or computed weights


class SurfacePoint(NamedTuple):
    """A point of a triangle mesh, the same material point in every shape.

    Attributes
    ----------
    face : int
        Row of the triangle.
    weights : tuple of 3 floats
        Barycentric coordinates in it, at least 0, with sum 1.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> apd_viewer.SurfacePoint.at_vertex(np.array([[0, 1, 2], [1, 3, 2]]), 3)
    SurfacePoint(face=1, weights=(0.0, 1.0, 0.0))
    """

    face: int
    weights: tuple[float, float, float]

    @classmethod
    def at_vertex(cls, F: np.ndarray, vertex: int) -> SurfacePoint:
        """Point at a vertex of the triangles ``F`` (m, 3); raises InputError if unused."""
        F = checked_integers(F, tr("Faces"))
        is_mesh = F.ndim == 2 and F.shape[1] == 3
        there = np.argwhere(vertex == F) if is_mesh and is_whole_number(vertex) else np.empty((0, 2))
        if not len(there):
            raise InputError(tr("No triangle has the vertex {id}; choose another.").format(id=vertex))
        face, corner = there[0].tolist()
        weights = [0.0, 0.0, 0.0]
        weights[corner] = 1.0
        return cls(face, (weights[0], weights[1], weights[2]))

    def check(self, F: np.ndarray) -> None:
        """Raise InputError unless the point lies on the triangles ``F`` (m, 3)."""
        if not is_whole_number(self.face) or not 0 <= self.face < len(F):
            raise InputError(tr("There is no triangle {id}; choose another.").format(id=self.face))
        weights = checked_floats(self.weights, tr("The weights of a point"))
        fits = weights.shape == (3,) and weights.min() >= -_ROUNDING
        if not fits or not abs(weights.sum() - 1.0) <= _ROUNDING:
            raise InputError(tr("The weights of a point of the surface must be at least 0 and sum to 1."))


def point_positions(points: Sequence[SurfacePoint], U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Positions (k, 3) of points on the triangles ``F`` (m, 3) at ``U`` (n, 3)."""
    if not points:
        return np.empty((0, 3))
    faces = np.array([point.face for point in points])
    return np.einsum("kc,kci->ki", np.array([point.weights for point in points]), U[F[faces]])


@dataclass(frozen=True, eq=False)
class CarriedPath:
    """Polyline on a surface, carried along by its deformation.

    Attributes
    ----------
    corners : (k, 3) int array
        Vertices of the triangle of each point.
    weights : (k, 3) float array
        Barycentric coordinates in it.
    """

    corners: np.ndarray
    weights: np.ndarray

    @classmethod
    def from_polyline(cls, path: np.ndarray, V: np.ndarray, F: np.ndarray) -> CarriedPath:
        """Carried path from a polyline (k, 3) on the surface ``V``, ``F``."""
        corners = nearest_triangles(path, V, F)[1]
        A, B, C = V[corners].transpose(1, 0, 2)
        normal = np.cross(B - A, C - A)
        double = np.maximum(np.einsum("ij,ij->i", normal, normal), np.finfo(float).tiny)
        b, c = (
            np.einsum("ij,ij->i", np.cross(*sides), normal) / double
            for sides in ((path - A, C - A), (B - A, path - A))
        )
        return cls(corners, np.column_stack([1.0 - b - c, b, c]))

    @classmethod
    def empty(cls) -> CarriedPath:
        """A path without points."""
        return cls(np.empty((0, 3), dtype=np.int64), np.empty((0, 3)))

    def points_at(self, U: np.ndarray) -> np.ndarray:
        """Points (k, 3) of the path on the shape ``U`` (n, 3)."""
        return np.einsum("kc,kci->ki", self.weights, U[self.corners])
