"""Controller of a viewport's camera."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkCamera

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.scene.camera import ORTHOGRAPHIC, PERSPECTIVE, Camera

HOME_DIRECTION = np.array([0.42, 0.32, 0.85]) / np.linalg.norm([0.42, 0.32, 0.85])
CLOSEST_ZOOM = 1e-4  # zoom limits, as multiples of the framed height
FARTHEST_ZOOM = 50.0


class CameraController:
    """Camera of a viewport: standard views, framing and zoom.

    Parameters
    ----------
    pick : callable
        Function giving the visible surface point at a position in the widget, or None.

    Attributes
    ----------
    linked : sequence of CameraController
        Of other viewports with the same camera; see :func:`link_cameras`.
    on_framed : list of callables
        Called after each framing.
    bars : list of QWidget
        At the left edge of the viewport; what is framed keeps clear of them.
    """

    def __init__(self, viewport: QtInteractor, pick: Callable[[QPointF], np.ndarray | None]) -> None:
        self._viewport, self._pick = viewport, pick
        self.linked: Sequence[CameraController] = ()
        self.on_framed: list[Callable[[], object]] = []
        self.bars: list[QWidget] = []
        self._up_axis = UpAxis.PLUS_Y
        self._extent = 1.0  # height of the framed view, mesh units
        # Framed points, padding and overlays around them, and resulting camera position.
        self._framed: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None = None
        self._read: tuple[tuple[object, ...], Camera] | None = None  # what the latest camera was made of
        eye = Camera(np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 1.0, 0.0]), PERSPECTIVE, 1, 1)
        self.camera = replace(eye, position=HOME_DIRECTION)

    @property
    def camera(self) -> Camera:
        """Current camera, the same object until it changes; assignment moves it."""
        camera = self._viewport.renderer.GetActiveCamera()
        width, height = self._viewport.width(), self._viewport.height()
        # A picture asks for it some forty times, and each new one derives its axes anew.
        current = camera, camera.GetMTime(), width, height, self._up_axis
        if self._read is None or self._read[0] != current:
            eye = Camera(
                position=np.array(camera.GetPosition()),
                focal=np.array(camera.GetFocalPoint()),
                up=np.array(camera.GetViewUp()),
                angle=np.deg2rad(camera.GetViewAngle()),
                width=max(width, 1),
                height=max(height, 1),
                up_axis=self._up_axis,
                left=max(0.0, -camera.GetWindowCenter()[0] * width),
            )
            self._read = current, eye
        return self._read[1]

    @camera.setter
    def camera(self, eye: Camera) -> None:
        place_camera(self._viewport.renderer.GetActiveCamera(), eye)
        # Update all viewports together, so that Qt composes the window once instead of once for each.
        for look in (self, *self.linked):
            look._up_axis = eye.up_axis
            look._viewport.update()

    def frame(
        self, points: np.ndarray, padding: np.ndarray | float = 0.0, overlays: np.ndarray | float = 0.0
    ) -> None:
        """Frame the points (k, 3) in the current direction, with ``padding`` pixels.

        ``overlays`` are the radii of what is drawn around the points, in pixels of a large view.
        """
        if len(points):
            points, eye = np.asarray(points), replace(self.camera, left=self.covered_left)
            padding, overlays = (np.broadcast_to(room, len(points)) for room in (padding, overlays))
            self.camera = eye.framed(points, padding + eye.overlay_scale * overlays)
            self._extent = self.camera.span
            self._framed = points, padding, overlays, self.camera.position
            for follow in self.on_framed:
                follow()

    @property
    def covered_left(self) -> int:
        """Width of the viewport's part covered by bars at its left edge."""
        return max((bar.geometry().right() + 1 for bar in self.bars if not bar.isHidden()), default=0)

    def keep_framing(self) -> None:
        """Reframe the points in a view of another size, unless the camera was moved."""
        if self._framed is not None and self.is_framing:
            self.frame(*self._framed[:3])

    @property
    def is_framing(self) -> bool:
        """True if the camera has not been moved since the last framing."""
        return self._framed is not None and np.array_equal(self._framed[3], self.camera.position)

    def look_from_home(self) -> None:
        """Look from the home direction: from the front, right and above."""
        self.camera = self.camera.seen_from(HOME_DIRECTION @ self._up_axis.frame)

    def set_up_axis(self, up_axis: UpAxis) -> None:
        """Set the up axis, and look from the home direction."""
        self.camera = replace(self.camera, up_axis=up_axis)
        self.look_from_home()

    def set_orthographic(self, orthographic: bool) -> None:
        """Switch between orthographic and perspective projection."""
        eye, angle = self.camera, ORTHOGRAPHIC if orthographic else PERSPECTIVE
        if eye.is_orthographic != orthographic:
            self.camera = eye.with_angle(angle)
            if self._framed is not None and np.array_equal(self._framed[3], eye.position):
                self._framed = *self._framed[:3], self.camera.position

    def show_standard_view(self, name: str) -> None:
        """Look from 'front', 'side' or 'top'; prefix '-' gives the opposite."""
        self.camera = self.camera.standard_view(name)

    def close(self) -> None:
        """Release the linked viewports and the framed points."""
        self.linked, self._framed = (), None
        self.on_framed.clear()
        self.bars.clear()

    def zoom_at(self, position: QPointF, factor: float) -> None:
        """Zoom by a factor about the point at a position in the viewport."""
        eye, point = self.camera, self._pick(position)
        if point is None:
            point = eye.point_on_focal_plane(position.x(), position.y())
        closer = eye.zoomed(point, factor)
        if CLOSEST_ZOOM <= closer.span / self._extent <= FARTHEST_ZOOM:
            self.camera = closer


def place_camera(camera: vtkCamera, eye: Camera) -> None:
    """Place a camera of VTK."""
    camera.SetPosition(*eye.position)
    camera.SetFocalPoint(*eye.focal)
    camera.SetViewUp(*eye.up)
    camera.SetViewAngle(np.rad2deg(eye.angle))
    camera.SetWindowCenter(-eye.left / eye.width, 0.0)


def link_cameras(controllers: Sequence[CameraController]) -> None:
    """Make viewports of equal size share the first one's camera."""
    camera = controllers[0]._viewport.renderer.GetActiveCamera()
    for look in controllers:
        look._viewport.renderer.SetActiveCamera(camera)
        look.linked = [other for other in controllers if other is not look]
