"""A target shape, and the distance of another shape from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.deviation_kernels import displacements
from apd_viewer.geometry.analysis.surface_distance import (
    SurfaceDistance,
    distances_unless,
    summary,
    surface_distance,
)
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.picking.bounding_hierarchy import Boxes, bounding_hierarchy

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh

# Sizes of two meshes farther apart than by this factor suggest another unit: inches are 25.4 mm.
_ALIKE = 8.0


class TargetDistance(NamedTuple):
    """Distance of a shape from a target shape.

    Attributes
    ----------
    closest : SurfaceDistance
        Of each vertex from the closest point of the target.
    vertex : SurfaceDistance or None
        Of each vertex from the same vertex of the target; None if the triangles differ.
    """

    closest: SurfaceDistance
    vertex: SurfaceDistance | None


@dataclass(frozen=True, eq=False)
class TargetShape:
    """Another mesh, for comparison; in the same coordinates and unit of length.

    Attributes
    ----------
    mesh : Mesh
    """

    mesh: Mesh

    def corresponds(self, mesh: Mesh) -> bool:
        """True if both have the same triangles, so that vertices have the same IDs."""
        other = self.mesh
        return len(other.V) == len(mesh.V) and np.array_equal(other.F, mesh.F)

    def distances(self, U: np.ndarray, enough: Callable[[], bool] = lambda: False) -> np.ndarray | None:
        """Distance (n,) of each point of ``U`` (n, 3) from the closest of the target.

        None if ``enough()`` has ended it.
        """
        near = frozen(np.full(U.shape, np.inf))
        if len(self.mesh.V) == len(U) and self._all_used:
            near = self.mesh.V
        return distances_unless(enough, U, near, self.mesh.V, self._boxes)

    def vertex_distances(self, U: np.ndarray) -> np.ndarray:
        """Distance (n,) of each point of ``U`` (n, 3) from the vertex with the same ID."""
        with cores_for(len(U)):
            return displacements(U, self.mesh.V)

    def compared(
        self, mesh: Mesh, U: np.ndarray, enough: Callable[[], bool] = lambda: False
    ) -> TargetDistance | None:
        """Distance of the shape ``U`` (n, 3) of a mesh; None if ``enough()`` has ended it."""
        closest = self.distances(U, enough)
        if closest is None:
            return None
        vertex = summary(self.vertex_distances(U), U, mesh.F) if self.corresponds(mesh) else None
        return TargetDistance(summary(closest, U, mesh.F), vertex)

    def back(self, mesh: Mesh, U: np.ndarray) -> SurfaceDistance:
        """Distance of the target from the shape ``U`` (n, 3) of a mesh."""
        return surface_distance(self.mesh.V, self.mesh.F, U, mesh.F)

    def misfit(self, mesh: Mesh) -> float | None:
        """Size of the target in sizes of a mesh if that suggests another unit, else None."""
        factor = _size(self.mesh) / _size(mesh)
        return None if 1.0 / _ALIKE < factor < _ALIKE else factor

    @cached_property
    def _boxes(self) -> Boxes:
        return bounding_hierarchy(self.mesh.V, self.mesh.F.astype(np.int32))

    @cached_property
    def _all_used(self) -> bool:
        """True if every vertex is on the surface."""
        return len(np.unique(self.mesh.F)) == len(self.mesh.V)


def _size(mesh: Mesh) -> float:
    """Diagonal of the bounding box of the surface."""
    return diagonal(mesh.V[mesh.F.ravel()])
