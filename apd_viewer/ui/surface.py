"""The mesh on the screen: points, normals and colours that change in place."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.geometry.operators import vertex_normals
from apd_viewer.geometry.picking import ray_hit
from apd_viewer.ui.shading import headlight, match_background, shade

if TYPE_CHECKING:
    from PySide6.QtCore import QPointF

    from apd_viewer.ui.viewport import Viewport


class Hit(NamedTuple):
    """Where a ray meets the surface: face index, point (3,), unit normal (3,) towards the viewer."""

    face: int
    point: np.ndarray
    normal: np.ndarray


class Surface:
    """One triangle mesh in a viewport.

    Parameters
    ----------
    viewport : Viewport

    Attributes
    ----------
    F : (m, 3) int32 array
    U : (n, 3) float64 array
        Positions as shown; what picking uses.
    revision : int
        Counts changes of ``F`` and ``U``.
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self.F: np.ndarray = np.empty((0, 3), dtype=np.int32)
        self.U: np.ndarray = np.empty((0, 3))
        self.revision = 0
        self._origin = np.zeros(3)
        self._joined_F: np.ndarray = self.F
        self._source: np.ndarray | None = None  # for each vertex the one whose normal it shares
        self._mesh = pv.PolyData()
        self._mapper = vtkPolyDataMapper()
        self._mapper.SetScalarModeToUsePointFieldData()
        self._mapper.SelectColorArray("rgba")
        self._mapper.SetColorModeToDirectScalars()
        self._actor = vtkActor()
        self._actor.SetMapper(self._mapper)
        self._actor.ForceOpaqueOn()
        self._actor.SetVisibility(False)
        prop = self._actor.GetProperty()
        prop.SetInterpolationToPhong()
        prop.SetLineWidth(1.0)
        shade(self._actor)
        viewport.pre_draw.append(self._match_background)
        viewport.renderer.AddActor(self._actor)
        viewport.renderer.AddLight(headlight())
        viewport.pick = self.point_under

    def set_mesh(
        self, F: np.ndarray, U: np.ndarray, rgba: np.ndarray, joined_F: np.ndarray | None = None
    ) -> None:
        """Show another mesh.

        Parameters
        ----------
        F : (m, 3) int array
        U : (n, 3) float array
        rgba : (n, 4) uint8 array
        joined_F : (m, 3) int array, optional
            The same triangles with the vertices at a seam named by one of them: the shading is then
            smooth across seams. An STL file is nothing but seams.
        """
        self.F = np.array(F, dtype=np.int32, order="C")
        self._join(joined_F, len(U))
        self.U = np.array(U, dtype=np.float64)
        # Far from the origin single precision is coarser than the mesh.
        self._origin = self.U.mean(axis=0)
        self._actor.SetPosition(*self._origin)
        self._mesh = pv.PolyData.from_regular_faces((self.U - self._origin).astype(np.float32), self.F)
        self._mesh.point_data["Normals"] = np.zeros_like(self._mesh.points)
        self._mesh.point_data["rgba"] = np.array(rgba, dtype=np.uint8)
        self._mesh.GetPointData().SetActiveNormals("Normals")
        self._mapper.SetInputData(self._mesh)
        self._actor.SetVisibility(True)
        self.set_points(U)

    def _join(self, joined_F: np.ndarray | None, n: int) -> None:
        self._joined_F, self._source = self.F, None
        if joined_F is not None and not np.array_equal(joined_F, self.F):
            self._joined_F = np.array(joined_F, dtype=np.int32, order="C")
            self._source = np.arange(n)
            self._source[self.F] = self._joined_F

    def set_points(self, U: np.ndarray) -> None:
        """Move the vertices to ``U``, an (n, 3) float array, and turn the normals with them."""
        self.U[:] = U
        self._mesh.points[:] = self.U - self._origin
        normals = self._mesh.point_data["Normals"]
        N = np.asarray(normals).view(np.ndarray)
        vertex_normals(self.U, self._joined_F, N)
        if self._source is not None:
            N[:] = N[self._source]
        normals.VTKObject.Modified()
        self.revision += 1
        self._viewport.update()

    def set_colors(self, rgba: np.ndarray) -> None:
        """Colour the vertices; ``rgba`` is an (n, 4) uint8 array."""
        self._mesh.point_data["rgba"][:] = rgba
        self._viewport.update()

    @property
    def edges(self) -> bool:
        """Whether the edges are drawn over the surface."""
        return bool(self._actor.GetProperty().GetEdgeVisibility())

    @edges.setter
    def edges(self, on: bool) -> None:
        prop = self._actor.GetProperty()
        prop.SetEdgeVisibility(on)
        prop.SetEdgeColor(0.12, 0.13, 0.15)
        prop.SetEdgeOpacity(0.35)
        self._viewport.update()

    @property
    def smooth(self) -> bool:
        """Whether the shading is blended over the faces, or each face flat."""
        return bool(self._actor.GetProperty().GetInterpolation())

    @smooth.setter
    def smooth(self, on: bool) -> None:
        prop = self._actor.GetProperty()
        if on:
            prop.SetInterpolationToPhong()
        else:
            prop.SetInterpolationToFlat()
        self._viewport.update()

    def _match_background(self) -> None:
        match_background(self._actor, self._viewport.dark)

    def hit(self, position: QPointF) -> Hit | None:
        """What is seen of the surface at a position in the viewport."""
        origin, direction = self._viewport.ray(position)
        face, distance, b1, b2 = ray_hit(origin, direction, self.U, self.F)
        if face < 0:
            return None
        weights = np.array([1.0 - b1 - b2, b1, b2])
        normal = weights @ np.asarray(self._mesh.point_data["Normals"])[self.F[face]]
        length = float(np.linalg.norm(normal))
        normal = normal / length if length > 0 else -direction
        return Hit(face, origin + distance * direction, -normal if normal @ direction > 0 else normal)

    def point_under(self, position: QPointF) -> np.ndarray | None:
        """Point of the surface seen at a position in the viewport."""
        hit = self.hit(position)
        return None if hit is None else hit.point
