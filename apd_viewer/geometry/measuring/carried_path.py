"""Polylines on a surface, carried along by its deformation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.surface_distance import nearest_triangles


@dataclass(frozen=True, eq=False)
class CarriedPath:
    """A polyline of points of a surface.

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
        """A polyline (k, 3) on the surface ``V``, ``F``."""
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
        """Points (k, 3) where the surface is at ``U`` (n, 3)."""
        return np.einsum("kc,kci->ki", self.weights, U[self.corners])
