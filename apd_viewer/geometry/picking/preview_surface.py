"""Surface for drawing a mesh before its full index is available."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh.normals import vertex_normals


@dataclass(frozen=True, eq=False)
class PreviewSurface:
    """Surface for display only, until its :class:`SurfaceIndex` is available.

    Attributes
    ----------
    F : (m, 3) int array
    """

    F: np.ndarray
    repeated_vertices = np.empty(0, dtype=np.int32)

    def render_mesh(self, sharp: bool, with_file_normals: bool = False) -> PreviewSurface:  # noqa: ARG002
        """The surface itself, always with smooth normals."""
        return self

    def write_render_arrays(
        self, U: np.ndarray, origin: np.ndarray, points: np.ndarray, normals: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Write the renderer's arrays for the shape ``U``, as ``RenderMesh`` does."""
        corners = U[self.F]
        points[:] = U - origin
        normals[:] = vertex_normals(U, self.F)
        return corners.min(axis=(0, 1)) - origin, corners.max(axis=(0, 1)) - origin
