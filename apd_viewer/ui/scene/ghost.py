"""Rest shape drawn like glass around the deformed shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv

from apd_viewer.ui.scene.rest_actor import RestActor
from apd_viewer.ui.scene.shading import GLASS

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.ui.scene.viewport import Viewport


class Ghost(RestActor):
    """The rest shape of a mesh.

    Parameters
    ----------
    viewport : Viewport
    """

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._actor.ForceTranslucentOn()
        self._actor.GetProperty().SetBackfaceCulling(True)
        self._actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Light::Impl", True, GLASS, False)

    def _drawn(self, mesh: Mesh) -> pv.PolyData:
        V, F = mesh.V, mesh.joined_F
        middle = V.mean(axis=0)  # far from the origin single precision is coarser than the mesh
        glass = pv.PolyData.from_regular_faces((V - middle).astype(np.float32), F)
        glass.point_data["Normals"] = _normals(V, F)
        glass.GetPointData().SetActiveNormals("Normals")
        self._actor.SetPosition(*middle)
        ends = V[F.ravel()]
        self._box = tuple(np.column_stack([ends.min(axis=0), ends.max(axis=0)]).ravel())
        return glass

    def _match_background(self, dark: bool) -> None:
        self._actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniformf("onDark", float(dark))


def _normals(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Area-weighted vertex normals (n, 3) float32; zero without a face."""
    a, b, c = V[F].transpose(1, 0, 2)
    across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    N = np.column_stack([np.bincount(F.ravel(), x, len(V)) for x in across.T])
    length = np.linalg.norm(N, axis=1, keepdims=True)
    return np.divide(N, length, out=np.zeros_like(N), where=length > 0).astype(np.float32)
