"""A target shape, and the distance of another shape from it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.surface_distance import (
    SurfaceDistance,
    cancellable_distances,
    displacement_lengths,
    distance_summary,
    surface_distance,
)
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import diagonal, frozen, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.bounding_hierarchy import BoundingVolumeHierarchy, bounding_hierarchy

# Size ratios beyond this factor suggest different units: an inch is 25.4 mm.
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
    """Mesh for comparison, in the coordinates and unit of length of the deformed one.

    Attributes
    ----------
    mesh : Mesh
    """

    mesh: Mesh

    def has_same_triangles(self, mesh: Mesh) -> bool:
        """True if both meshes have the same triangles, and hence the same vertex IDs."""
        other = self.mesh
        return len(other.V) == len(mesh.V) and np.array_equal(other.F, mesh.F)

    def distances(self, U: np.ndarray, is_cancelled: Callable[[], bool] = lambda: False) -> np.ndarray | None:
        """Distance (n,) of each point of ``U`` (n, 3) from the target surface.

        None if cancelled by ``is_cancelled()``.
        """
        near = frozen(np.full(U.shape, np.inf))
        if len(self.mesh.V) == len(U) and self._uses_all_vertices:
            near = self.mesh.V
        return cancellable_distances(is_cancelled, U, near, self.mesh.V, self._boxes)

    def vertex_distances(self, U: np.ndarray) -> np.ndarray:
        """Distance (n,) of each point of ``U`` (n, 3) from the target vertex of its ID."""
        with cores_for(len(U)):
            return displacement_lengths(U, self.mesh.V)

    def target_distance(
        self, mesh: Mesh, U: np.ndarray, is_cancelled: Callable[[], bool] = lambda: False
    ) -> TargetDistance | None:
        """Distance of a mesh's shape ``U`` (n, 3); None if ``is_cancelled()`` was True."""
        closest = self.distances(U, is_cancelled)
        if closest is None:
            return None
        vertex = (
            distance_summary(self.vertex_distances(U), U, mesh.F) if self.has_same_triangles(mesh) else None
        )
        return TargetDistance(distance_summary(closest, U, mesh.F), vertex)

    def reverse_distance(self, mesh: Mesh, U: np.ndarray) -> SurfaceDistance:
        """Distance of the target from a mesh's shape ``U`` (n, 3)."""
        return surface_distance(self.mesh.V, self.mesh.F, U, mesh.F)

    def size_ratio(self, mesh: Mesh) -> float | None:
        """Target size over mesh size if they suggest different units, else None."""
        factor = _size(self.mesh) / _size(mesh)
        return None if 1.0 / _ALIKE < factor < _ALIKE else factor

    @cached_property
    def _boxes(self) -> BoundingVolumeHierarchy:
        return bounding_hierarchy(self.mesh.V, self.mesh.F.astype(np.int32))

    @cached_property
    def _uses_all_vertices(self) -> bool:
        """True if every vertex of the target belongs to a triangle."""
        return len(used_vertices(self.mesh.F)) == len(self.mesh.V)


def _size(mesh: Mesh) -> float:
    """Bounding-box diagonal of the surface."""
    return diagonal(mesh.V[mesh.F.ravel()])
