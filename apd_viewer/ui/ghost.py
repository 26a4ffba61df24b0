"""The rest shape around the shape that came of it, as if of glass."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.ui.shading import GLASS

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh import Mesh
    from apd_viewer.ui.viewport import Viewport


class Ghost:
    """Shows the rest shape of a mesh, and takes nothing while it is off.

    Parameters
    ----------
    viewport : Viewport
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._mesh: Mesh | None = None
        self._on = False
        self._box: tuple[float, ...] = ()
        self._mapper = vtkPolyDataMapper()
        self._mapper.ScalarVisibilityOff()
        self._actor = vtkActor()
        self._actor.SetMapper(self._mapper)
        self._actor.ForceTranslucentOn()
        self._actor.GetProperty().SetBackfaceCulling(True)
        self._actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Light::Impl", True, GLASS, False)
        self._actor.SetVisibility(False)
        viewport.renderer.AddActor(self._actor)
        viewport.pre_draw.append(self._match_background)
        viewport.more_boxes.append(lambda: self._box)

    @property
    def on(self) -> bool:
        """Whether it is shown."""
        return self._on

    @on.setter
    def on(self, on: bool) -> None:
        self._on = on
        self._show()

    def follow(self, mesh: Mesh) -> None:
        """Show the rest shape of another mesh."""
        if mesh is not self._mesh:
            self._mesh = mesh
            self._show()

    def _show(self) -> None:
        shown = self._on and self._mesh is not None
        self._actor.SetVisibility(shown)
        if shown and self._mesh is not None:
            V, F = self._mesh.V, self._mesh.joined_F
            middle = V.mean(axis=0)  # far from the origin single precision is coarser than the mesh
            glass = pv.PolyData.from_regular_faces((V - middle).astype(np.float32), F)
            glass.point_data["Normals"] = _normals(V, F)
            glass.GetPointData().SetActiveNormals("Normals")
            self._mapper.SetInputData(glass)
            self._actor.SetPosition(*middle)
            ends = V[F.ravel()]
            self._box = tuple(np.column_stack([ends.min(axis=0), ends.max(axis=0)]).ravel())
        else:
            self._mapper.SetInputData(None)
            self._box = ()
        self._viewport.update()

    def _match_background(self) -> None:
        if self._on:
            uniforms = self._actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformf("onDark", float(self._viewport.dark))


def _normals(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Unit normals of the vertices, (n, 3) float32, weighted by area; zero where there is no face."""
    a, b, c = V[F].transpose(1, 0, 2)
    across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    N = np.column_stack([np.bincount(F.ravel(), x, len(V)) for x in across.T])
    length = np.linalg.norm(N, axis=1, keepdims=True)
    return np.divide(N, length, out=np.zeros_like(N), where=length > 0).astype(np.float32)
