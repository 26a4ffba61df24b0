"""Selection by outlines on the screen, and between two planes."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen, QPolygonF, QWheelEvent

from apd_viewer.ui.scene.pointing import WheelSteps
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.gizmo_drag import GizmoFrame, position_along_axis
from apd_viewer.ui.tools.polylines import axis_rectangle, draw_plane
from apd_viewer.ui.tools.selection_tool import SelectionTool, may_begin_stroke, stroke_effect

if TYPE_CHECKING:
    from apd_viewer.geometry.picking.bounding_hierarchy import BoundingVolumeHierarchy
    from apd_viewer.geometry.picking.surface_index import SurfaceIndex

_SMALLEST = 3.0  # px: smallest extent of an outline; a smaller one is a click
_CLOSES = 9.0  # px: a click this close to the first corner closes the polygon
_NEXT = 2.0  # px: spacing of lasso points
_PAUSE = 30  # ms between previews
_TOUCHING = 1e-3  # px: depth tolerance of the visibility test


class OutlineKind(Enum):
    """Kind of outline on the screen."""

    BOX = "box"
    LASSO = "lasso"
    POLYGON = "polygon"


class OutlineTool(SelectionTool):
    """Tool to select the vertices within an outline, visible ones or all.

    A box and a lasso are dragged. A polygon is clicked corner by corner, and closed by a double click, by a
    click on its first corner or by Return. Esc cancels the outline.

    Attributes
    ----------
    preview_timer : QTimer
        Until the cursor rests and the preview is made.
    """

    def __init__(self, viewport: Viewport, surface: Surface, kind: OutlineKind) -> None:
        super().__init__(viewport, surface)
        self._kind = kind
        self._through = False
        self._corners: list[QPointF] = []
        self._cursor = QPointF()
        self._seen: tuple[object, np.ndarray, BoundingVolumeHierarchy] | None = None
        self._foreseen: tuple[object, ...] = ()  # inputs of the latest preview
        self.preview_timer = QTimer(self, singleShot=True, interval=_PAUSE, timeout=self._preview)

    @property
    def selects_hidden_vertices(self) -> bool:
        """True if vertices behind other surfaces are selected, too."""
        return self._through

    @selects_hidden_vertices.setter
    def selects_hidden_vertices(self, on: bool) -> None:
        self._through = on
        self._viewport.tool_layer.update()

    def press(self, event: QMouseEvent) -> bool:
        """Begin an outline, or add a corner to a polygon."""
        if not self._enabled or self._surface.picking_index is None or not may_begin_stroke(event):
            return False
        self._cursor = event.position()
        if self._kind is OutlineKind.POLYGON and self._corners:
            again = event.type() == QEvent.Type.MouseButtonDblClick
            if again or _distance(self._cursor, self._corners[0]) <= _CLOSES:
                self._cursor = self._corners[0]  # the closing click adds no corner
                self._finish()
                return True
        elif not self._corners:
            self.effect = stroke_effect(event)
        self._corners.append(self._cursor)
        self._show()
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Extend the outline to the cursor."""
        if not self._enabled:
            return False
        self._cursor = event.position()
        self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        if not self._corners:
            return True
        if self._kind is OutlineKind.LASSO and _distance(self._cursor, self._corners[-1]) >= _NEXT:
            self._corners.append(self._cursor)
        self._show()
        return True

    def release(self, _event: QMouseEvent) -> None:
        """End a box or a lasso."""
        if self._corners and self._kind is not OutlineKind.POLYGON:
            self._finish()

    def finish(self) -> bool:
        """Close and apply a polygon; True if there was one."""
        if self._kind is not OutlineKind.POLYGON or not self._corners:
            return False
        self._finish()
        return True

    def cancel(self) -> bool:
        """Cancel the outline; True if there was one."""
        if not self._corners:
            return False
        self._end()
        self.stroke_cancelled.emit()
        return True

    def paint(self, painter: QPainter) -> None:
        """Draw the outline."""
        if not self._corners:
            return
        if self._foreseen != self._state() and not self.preview_timer.isActive():
            self.preview_timer.start()  # the mesh or the camera has changed under the outline
        shape = QPolygonF(self._shape())
        fill = QColor(self._color)
        fill.setAlpha(36)
        painter.setBrush(fill)
        for color, width in ((self._halo, 3.4), (self._color, 1.6)):
            painter.setPen(QPen(color, width, self._pen_style))
            painter.drawPolygon(shape)
            painter.setBrush(Qt.BrushStyle.NoBrush)
        if self._kind is OutlineKind.POLYGON:
            painter.setBrush(self._color)
            painter.setPen(QPen(self._halo, 1.2))
            for corner in self._corners:
                painter.drawEllipse(corner, 3.5, 3.5)

    def _show(self) -> None:
        self._viewport.tool_layer.update()
        if not self.preview_timer.isActive():
            self.preview_timer.start()

    def _preview(self) -> None:
        self._foreseen = self._state()
        self.previewed.emit(self._vertices_inside())

    def _state(self) -> tuple[object, ...]:
        return self._through, *self._view_key

    def _shape(self) -> list[QPointF]:
        a, b = self._corners[0], self._cursor
        if self._kind is OutlineKind.BOX:
            return [a, QPointF(b.x(), a.y()), b, QPointF(a.x(), b.y())]
        closes = self._kind is OutlineKind.POLYGON and len(self._corners) > 1 and _distance(a, b) <= _CLOSES
        return self._corners.copy() if closes or b == self._corners[-1] else [*self._corners, b]

    def _finish(self) -> None:
        act, vertices, shape = self.effect, self._vertices_inside(), self._shape()
        box = QPolygonF(shape).boundingRect()
        self._end()
        if len(shape) > 2 and max(box.width(), box.height()) >= _SMALLEST:
            self._apply(act, vertices)

    def _end(self) -> None:
        self.preview_timer.stop()
        self._corners = []
        self._viewport.tool_layer.update()
        self.previewed.emit(None)

    def _vertices_inside(self) -> np.ndarray:
        """Selectable vertices within the outline."""
        skin, U, eye = self._surface.picking_index, self._surface.U, self._viewport.camera_controller.camera
        if skin is None or not self._corners:
            return np.empty(0, dtype=np.int64)
        polygon = np.array([[p.x(), p.y()] for p in self._shape()])
        ahead = skin.representative_vertices[eye.depth(U[skin.representative_vertices]) > 0.0]
        found = ahead[skin.is_inside_polygon(eye.project(U[ahead]), polygon)]
        return found if self.selects_hidden_vertices else found[self._visible(skin, found)]

    def _visible(self, skin: SurfaceIndex, vertices: np.ndarray) -> np.ndarray:
        """Visibility mask (k,) of ``vertices``, cached per view and shape."""
        key = self._view_key
        if self._seen is None or self._seen[0] != key:
            U = self._surface.U
            self._seen = key, np.full(len(U), -1, dtype=np.int8), skin.visibility_tree(U)
        _, known, sights = self._seen
        new = vertices[known[vertices] < 0]
        if len(new):
            eye = self._viewport.camera_controller.camera
            known[new] = skin.is_visible(
                eye.position, self._surface.U, new, sights, _TOUCHING * eye.pixel_height
            )
        return known[vertices] == 1


def _distance(a: QPointF, b: QPointF) -> float:
    return float(np.hypot(a.x() - b.x(), a.y() - b.y()))


class SlabTool(SelectionTool):
    """Tool to select the vertices between the planes at start and end of a drag.

    The planes are perpendicular to an axis, which the wheel changes. A drag begins on the mesh and may end
    beyond it.

    Attributes
    ----------
    axis : int
        0, 1 or 2.
    planes_moved : Signal(float, float)
        Positions of the two planes along the axis.
    preview_timer : QTimer
        Until the cursor rests and the preview is made.
    """

    axis_changed = Signal(int)
    planes_moved = Signal(float, float)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport, surface)
        self.axis = 1
        self._wheel = WheelSteps()
        self._here: np.ndarray | None = None  # surface point under the cursor
        self._start: np.ndarray | None = None
        self._end = 0.0
        self._pressed = QPointF()
        self._dragged = False
        self.preview_timer = QTimer(self, singleShot=True, interval=_PAUSE)
        self.preview_timer.timeout.connect(lambda: self.previewed.emit(self._vertices_between()))

    def press(self, event: QMouseEvent) -> bool:
        """Set the first plane."""
        if not self._enabled or not may_begin_stroke(event):
            return False
        self._update_hit(event)
        if self._here is None:
            return False
        self.effect, self._start = stroke_effect(event), self._here
        self._end = float(self._start[self.axis])
        self._pressed, self._dragged = event.position(), False
        self._show()
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Drag the second plane, or preview the first."""
        if not self._enabled:
            return False
        if self._start is None:
            self._update_hit(event)
            self._viewport.tool_layer.update()
            return self._here is not None
        frame = GizmoFrame(self._viewport.camera_controller.camera, self._start, np.eye(3))
        way = position_along_axis(frame, self.axis, event.position().x(), event.position().y())
        if way is not None:
            self._end = float(self._start[self.axis]) + way
        self._dragged |= (event.position() - self._pressed).manhattanLength() >= _SMALLEST
        self._show()
        return True

    def release(self, _event: QMouseEvent) -> None:
        """Select the vertices between the planes."""
        if self._start is not None:
            act, vertices = self.effect, self._vertices_between()
            self._finish()
            if self._dragged:
                self._apply(act, vertices)

    def wheel(self, event: QWheelEvent) -> bool:
        """Switch to the next axis."""
        if not self._enabled or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        if self._start is None and (steps := self._wheel.take(event)):
            self.axis = (self.axis - steps) % 3
            self._viewport.tool_layer.update()
            self.axis_changed.emit(self.axis)
        return True

    def leave(self) -> None:
        """Hide the planes."""
        if self._start is None and self._here is not None:
            self._here = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Cancel the drag; True if there was one."""
        if self._start is None:
            return False
        self._finish()
        self.stroke_cancelled.emit()
        return True

    def paint(self, painter: QPainter) -> None:
        """Draw the planes."""
        if self._start is not None:
            ends = {float(self._start[self.axis]), self._end}
        elif self._here is not None:
            ends = {float(self._here[self.axis])}
        else:
            return
        for height in sorted(ends):
            corners = axis_rectangle(self._surface.U, self.axis, height)
            draw_plane(
                painter,
                self._viewport.camera_controller.camera,
                corners,
                self._color,
                self._halo,
                self._pen_style,
            )

    def _update_hit(self, event: QMouseEvent) -> None:
        hit = self._surface.hit(event.position())
        self._here = None if hit is None else hit.point
        if hit is not None:
            self.effect = stroke_effect(event)
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)

    def _show(self) -> None:
        self._viewport.tool_layer.update()
        if self._start is not None:
            self.planes_moved.emit(*sorted((float(self._start[self.axis]), self._end)))
        if not self.preview_timer.isActive():
            self.preview_timer.start()

    def _finish(self) -> None:
        self.preview_timer.stop()
        self._start = self._here = None
        self._viewport.tool_layer.update()
        self.previewed.emit(None)

    def _vertices_between(self) -> np.ndarray:
        skin = self._surface.picking_index
        if self._start is None or skin is None:
            return np.empty(0, dtype=np.int64)
        low, high = sorted((float(self._start[self.axis]), self._end))
        along = self._surface.U[skin.representative_vertices, self.axis]
        return skin.representative_vertices[(low <= along) & (along <= high)]
