"""Actors of the rest shape beside the deformed one."""

from __future__ import annotations

from abc import ABC, abstractmethod

import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.ui.scene.viewport import Viewport


class RestActor(ABC):
    """Actor of the rest shape, switched on and off; without cost while off.

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
        self._actor.SetVisibility(False)
        viewport.renderer.AddActor(self._actor)
        viewport.pre_draw.append(lambda: self._match_background(viewport.is_dark))
        viewport.more_boxes.append(lambda: self._box)

    @property
    def visible(self) -> bool:
        """True while shown."""
        return self._on

    @visible.setter
    def visible(self, on: bool) -> None:
        self._on = on
        self._show()

    def follow(self, mesh: Mesh | None) -> None:
        """Show the rest shape of another mesh, or nothing."""
        if mesh is not self._mesh:
            self._mesh = mesh
            self._show()

    @property
    def _shown(self) -> Mesh | None:
        return self._mesh if self._on else None

    def _show(self) -> None:
        mesh, self._box = self._shown, ()
        self._actor.SetVisibility(mesh is not None)
        self._mapper.SetInputData(None if mesh is None else self._drawn(mesh))
        self._viewport.update()

    @abstractmethod
    def _drawn(self, mesh: Mesh) -> pv.PolyData:
        """Data to draw; also places the actor and returns its extent."""

    @abstractmethod
    def _match_background(self, dark: bool) -> None:
        """Stand out from a dark or a light background."""
