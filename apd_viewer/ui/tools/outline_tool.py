"""Selection by an outline on the screen: a box, a lasso or a polygon."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer
from PySide6.QtGui import QColor, QPen, QPolygonF

from apd_viewer.ui.tools.selection_tool import Selector, act_of, begins

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QPainter

    from apd_viewer.geometry.picking.bounding_hierarchy import Boxes
    from apd_viewer.geometry.picking.surface_index import Skin
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


class OutlineSelector(Selector):
    """Tool to select the vertices within an outline, visible ones or all.

    A box and a lasso are dragged. A polygon is clicked, corner by corner, and ended by a double click, by a
    click on its first corner or by Return. Esc gives either up.

    Attributes
    ----------
    preview : QTimer
        Until the cursor rests and the preview is made.
    """

    def __init__(self, viewport: Viewport, surface: Surface, kind: OutlineKind) -> None:
        super().__init__(viewport, surface)
        self._kind = kind
        self._through = False
        self._corners: list[QPointF] = []
        self._cursor = QPointF()
        self._seen: tuple[object, np.ndarray, Boxes] | None = None
        self._foreseen: tuple[object, ...] = ()  # what the latest preview depends on
        self.preview = QTimer(self, singleShot=True, interval=_PAUSE)
        self.preview.timeout.connect(self._foresee)

    @property
    def through(self) -> bool:
        """True if hidden vertices are selected too."""
        return self._through

    @through.setter
    def through(self, on: bool) -> None:
        self._through = on
        self._viewport.overlay.update()

    def press(self, event: QMouseEvent) -> bool:
        """Begin, or set a corner of a polygon."""
        if not self._enabled or self._surface.touchable is None or not begins(event):
            return False
        self._cursor = event.position()
        if self._kind is OutlineKind.POLYGON and self._corners:
            again = event.type() == QEvent.Type.MouseButtonDblClick
            if again or _far(self._cursor, self._corners[0]) <= _CLOSES:
                self._cursor = self._corners[0]  # the click that ends it is no corner
                self._finish()
                return True
        elif not self._corners:
            self.act = act_of(event)
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
        if self._foreseen != self._state() and not self.preview.isActive():
            self.preview.start()  # the mesh or the camera has moved behind it
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
        self._viewport.overlay.update()
        if not self.preview.isActive():
            self.preview.start()

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
        act, vertices, shape = self.act, self._within(), self._shape()
        box = QPolygonF(shape).boundingRect()
        self._end()
        if len(shape) > 2 and max(box.width(), box.height()) >= _SMALLEST:
            self._apply(act, vertices)

    def _end(self) -> None:
        self.preview.stop()
        self._corners = []
        self._viewport.overlay.update()
        self.previewed.emit(None)

    def _within(self) -> np.ndarray:
        """The vertices within the outline."""
        skin, U, eye = self._surface.touchable, self._surface.U, self._viewport.look.eye
        if skin is None or not self._corners:
            return np.empty(0, dtype=np.int64)
        polygon = np.array([[p.x(), p.y()] for p in self._shape()])
        ahead = skin.named[eye.depth(U[skin.named]) > 0.0]
        found = ahead[skin.inside(eye.project(U[ahead]), polygon)]
        return found if self.through else found[self._visible(skin, found)]

    def _visible(self, skin: Skin, vertices: np.ndarray) -> np.ndarray:
        """Mask (k,) of the visible vertices, cached for a view and a shape."""
        key = self._sight
        if self._seen is None or self._seen[0] != key:
            U = self._surface.U
            self._seen = key, np.full(len(U), -1, dtype=np.int8), skin.sights(U)
        _, known, sights = self._seen
        new = vertices[known[vertices] < 0]
        if len(new):
            eye = self._viewport.look.eye
            known[new] = skin.visible(eye.position, self._surface.U, new, sights, _TOUCHING * eye.pixel)
        return known[vertices] == 1


def _far(a: QPointF, b: QPointF) -> float:
    return float(np.hypot(a.x() - b.x(), a.y() - b.y()))
