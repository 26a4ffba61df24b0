"""Picking of obstacles: names on hover, selection and dragging."""

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent, QPainter

from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.ui.obstacles.obstacle_scene import DrawnObstacle
from apd_viewer.ui.obstacles.obstacle_shapes import ShapeExtent, axes_along, drawing_anchor, plate_half_sides
from apd_viewer.ui.scene.navigation import DEAD_ZONE, MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.tools.gizmo_drawing import draw_tag


class ObstaclePicker(MouseTool, QObject):
    """Mouse tool to select an obstacle by pressing it.

    A drag from a plate orbits the camera, as plates are large; a click selects the plate.

    Parameters
    ----------
    surface : Surface
        Surface that hides obstacles behind it from the mouse.
    gizmo : Gizmo
        Drags the obstacle taken.

    Attributes
    ----------
    chosen : Signal(int)
        Number of the obstacle that was pressed.
    hovered : Signal(object)
        Number of the obstacle under the cursor, or None.
    """

    chosen = Signal(int)
    hovered = Signal(object)

    def __init__(self, viewport: Viewport, surface: Surface, gizmo: Gizmo) -> None:
        super().__init__(viewport)
        self._viewport, self._surface, self._gizmo = viewport, surface, gizmo
        self.enabled = False
        self._shown: Sequence[DrawnObstacle] = ()
        self._extent = ShapeExtent(np.zeros(3), np.ones(3))
        self._hot: int | None = None
        self._cursor = 0.0, 0.0
        self._pressed: tuple[int, QPointF] | None = None

    def set_obstacles(self, obstacles: Sequence[DrawnObstacle], extent: ShapeExtent) -> None:
        """Set the obstacles to pick from."""
        self._shown, self._extent = obstacles, extent
        if self._hot is not None and self._hot >= len(obstacles):
            self._hover(None)

    def press(self, event: QMouseEvent) -> bool:
        """Select and drag a round obstacle, or wait for a click on a plate."""
        self._pressed = None
        pans = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        k = self.obstacle_at(event.position()) if self.enabled else None
        if k is None or pans or event.button() != Qt.MouseButton.LeftButton:
            return False
        if self._shown[k].obstacle.kind is ObstacleKind.PLATE:
            self._pressed = k, event.position()
            return False
        self.chosen.emit(k)
        self._gizmo.begin_drag(event.position())
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Drag the pressed obstacle, or show the name of the one under the cursor."""
        if self._gizmo.is_dragged:
            return self._gizmo.move(event)
        if event.type() == QEvent.Type.MouseButtonRelease:
            self._click(event.position())
        self._cursor = event.position().x(), event.position().y()
        k = self.obstacle_at(event.position()) if self.enabled else None
        self._hover(k)
        if k is not None:
            self._viewport.setCursor(Qt.CursorShape.PointingHandCursor)
            self._viewport.tool_layer.update()
        return k is not None

    def _click(self, position: QPointF) -> None:
        pressed, self._pressed = self._pressed, None
        if pressed is not None and (position - pressed[1]).manhattanLength() <= DEAD_ZONE:
            self.chosen.emit(pressed[0])

    def release(self, event: QMouseEvent) -> None:
        """Release the dragged obstacle."""
        self._gizmo.release(event)

    def leave(self) -> None:
        """Hide the name of the obstacle when the cursor leaves the view."""
        self._hover(None)

    def paint(self, painter: QPainter) -> None:
        """Draw the name of the obstacle under the cursor."""
        if self._hot is not None and self._hot < len(self._shown) and not self._gizmo.is_dragged:
            size = self._viewport.width(), self._viewport.height()
            draw_tag(painter, self._shown[self._hot].obstacle.name, self._cursor, size)

    def obstacle_at(self, position: QPointF, solid_only: bool = False) -> int | None:
        """Number of the obstacle at a position if in front of the surface, or None."""
        origin, way = self._viewport.camera_controller.camera.ray(position.x(), position.y())
        reached = [
            np.inf
            if solid_only and each.obstacle.kind is ObstacleKind.PLATE
            else ray_distance(each.obstacle, each.shift, self._extent, origin, way)
            for each in self._shown
        ]
        if not np.isfinite(reached).any():
            return None
        k, hit = int(np.argmin(reached)), self._surface.hit(position)
        if hit is not None and float((hit.point - origin) @ way) < reached[k]:
            return None
        return k

    def _hover(self, k: int | None) -> None:
        if k != self._hot:
            self._hot = k
            self._viewport.tool_layer.update()
            self.hovered.emit(k)


def ray_distance(
    obstacle: NamedObstacle, shift: np.ndarray, extent: ShapeExtent, origin: np.ndarray, direction: np.ndarray
) -> float:
    """Distance to an obstacle along a ray with unit ``direction``, or infinity."""
    at = origin - drawing_anchor(obstacle, shift, extent)
    axes = axes_along(obstacle.axis)
    start, step = axes @ at, axes @ direction
    if obstacle.kind is ObstacleKind.PLATE:
        t = -start[2] / step[2] if step[2] else np.inf
        within = t > 0.0 and (np.abs(start + t * step)[:2] <= plate_half_sides(axes, extent)).all()
        return float(t) if within else np.inf
    half = 0.5 * obstacle.length if obstacle.kind is ObstacleKind.CYLINDER else 0.0
    return _capsule_distance(start, step, half, obstacle.radius)


def _capsule_distance(start: np.ndarray, step: np.ndarray, half: float, radius: float) -> float:
    """Distance along a ray to a capsule with axis z, or infinity."""
    ends = [_sphere_distance(start - [0.0, 0.0, z], step, radius) for z in (-half, half)]
    t = _smaller_root(step[:2] @ step[:2], start[:2] @ step[:2], start[:2] @ start[:2] - radius**2)
    side = t if t > 0.0 and abs(start[2] + t * step[2]) <= half else np.inf
    return min(*ends, side)


def _sphere_distance(start: np.ndarray, step: np.ndarray, radius: float) -> float:
    t = _smaller_root(step @ step, start @ step, start @ start - radius**2)
    return t if t > 0.0 else np.inf


def _smaller_root(a: float, b: float, c: float) -> float:
    """Smaller root of a t² + 2 b t + c, or infinity without a real root."""
    rest = b * b - a * c
    return float((-b - np.sqrt(rest)) / a) if a > 0.0 and rest >= 0.0 else np.inf
