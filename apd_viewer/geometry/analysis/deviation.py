"""Deviation of a shape from its rest or target shape, one value per vertex.

Ratios are natural logarithms: twice and half are equally far from zero, and zero is no change. A vertex
without a triangle, or whose triangles had no area at rest, has no value: it is not a number.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from apd_viewer.geometry.analysis.deviation_kernels import (
    area_change,
    displacements,
    edge_strain,
    mean_curvature,
)
from apd_viewer.geometry.analysis.surface_distance import cancellable_distances
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.mesh.weighted_areas import SLIVER, Patch
from apd_viewer.geometry.picking.bounding_hierarchy import BoundingHierarchy, bounding_hierarchy


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
    target : TargetShape, optional
        What two of the measures compare with.

    Attributes
    ----------
    calmness : callable
        The calmness of each vertex by what is painted, (n,); see :mod:`calm_parts`.
    contact_pressure : callable
        The pressure of contact on each vertex of a shape (n, 3), (n,); see :mod:`contact_pressure`.
    """

    calmness: Callable[[], np.ndarray]
    contact_pressure: Callable[[np.ndarray], np.ndarray]

    def __init__(
        self, V: np.ndarray, F: np.ndarray, source: np.ndarray, target: TargetShape | None = None
    ) -> None:
        self.target = target
        self.calmness = lambda: np.zeros(len(V))
        self.contact_pressure = lambda _: np.zeros(len(V))
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
        """Largest logarithmic edge strain at each vertex, (n,)."""
        patch = self._patch
        with cores_for(len(U)):
            return edge_strain(U, self._V, patch.start, patch.second, patch.third, self._named)

    def displacement(self, U: np.ndarray) -> np.ndarray:
        """Distance of each vertex from its rest position, (n,), mesh units."""
        with cores_for(len(U)):
            found = displacements(U, self._V)
        found[self._bare] = np.nan
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
            found[self._bare] = np.nan
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
            found[self._bare] = np.nan
        return found

    def target_displacement(self, U: np.ndarray) -> np.ndarray:
        """Distance of each vertex from the same vertex of the target, (n,), mesh units."""
        assert self.target is not None
        found = self.target.vertex_distances(U)
        found[self._bare] = np.nan
        return found

    def _curvature(self, U: np.ndarray) -> np.ndarray:
        patch = self._patch
        return mean_curvature(U, patch.start, patch.second, patch.third, self._named)

    @cached_property
    def _bare(self) -> np.ndarray:
        """Vertices without triangles, (k,) int array."""
        return np.flatnonzero((np.diff(self._patch.start) == 0)[self._named])

    @cached_property
    def _rest_curvature(self) -> np.ndarray:
        return self._curvature(self._V)

    @cached_property
    def _boxes(self) -> BoundingHierarchy:
        return bounding_hierarchy(self._V, self._F)
