"""Translucent rest or target shape, and previews of moved patches."""

from abc import ABC, abstractmethod

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.ui.scene.surface_shading import GLASS_SHADER, TINTED_GLASS_SHADER
from apd_viewer.ui.scene.viewport import Viewport


class RestActor(ABC):
    """Base class of an optional actor of the rest shape, built only when visible."""

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._mesh: Mesh | None = None
        self._on = False
        self._box: tuple[float, ...] = ()
        self._mapper = vtkPolyDataMapper()
        self._mapper.ScalarVisibilityOff()
        self._actor = vtkActor()
        self._actor.SetMapper(self._mapper)
        self._actor.SetVisibility(False)
        viewport.renderer.AddActor(self._actor)
        viewport.pre_draw.append(lambda: self._match_background(viewport.is_dark))
        viewport.more_boxes.append(lambda: self._box)

    @property
    def visible(self) -> bool:
        """True while the actor is shown."""
        return self._on

    @visible.setter
    def visible(self, on: bool) -> None:
        self._on = on
        self._show()

    def set_mesh(self, mesh: Mesh | None) -> None:
        """Set the mesh; hide the actor if None."""
        if mesh is not self._mesh:
            self._mesh = mesh
            self._show()

    @property
    def _shown_mesh(self) -> Mesh | None:
        return self._mesh if self._on else None

    def _show(self) -> None:
        mesh, self._box = self._shown_mesh, ()
        self._actor.SetVisibility(mesh is not None)
        self._mapper.SetInputData(None if mesh is None else self._prepared_data(mesh))
        self._viewport.update()

    @abstractmethod
    def _prepared_data(self, mesh: Mesh) -> pv.PolyData:
        """Position the actor, store its bounds, and return the data to draw."""

    @abstractmethod
    def _match_background(self, dark: bool) -> None:
        """Adapt the colours to a dark or a light background."""


class Ghost(RestActor):
    """Translucent drawing of the rest shape of a mesh.

    Parameters
    ----------
    glass : str
        Shader: one of those of :mod:`apd_viewer.ui.scene.surface_shading`.
    """

    def __init__(self, viewport: Viewport, glass: str = GLASS_SHADER) -> None:
        super().__init__(viewport)
        # Behind the surface where both are equal, as on a part that has not moved.
        self._mapper.SetResolveCoincidentTopologyToPolygonOffset()
        self._mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(2.0, 2.0)
        self._actor.ForceTranslucentOn()
        self._actor.GetProperty().SetBackfaceCulling(True)
        self._actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Light::Impl", True, glass, False)

    def _prepared_data(self, mesh: Mesh) -> pv.PolyData:
        V, F = mesh.V, mesh.joined_F
        middle = V.mean(axis=0)  # single precision is too coarse far from the origin
        glass = pv.PolyData.from_regular_faces((V - middle).astype(np.float32), F)
        glass.point_data["Normals"] = vertex_normals(V, F).astype(np.float32)
        glass.GetPointData().SetActiveNormals("Normals")
        self._actor.SetPosition(*middle)
        ends = V[F.ravel()]
        self._box = tuple(np.column_stack([ends.min(axis=0), ends.max(axis=0)]).ravel())
        return glass

    def _match_background(self, dark: bool) -> None:
        self._actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformf("onDark", float(dark))


class PatchGhost:
    """Translucent patches of a surface at previewed positions, each in its colour.

    Attributes
    ----------
    vertices : (n, 3) float array
        Vertices of the patches; empty while nothing is shown.
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self.vertices = np.empty((0, 3))
        self._mapper = vtkPolyDataMapper()
        # Avoid z-fighting between a round handle and its ghost rotated about the axis.
        self._mapper.SetResolveCoincidentTopologyToPolygonOffset()
        self._mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(-2.0, -2.0)
        self._actor = vtkActor()
        self._actor.SetMapper(self._mapper)
        self._actor.ForceTranslucentOn()
        self._actor.GetShaderProperty().AddFragmentShaderReplacement(
            "//VTK::Light::Impl", True, TINTED_GLASS_SHADER, False
        )
        self._actor.SetVisibility(False)
        viewport.renderer.AddActor(self._actor)
        viewport.more_boxes.append(self._box)

    def show(self, V: np.ndarray, F: np.ndarray, colors: np.ndarray) -> None:
        """Show triangles ``F`` (m, 3) of ``V`` (n, 3), with ``colors`` (n, 3) uint8."""
        self.vertices = V
        middle = V.mean(axis=0)  # single precision is too coarse far from the origin
        glass = pv.PolyData.from_regular_faces((V - middle).astype(np.float32), F)
        glass.point_data["Normals"] = vertex_normals(V, F).astype(np.float32)
        glass.GetPointData().SetActiveNormals("Normals")
        glass.point_data["colors"] = colors
        glass.GetPointData().SetActiveScalars("colors")
        self._mapper.SetInputData(glass)
        self._actor.SetPosition(*middle)
        self._actor.SetVisibility(True)
        self._viewport.update()

    def hide(self) -> None:
        """Remove the patches."""
        if len(self.vertices):
            self.vertices = np.empty((0, 3))
            self._actor.SetVisibility(False)
            self._mapper.SetInputData(None)
            self._viewport.update()

    def _box(self) -> tuple[float, ...]:
        """Bounds in VTK order, low and high along each axis; empty without a patch."""
        if not len(self.vertices):
            return ()
        return tuple(np.column_stack([self.vertices.min(axis=0), self.vertices.max(axis=0)]).ravel())
