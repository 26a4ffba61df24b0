"""Off-screen scene for pictures of other shapes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage
from vtkmodules.vtkRenderingCore import vtkRenderer

from apd_viewer.presentation.scales import Scale
from apd_viewer.session.model.state import State
from apd_viewer.ui.scene.coloring import colors_of
from apd_viewer.ui.scene.scene_picture import scene_picture
from apd_viewer.ui.scene.shading import Shading
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

_LONGER = 1000  # px
_ROOM = 0.02  # of the picture, around the shapes


class _OffscreenViewport:
    """As much of a viewport as a surface needs."""

    is_dark = False

    def __init__(self) -> None:
        self.renderer = vtkRenderer()
        self.pre_draw: list[Callable[[], None]] = []
        self.box: Callable[[], tuple[float, ...]] | None = None
        self.pick_point: object = None

    def update(self) -> None:
        """There is no screen."""


class OffscreenScene:
    """Renders the shapes of a state from the user's camera, all at one scale.

    Parameters
    ----------
    viewport : Viewport
        Draws the pictures, which have no background.
    state : State
    edges : bool
    shading : Shading
        See :class:`apd_viewer.ui.scene.surface.Surface`.
    """

    def __init__(self, viewport: Viewport, state: State, edges: bool, shading: Shading) -> None:
        self._viewport, self._set = viewport, _OffscreenViewport()
        self._surface = Surface(cast("Viewport", self._set))
        self._surface.set_mesh(state.surface_index, state.frame.U, colors_of(state.document))
        self._surface.shows_edges, self._surface.shading = edges, shading
        used = np.unique(state.surface_index.F)
        self.size = self._aim(np.concatenate([state.document.mesh.V[used], state.frame.U[used]]))

    def _aim(self, points: np.ndarray) -> QSize:
        """Frame all points and return the size of a picture that suits them."""
        eye = self._viewport.camera_controller.camera
        right, up, _ = eye.axes
        wide, high = float(np.ptp(points @ right)), float(np.ptp(points @ up))
        ratio = min(max(wide / high if high > 0.0 else 2.0, 0.7), 4.0 / 3.0)
        size = (
            QSize(_LONGER, round(_LONGER / ratio)) if ratio > 1.0 else QSize(round(_LONGER * ratio), _LONGER)
        )
        eye = replace(eye, width=size.width(), height=size.height())
        eye = eye.framed(points, np.full(len(points), _ROOM * _LONGER))
        camera = self._set.renderer.GetActiveCamera()
        camera.SetPosition(*eye.position)
        camera.SetFocalPoint(*eye.focal)
        camera.SetViewUp(*eye.up)
        camera.SetViewAngle(np.rad2deg(eye.angle))
        return size

    def painted_picture(self, U: np.ndarray) -> QImage:
        """The shape with the positions ``U`` (n, 3), as it is painted."""
        self._surface.set_color_map(None)
        return self._taken(U)

    def measured_picture(self, U: np.ndarray, shades: np.ndarray, scale: Scale) -> QImage:
        """Picture in the colours of a ``scale``; ``shades`` as a surface's."""
        neutral = scale.neutral_share if scale.measure.is_signed else -1.0
        self._surface.set_color_map(scale.measure.colors, neutral)
        self._surface.shades[:] = shades
        self._surface.update_shades()
        return self._taken(U)

    def _taken(self, U: np.ndarray) -> QImage:
        self._surface.set_points(U)
        if self._set.box is not None:
            self._set.renderer.ResetCameraClippingRange(list(self._set.box()))
        for prepare in self._set.pre_draw:
            prepare()
        return scene_picture(self._viewport, self.size, transparent=True, renderer=self._set.renderer)
