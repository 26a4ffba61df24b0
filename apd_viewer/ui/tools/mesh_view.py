"""View of the mesh: framed, saved and restored."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.ui.scene.framing import is_in_view, surrounding_box, uncovering_shift, unobstructed_camera
from apd_viewer.ui.tools.gizmo_layout import GIZMO_RADIUS

if TYPE_CHECKING:
    from PySide6.QtCore import QRectF

    from apd_viewer.ui.scene.camera_controller import CameraController
    from apd_viewer.ui.scene.surface import Surface


class MeshView:
    """Moves the camera to the mesh or to parts of it.

    Parameters
    ----------
    camera_controller : CameraController
    surface : Surface
    """

    def __init__(self, camera_controller: CameraController, surface: Surface) -> None:
        self._look, self._surface = camera_controller, surface

    def frame_mesh(self, gizmo: np.ndarray | None) -> None:
        """Show the whole mesh, and all of a gizmo at a point (3,)."""
        points, room = self._surface.U, np.zeros(len(self._surface.U))
        if gizmo is not None:
            points = np.vstack([points, gizmo])
            room = np.append(room, GIZMO_RADIUS)
        self._look.frame(points, room)

    def show_vertices(self, vertices: np.ndarray, covered: QRectF) -> None:
        """Move the camera as little as necessary to show vertices, or all if none.

        ``covered`` is the hidden part of the viewport, at its lower right.
        """
        U, look = self._surface.U, self._look
        points = U[vertices] if len(vertices) else U
        low, high = U.min(axis=0), U.max(axis=0)
        if len(vertices):
            normals, size = self._surface.normals[vertices], float(np.linalg.norm(high - low))
            look.camera = unobstructed_camera(look.camera, points, normals, size, self._surface.distances)
        if not is_in_view(look.camera, points, covered):
            shift = uncovering_shift(look.camera, covered)
            look.frame(surrounding_box(points, low, high), padding=-sum(shift))
            look.camera = look.camera.panned(*shift)

    def saved_view(self, unit: str) -> View:
        """View for a file, with the unit of length."""
        eye = self._look.camera
        stand = CameraPose(_point(eye.position), _point(eye.focal), _point(eye.up), float(eye.angle))
        return View(stand, unit, up_axis=eye.up_axis)

    def restore(self, view: View) -> None:
        """Move the camera to the standpoint and up axis saved in a file, if any."""
        if view.up_axis is not None:
            self._look.camera = replace(self._look.camera, up_axis=view.up_axis)
        if view.camera is not None:
            at = view.camera
            position, focal, up = np.array(at.position), np.array(at.focal), np.array(at.up)
            self._look.camera = replace(
                self._look.camera, position=position, focal=focal, up=up, angle=at.angle
            )


def _point(x: np.ndarray) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])
