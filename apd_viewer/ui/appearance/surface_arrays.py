"""Points, normals and colours of a surface, as the renderer has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Texture
    from apd_viewer.geometry.picking.preview_surface import PreviewSurface
    from apd_viewer.geometry.picking.render_mesh import RenderMesh


class SurfaceArrays:
    """Arrays of a drawn mesh, updated in place.

    The first n render vertices are those of the mesh; the others repeat some of them along sharp edges, and
    have their points and colours.

    Parameters
    ----------
    rendered : RenderMesh or PreviewSurface
    rgba : (n, 4) uint8 array
        Of the vertices; see :meth:`Surface.wear` for the opacities.
    texture : Texture, optional
        With seams where vertices of ``rendered`` are repeated.
    """

    def __init__(
        self, rendered: RenderMesh | PreviewSurface, rgba: np.ndarray, texture: Texture | None = None
    ) -> None:
        self._rendered, self._count = rendered, len(rgba)
        copied = rendered.repeated_vertices
        points = np.zeros((self._count + len(copied), 3), dtype=np.float32)
        self.data = pv.PolyData.from_regular_faces(points, rendered.F)
        self.data.point_data["Normals"] = np.zeros_like(self.data.points)
        self.data.point_data["rgba"] = np.vstack([rgba, rgba[copied]]) if len(copied) else rgba.copy()
        self.data.GetPointData().SetActiveNormals("Normals")
        if texture is not None:
            uv = np.zeros((len(points), 2), dtype=np.float32)
            uv[rendered.F] = texture.uv[texture.uv_of]
            self.data.point_data["uv"] = uv
            self.data.GetPointData().SetActiveTCoords("uv")

    def set_points(self, U: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Follow the shape ``U`` (n, 3); see :meth:`RenderMesh.drape`."""
        points, normals = self.data.points, self.data.point_data["Normals"]
        box = self._rendered.drape(U, origin, np.asarray(points), np.asarray(normals))
        points.VTKObject.Modified()
        normals.VTKObject.Modified()
        return box

    @property
    def rgba(self) -> np.ndarray:
        """Colours of the vertices, (n, 4)."""
        return np.asarray(self.data.point_data["rgba"])[: self._count]

    def set_colors(self, rgba: np.ndarray, ids: np.ndarray | None) -> None:
        """Colour the vertices ``ids``, or all, and keep their opacities."""
        self.rgba[slice(None) if ids is None else ids, :3] = rgba[:, :3]
        self.update_colors()

    def update_colors(self) -> None:
        """Draw the edited ``rgba`` from the next frame on."""
        colors = self.data.point_data["rgba"]
        np.asarray(colors)[self._count :] = self.rgba[self._rendered.repeated_vertices]
        colors.VTKObject.Modified()

    def normal_at(self, face: int, weights: np.ndarray) -> np.ndarray:
        """Normal (3,) as drawn at a point of a face with barycentric ``weights``."""
        normal: np.ndarray = weights @ np.asarray(self.data.point_data["Normals"])[self._rendered.F[face]]
        return normal

    @property
    def normals(self) -> np.ndarray:
        """Vertex normals (n, 3) as drawn; zero without a face."""
        return np.asarray(self.data.point_data["Normals"])[: self._count]
