"""Selection by an outline on the screen: a box, a lasso or a polygon."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer
from PySide6.QtGui import QColor, QPen, QPolygonF

from apd_viewer.ui.tools.selection_tool import SelectionTool, may_begin_stroke, stroke_effect

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QPainter

    from apd_viewer.geometry.picking.bounding_hierarchy import BoundingHierarchy
    from apd_viewer.geometry.picking.surface_index import SurfaceIndex
    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.viewport import Viewport

_SMALLEST = 3.0  # pixels across; less is a click
_CLOSES = 9.0  # pixels from the first corner
_NEXT = 2.0  # pixels between the points of a lasso
_PAUSE = 30  # ms between previews
_TOUCHING = 1e-3  # pixels behind a triangle at which a vertex is still on it


class OutlineKind(Enum):
    """Kinds of outline."""

    BOX = "box"
    LASSO = "lasso"
    POLYGON = "polygon"


class OutlineTool(SelectionTool):
    """Tool to select the vertices within an outline, visible ones or all.

    A box and a lasso are dragged. A polygon is clicked, corner by corner, and ended by a double click, by a
    click on its first corner or by Return. Esc gives either up.

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
        self._seen: tuple[object, np.ndarray, BoundingHierarchy] | None = None
        self._foreseen: tuple[object, ...] = ()  # what the latest preview depends on
        self.preview_timer = QTimer(self, singleShot=True, interval=_PAUSE)
        self.preview_timer.timeout.connect(self._foresee)

    @property
    def selects_hidden(self) -> bool:
        """True if hidden vertices are selected too."""
        return self._through

    @selects_hidden.setter
    def selects_hidden(self, on: bool) -> None:
        self._through = on
        self._viewport.tool_layer.update()

    def press(self, event: QMouseEvent) -> bool:
        """Begin, or set a corner of a polygon."""
        if not self._enabled or self._surface.picking_index is None or not may_begin_stroke(event):
            return False
        self._cursor = event.position()
        if self._kind is OutlineKind.POLYGON and self._corners:
            again = event.type() == QEvent.Type.MouseButtonDblClick
            if again or _far(self._cursor, self._corners[0]) <= _CLOSES:
                self._cursor = self._corners[0]  # the click that ends it is no corner
                self._finish()
                return True
        elif not self._corners:
            self.effect = stroke_effect(event)
        self._corners.append(self._cursor)
        self._show()
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Follow the cursor with the outline."""
        if not self._enabled:
            return False
        self._cursor = event.position()
        self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        if not self._corners:
            return True
        if self._kind is OutlineKind.LASSO and _far(self._cursor, self._corners[-1]) >= _NEXT:
            self._corners.append(self._cursor)
        self._show()
        return True

    def release(self, _event: QMouseEvent) -> None:
        """End a box or a lasso."""
        if self._corners and self._kind is not OutlineKind.POLYGON:
            self._finish()

    def finish(self) -> bool:
        """Close a polygon; True if there was one."""
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
            self.preview_timer.start()  # the mesh or the camera has moved behind it
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

    def _foresee(self) -> None:
        self._foreseen = self._state()
        self.previewed.emit(self._within())

    def _state(self) -> tuple[object, ...]:
        return self._through, *self._sight

    def _shape(self) -> list[QPointF]:
        a, b = self._corners[0], self._cursor
        if self._kind is OutlineKind.BOX:
            return [a, QPointF(b.x(), a.y()), b, QPointF(a.x(), b.y())]
        closes = self._kind is OutlineKind.POLYGON and len(self._corners) > 1 and _far(a, b) <= _CLOSES
        return self._corners.copy() if closes or b == self._corners[-1] else [*self._corners, b]

    def _finish(self) -> None:
        act, vertices, shape = self.effect, self._within(), self._shape()
        box = QPolygonF(shape).boundingRect()
        self._end()
        if len(shape) > 2 and max(box.width(), box.height()) >= _SMALLEST:
            self._apply(act, vertices)

    def _end(self) -> None:
        self.preview_timer.stop()
        self._corners = []
        self._viewport.tool_layer.update()
        self.previewed.emit(None)

    def _within(self) -> np.ndarray:
        """The vertices within the outline."""
        skin, U, eye = self._surface.picking_index, self._surface.U, self._viewport.camera_controller.camera
        if skin is None or not self._corners:
            return np.empty(0, dtype=np.int64)
        polygon = np.array([[p.x(), p.y()] for p in self._shape()])
        ahead = skin.representative_vertices[eye.depth(U[skin.representative_vertices]) > 0.0]
        found = ahead[skin.is_inside_polygon(eye.project(U[ahead]), polygon)]
        return found if self.selects_hidden else found[self._visible(skin, found)]

    def _visible(self, skin: SurfaceIndex, vertices: np.ndarray) -> np.ndarray:
        """Mask (k,) of the visible vertices, cached for a view and a shape."""
        key = self._sight
        if self._seen is None or self._seen[0] != key:
            U = self._surface.U
            self._seen = key, np.full(len(U), -1, dtype=np.int8), skin.visibility_tree(U)
        _, known, sights = self._seen
        new = vertices[known[vertices] < 0]
        if len(new):
            eye = self._viewport.camera_controller.camera
            known[new] = skin.visible(
                eye.position, self._surface.U, new, sights, _TOUCHING * eye.pixel_height
            )
        return known[vertices] == 1


def _far(a: QPointF, b: QPointF) -> float:
    return float(np.hypot(a.x() - b.x(), a.y() - b.y()))
