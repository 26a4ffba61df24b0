"""Mouse tool for picking surface points, or a plane through one, to measure."""

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent, QWheelEvent

from apd_viewer.geometry.measuring.measurement import Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.pointing import WheelSteps
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.selection_tool import may_begin_stroke


class MeasureTool(MouseTool, QObject):
    """Tool for picking as many surface points as a measurement needs.

    Attributes
    ----------
    axis : int
        0, 1 or 2: what the plane of a section is perpendicular to.
    picked : Signal(object, object)
        All is there: a tuple of SurfacePoint and None, or an empty one and a Plane.
    """

    picked = Signal(object, object)
    axis_changed = Signal(int)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport, self._surface = viewport, surface
        self._kind = MeasurementKind.DISTANCE
        self._enabled = False
        self._points: list[SurfacePoint] = []
        self._under: SurfacePoint | None = None  # point under the cursor
        self.axis = 1
        self._wheel = WheelSteps()

    @property
    def kind(self) -> MeasurementKind:
        """Kind of the next measurement."""
        return self._kind

    @kind.setter
    def kind(self, kind: MeasurementKind) -> None:
        self.cancel()
        self._kind = kind

    @property
    def enabled(self) -> bool:
        """True while the tool is active."""
        return self._enabled

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self.cancel()
        self._enabled = on

    @property
    def points(self) -> np.ndarray:
        """Positions (k, 3) of the clicked points and the point under the cursor."""
        skin = self._surface.picking_index
        places = [*self._points, *([] if self._under is None else [self._under])]
        if skin is None or not places or not self._enabled:
            return np.empty((0, 3))
        return point_positions(places, self._surface.U, skin.F)

    @property
    def plane(self) -> Plane | None:
        """Plane through the point under the cursor, of a section or a fill level."""
        points = self.points
        if self._kind.points or not len(points):
            return None
        up = self._viewport.camera_controller.camera.up_axis.direction
        normal = np.eye(3)[self.axis] if self._kind is MeasurementKind.SECTION else up
        x, y, z = normal.tolist()
        return Plane((x, y, z), float(points[-1] @ normal))

    def press(self, event: QMouseEvent) -> bool:
        """Show the point under the cursor; a drag can still move it."""
        if not self._enabled or not may_begin_stroke(event):
            return False
        self._update_hit(event.position())
        return self._under is not None

    def move(self, event: QMouseEvent) -> bool:
        """Show the point under the cursor."""
        if not self._enabled:
            return False
        self._update_hit(event.position())
        if self._under is not None:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        return self._under is not None

    def release(self, event: QMouseEvent) -> None:
        """Add the point; emit ``picked`` once all points are there."""
        self._update_hit(event.position())
        if self._under is None:
            return
        if (plane := self.plane) is not None:
            self.picked.emit((), plane)
            return
        self._points.append(self._under)
        if len(self._points) == self._kind.points:
            points, self._points = tuple(self._points), []
            self.picked.emit(points, None)

    def wheel(self, event: QWheelEvent) -> bool:
        """Switch to the next axis of the section plane."""
        if not self._enabled or self._kind is not MeasurementKind.SECTION:
            return False
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        if steps := self._wheel.take(event):
            self.axis = (self.axis - steps) % 3
            self._viewport.tool_layer.update()
            self.axis_changed.emit(self.axis)
        return True

    def leave(self) -> None:
        """Hide the point under the cursor."""
        if self._under is not None:
            self._under = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Discard the points clicked so far; True if there were any."""
        there, self._points = bool(self._points), []
        self._under = None
        self._viewport.tool_layer.update()
        return there

    def _update_hit(self, position: QPointF) -> None:
        hit = self._surface.hit(position)
        self._under = None
        if hit is not None:
            a, b, c = self._surface.barycentric_weights(hit).tolist()
            self._under = SurfacePoint(hit.face, (a, b, c))
        self._viewport.tool_layer.update()
