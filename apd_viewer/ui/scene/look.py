"""Camera of a viewport and its moves."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.scene.camera import ORTHOGRAPHIC, PERSPECTIVE, Camera

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from PySide6.QtCore import QPointF
    from pyvistaqt import QtInteractor

HOME = np.array([0.42, 0.32, 0.85]) / np.linalg.norm([0.42, 0.32, 0.85])
CLOSEST = 1e-4  # zoom limits, in multiples of what was framed
FARTHEST = 50.0


class Look:
    """Camera of a viewport: standard views, framing and zoom.

    Parameters
    ----------
    viewport : QtInteractor
    pick : callable
        From a position in the widget to the point of the surface seen there, or None.

    Attributes
    ----------
    linked : sequence of Look
        Of other viewports with the same camera; see :func:`link`.
    """

    def __init__(self, viewport: QtInteractor, pick: Callable[[QPointF], np.ndarray | None]) -> None:
        self._viewport, self._pick = viewport, pick
        self.linked: Sequence[Look] = ()
        self._up_axis = UpAxis.PLUS_Y
        self._extent = 1.0  # height of the picture when it was framed
        # Points, the room around them, and where the camera went to show them.
        self._framed: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        eye = Camera(np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 1.0, 0.0]), PERSPECTIVE, 1, 1)
        self.eye = replace(eye, position=HOME)

    @property
    def eye(self) -> Camera:
        """The camera; assign another one to move it."""
        camera = self._viewport.renderer.GetActiveCamera()
        return Camera(
            position=np.array(camera.GetPosition()),
            focal=np.array(camera.GetFocalPoint()),
            up=np.array(camera.GetViewUp()),
            angle=np.deg2rad(camera.GetViewAngle()),
            width=max(self._viewport.width(), 1),
            height=max(self._viewport.height(), 1),
            up_axis=self._up_axis,
        )

    @eye.setter
    def eye(self, eye: Camera) -> None:
        camera = self._viewport.renderer.GetActiveCamera()
        camera.SetPosition(*eye.position)
        camera.SetFocalPoint(*eye.focal)
        camera.SetViewUp(*eye.up)
        camera.SetViewAngle(np.rad2deg(eye.angle))
        # All at once: Qt composes the window once for all viewports, and not for each.
        for look in (self, *self.linked):
            look._up_axis = eye.up_axis
            look._viewport.update()

    def frame(self, points: np.ndarray, room: np.ndarray | float = 0.0) -> None:
        """Frame the points (k, 3) in the current direction, ``room`` pixels apart."""
        if len(points):
            points, room = np.asarray(points), np.broadcast_to(room, len(points))
            self.eye = self.eye.framed(points, room)
            self._extent = self.eye.span
            self._framed = points, room, self.eye.position

    def keep_framing(self) -> None:
        """Frame the same points again at another size, unless the camera was moved."""
        if self._framed is not None and np.array_equal(self._framed[2], self.eye.position):
            self.frame(*self._framed[:2])

    def home(self) -> None:
        """Look from the home direction: from the front, right and above."""
        self.eye = self.eye.standing(HOME @ self._up_axis.frame)

    def stand(self, up_axis: UpAxis) -> None:
        """Look from the home direction, with another axis up."""
        self.eye = replace(self.eye, up_axis=up_axis)
        self.home()

    def project(self, orthographic: bool) -> None:
        """Look with parallel lines of sight, or in perspective."""
        eye, angle = self.eye, ORTHOGRAPHIC if orthographic else PERSPECTIVE
        if eye.is_orthographic != orthographic:
            self.eye = eye.opened(angle)
            if self._framed is not None and np.array_equal(self._framed[2], eye.position):
                self._framed = *self._framed[:2], self.eye.position

    def along(self, axis: str) -> None:
        """Look from the 'front', 'side' or 'top', '-' for the opposite."""
        self.eye = self.eye.placed(axis)

    def close(self) -> None:
        """Release the linked viewports and the framed points."""
        self.linked, self._framed = (), None

    def zoom_at(self, position: QPointF, factor: float) -> None:
        """Zoom by a factor, keeping the point under a position."""
        eye, point = self.eye, self._pick(position)
        if point is None:
            point = eye.on_focal_plane(position.x(), position.y())
        closer = eye.zoomed(point, factor)
        if CLOSEST <= closer.span / self._extent <= FARTHEST:
            self.eye = closer


def link(looks: Sequence[Look]) -> None:
    """Let viewports of one size share the first one's camera."""
    camera = looks[0]._viewport.renderer.GetActiveCamera()
    for look in looks:
        look._viewport.renderer.SetActiveCamera(camera)
        look.linked = [other for other in looks if other is not look]
