"""Axes in a corner of the view, showing its orientation; a click turns the view."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAction, QColor, QFont, QMouseEvent, QPainter, QPen

from apd_viewer.ui.preferences.action_maker import without_mnemonic
from apd_viewer.ui.scene.navigation import DEAD_ZONE, MouseTool
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.gizmo_drawing import AXIS_COLOURS, CENTRE, INK

# px in a large view: distance of the centre from the right and upper edge, and lengths
CORNER, _REACH, _BALL, _LETTER = 58.0, 34.0, 9.0, 12.0
_VIEWS = "side", "top", "front"  # rows of the frame of an up axis
_FAR = 0.4  # reduction of the opacity of the farthest end


class AxisEnd(NamedTuple):
    """End of an axis: view, direction (3,), position in the viewport, depth (-1 to 1)."""

    view: str
    direction: np.ndarray
    place: QPointF
    depth: float

    @property
    def axis(self) -> int:
        """Index of the axis: 0, 1 or 2."""
        return int(np.abs(self.direction).argmax())

    @property
    def is_positive(self) -> bool:
        """True if the coordinate grows outwards."""
        return bool(self.direction[self.axis] > 0.0)


class OrientationAxes(MouseTool):
    """Axes of the mesh; a click on an end looks along it, a drag orbits.

    A click on the end that points to the viewer looks from behind.

    Attributes
    ----------
    views : dict of str to QAction
        Actions of the six views; without them nothing is drawn.
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self.views: dict[str, QAction] = {}
        self._visible = True
        self._hot: str | None = None
        self._pressed: AxisEnd | None = None
        self._start = self._last = QPointF()

    @property
    def visible(self) -> bool:
        """True while the axes are shown."""
        return self._visible

    @visible.setter
    def visible(self, on: bool) -> None:
        self._visible = on
        self._viewport.tool_layer.update()

    @property
    def ends(self) -> list[AxisEnd]:
        """All six ends, the farthest first; empty while hidden."""
        if not (self._visible and self.views):
            return []
        eye = self._viewport.camera_controller.camera
        ends = []
        for row, view in enumerate(_VIEWS):
            for sign, name in ((1.0, view), (-1.0, f"-{view}")):
                direction = sign * eye.up_axis.frame[row]
                right, up, depth = (eye.axes @ direction).tolist()
                place = self._centre + QPointF(right, -up) * (self._scale * _REACH)
                ends.append(AxisEnd(name, direction, place, depth))
        return sorted(ends, key=lambda end: -end.depth)

    @property
    def _scale(self) -> float:
        return self._viewport.camera_controller.camera.overlay_scale

    @property
    def _centre(self) -> QPointF:
        return QPointF(self._viewport.width() - self._scale * CORNER, self._scale * CORNER)

    def _end_at(self, position: QPointF) -> AxisEnd | None:
        """Nearest end to the viewer under a position."""
        for end in reversed(self.ends):
            away = position - end.place
            if np.hypot(away.x(), away.y()) <= self._scale * _BALL + 1.0:
                return end
        return None

    def press(self, event: QMouseEvent) -> bool:
        """Begin a click on the axis end under the cursor."""
        end = self._end_at(event.position())
        if end is None or event.button() != Qt.MouseButton.LeftButton:
            return False
        self._pressed, self._start, self._last = end, event.position(), event.position()
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Highlight the end under the cursor, or orbit."""
        at = event.position()
        if not event.buttons():
            end = self._end_at(at)
            self._show(None if end is None else end.view)
            return end is not None
        if self._pressed is not None and (at - self._start).manhattanLength() <= DEAD_ZONE:
            return True
        self._pressed = None  # a drag, no longer a click
        look, by = self._viewport.camera_controller, at - self._last
        look.camera = look.camera.orbited(by.x(), by.y())
        self._last = at
        return True

    def release(self, _event: QMouseEvent) -> None:
        """Look along the clicked axis, or from behind if that is the view already."""
        end, self._pressed = self._pressed, None
        if end is None:
            return
        opposite = end.view.removeprefix("-") if end.view.startswith("-") else f"-{end.view}"
        self.views[opposite if end.depth < -1.0 + 1e-6 else end.view].trigger()

    def leave(self) -> None:
        """Remove the highlight."""
        self._show(None)

    def cancel(self) -> bool:
        """Cancel a press; True if there was one."""
        pressed, self._pressed = self._pressed, None
        return pressed is not None

    def _show(self, view: str | None) -> None:
        if view is not None:
            self._viewport.setCursor(Qt.CursorShape.PointingHandCursor)
        if view != self._hot:
            self._hot = view
            self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the axes, and the name of the view under the cursor."""
        painter.save()
        font = QFont(painter.font())
        font.setBold(True)
        font.setPixelSize(round(self._scale * _LETTER))
        painter.setFont(font)
        for end in self.ends:
            self._draw_end(painter, end)
            if end.view == self._hot:
                self._write_name(painter, end)
        painter.restore()

    def _draw_end(self, painter: QPainter, end: AxisEnd) -> None:
        scale, dark, is_hot = self._scale, self._viewport.is_dark, end.view == self._hot
        color = QColor(AXIS_COLOURS[dark][end.axis])
        painter.setOpacity(1.0 if is_hot else 1.0 - _FAR * max(0.0, end.depth))
        painter.setPen(QPen(color, 2.4 * scale, c=Qt.PenCapStyle.RoundCap))
        if end.is_positive:
            painter.drawLine(self._centre, end.place)
        pale = QColor(color)
        pale.setAlphaF(0.22)
        painter.setPen(QPen(QColor(CENTRE[dark]) if is_hot else color, (2.0 if is_hot else 1.4) * scale))
        painter.setBrush(color if end.is_positive or is_hot else pale)
        painter.drawEllipse(end.place, scale * _BALL, scale * _BALL)
        if end.is_positive or is_hot:
            painter.setPen(QColor(INK[dark]))
            side = 2.0 * scale * _BALL
            box = QRectF(end.place.x() - side / 2, end.place.y() - side / 2, side, side)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "XYZ"[end.axis])

    def _write_name(self, painter: QPainter, end: AxisEnd) -> None:
        """Write the name of the view to the left of the axes."""
        painter.setOpacity(1.0)
        painter.setPen(QColor(CENTRE[self._viewport.is_dark]))
        width = self._scale * (_REACH + 2.0 * _BALL)
        box = QRectF(0.0, self._centre.y() - 20.0, self._centre.x() - width, 40.0)
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        painter.drawText(box, right, without_mnemonic(self.views[end.view].text()))
