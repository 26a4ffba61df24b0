"""Drawing of the gizmo."""

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPainterPath, QPen

from apd_viewer.ui.scene.camera import rotation, unit_vector
from apd_viewer.ui.tools import gizmo_drag
from apd_viewer.ui.tools.gizmo_drag import GizmoDrag, GizmoFrame
from apd_viewer.ui.tools.polylines import chosen_runs, convex_hull, draw_polyline, to_polygon, with_opacity

# Rose, lime and violet differ in hue from the base blue and the handle vermilion, and in lightness
# from one another, for any kind of colour vision. The letters identify the axes as well.
AXIS_COLOURS = {False: ("#cf2458", "#6f9f0a", "#4b45d1"), True: ("#ff6f97", "#b4e04c", "#8f8bff")}
INK = {False: "#ffffff", True: "#14161a"}  # halo that sets lines off from the background
CENTRE = {False: "#3a3f47", True: "#f2f4f7"}
FADED = 0.16  # opacity of the other gizmo handles during a drag
BACK = 0.34  # opacity of the far half of a ring, and of the stem of an arrow inside the rings


@dataclass(frozen=True)
class GizmoAppearance:
    """Background, highlighted handle and drag used to draw the gizmo.

    Parameters
    ----------
    is_dark : bool
        Whether the background is dark.
    hovered_handle : str or None
        Handle under the cursor.
    """

    is_dark: bool
    hovered_handle: str | None
    drag: GizmoDrag | None

    def opacity(self, handle: str) -> float:
        """Opacity of a gizmo handle, reduced while another is dragged."""
        return FADED if self.drag is not None and self.drag.handle != handle else 1.0

    def width(self, handle: str) -> float:
        """Line width of a gizmo handle, in pixels."""
        return 4.0 if handle in (self.hovered_handle, self.drag and self.drag.handle) else 2.4

    def color(self, handle: str) -> QColor:
        """Colour of a gizmo handle, brighter under the cursor."""
        name = (
            CENTRE[self.is_dark]
            if handle in ("centre", "scale")
            else AXIS_COLOURS[self.is_dark][gizmo_drag.axis_index(handle)]
        )
        color = QColor(name)
        return color.lighter(112) if handle == self.hovered_handle else color


def draw_gizmo(painter: QPainter, frame: GizmoFrame, appearance: GizmoAppearance) -> None:
    """Draw the gizmo, with near arrows over far ones."""
    if not frame.is_visible:
        return
    if appearance.drag is not None:
        _draw_motion(painter, frame, appearance)
    for i, name in enumerate(gizmo_drag.RINGS):
        _draw_ring(painter, frame, appearance, i, name)
    for i, name in enumerate(gizmo_drag.SQUARES):
        _draw_square(painter, frame, appearance, i, name)
    for i in np.argsort(frame.view_cosines):
        _draw_arrow(painter, frame, appearance, int(i), gizmo_drag.ARROWS[i])
    _draw_scale(painter, frame, appearance)
    _draw_centre(painter, frame, appearance)
    painter.setOpacity(1.0)


def draw_hint(painter: QPainter, drag: GizmoDrag, size: tuple[float, float]) -> None:
    """Write the amount of the drag beside the cursor."""
    draw_tag(painter, drag.text, drag.last, size)


def draw_tag(painter: QPainter, text: str, at: tuple[float, float], size: tuple[float, float]) -> None:
    """Write a caption beside a pixel position, inside a view of the given size."""
    font = QFont(painter.font())
    font.setPixelSize(13)
    font.setWeight(QFont.Weight.DemiBold)
    painter.setFont(font)
    width = painter.fontMetrics().horizontalAdvance(text) + 20.0
    x = min(at[0] + 18, size[0] - width - 8)
    y = min(at[1] + 18, size[1] - 34)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(24, 26, 30, 225))
    painter.drawRoundedRect(QRectF(x, y, width, 26), 7, 7)
    painter.setPen(QColor("#ffffff"))
    painter.drawText(QRectF(x, y, width, 26), Qt.AlignmentFlag.AlignCenter, text)


def _draw_ring(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance, i: int, name: str) -> None:
    if not frame.is_usable(name):
        return
    points, near = frame.ring(i)
    painter.setOpacity(look.opacity(name) * BACK)
    for part in chosen_runs(points, ~near):
        draw_polyline(painter, part, look.color(name), look.width(name) - 0.8)
    painter.setOpacity(look.opacity(name))
    for part in chosen_runs(points, near):
        draw_polyline(painter, part, look.color(name), look.width(name), INK[look.is_dark])


def _draw_square(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance, i: int, name: str) -> None:
    if not frame.is_usable(name):
        return
    visible = min(1.0, (abs(frame.view_cosines[i]) - gizmo_drag.EDGE_ON) / 0.1)
    painter.setOpacity(look.opacity(name) * visible)
    color = look.color(name)
    fill = QColor(color)
    fill.setAlphaF(0.75 if name in (look.hovered_handle, look.drag and look.drag.handle) else 0.38)
    painter.setPen(QPen(color, 1.4))
    painter.setBrush(fill)
    painter.drawPolygon(to_polygon(frame.square(i)))


def _draw_arrow(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance, i: int, name: str) -> None:
    if not frame.is_usable(name):
        return
    start, end, _, letter = frame.arrow(i)
    visible = min(1.0, (gizmo_drag.ALONG_VIEW - abs(frame.view_cosines[i])) / 0.06)
    color = look.color(name)
    painter.setOpacity(look.opacity(name) * visible * BACK)
    draw_polyline(painter, np.array([frame.stem_foot(i), start]), color, 1.4)
    painter.setOpacity(look.opacity(name) * visible)
    draw_polyline(painter, np.array([start, end]), color, look.width(name), INK[look.is_dark])
    painter.setPen(QPen(QColor(INK[look.is_dark]), 1.2))
    painter.setBrush(color)
    painter.drawPolygon(to_polygon(convex_hull(frame.tip(i))))
    if len(frame.offered_handles) > 1:  # a single arrow needs no name
        _draw_letter(painter, name.upper(), letter, color, INK[look.is_dark])


def _draw_letter(painter: QPainter, letter: str, at: np.ndarray, color: QColor, halo: str) -> None:
    font = QFont(painter.font())
    font.setPixelSize(13)
    font.setWeight(QFont.Weight.Bold)
    path = QPainterPath()
    path.addText(0, 0, font, letter)
    path.translate(QPointF(*at) - path.boundingRect().center())
    painter.strokePath(path, QPen(with_opacity(halo), 3.0, j=Qt.PenJoinStyle.RoundJoin))
    painter.fillPath(path, color)


def _draw_scale(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance) -> None:
    if not frame.is_usable("scale"):
        return
    hot = "scale" in (look.hovered_handle, look.drag and look.drag.handle)
    painter.setOpacity(look.opacity("scale"))
    corner = frame.scale_corner if look.drag is None or not hot else np.array(look.drag.last)
    half = 5.5 if hot else 4.5
    way = (corner - frame.screen_centre) / np.linalg.norm(corner - frame.screen_centre)
    rim = frame.camera.overlay_scale * gizmo_drag.RING_RADIUS + 6.0
    ends = np.array([frame.screen_centre + rim * way, corner - 8.0 * way])
    draw_polyline(painter, ends, look.color("scale"), 1.4, INK[look.is_dark])
    painter.setPen(QPen(QColor(INK[look.is_dark]), 1.5))
    painter.setBrush(look.color("scale"))
    painter.drawRoundedRect(QRectF(corner[0] - half, corner[1] - half, 2 * half, 2 * half), 1.5, 1.5)


def _draw_centre(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance) -> None:
    if not frame.is_usable("centre"):
        return
    hot = "centre" in (look.hovered_handle, look.drag and look.drag.handle)
    painter.setOpacity(look.opacity("centre"))
    painter.setPen(QPen(QColor(INK[look.is_dark]), 1.5))
    painter.setBrush(look.color("centre"))
    radius = gizmo_drag.DOT_RADIUS + 1.5 if hot else gizmo_drag.DOT_RADIUS
    painter.drawEllipse(QPointF(*frame.to_screen(np.zeros((1, 3)))[0]), radius, radius)


def _draw_motion(painter: QPainter, frame: GizmoFrame, look: GizmoAppearance) -> None:
    """Draw the extent of the drag: a slice of the ring, or a line from its start."""
    drag = look.drag
    if drag is None:
        return
    color = look.color(drag.handle)
    if drag.handle in gizmo_drag.RINGS:
        _draw_slice(painter, frame, drag, color)
        return
    if drag.handle in gizmo_drag.ARROWS:
        reach = min(2000 * frame.pixel_length, 0.8 * float(frame.camera.depth(frame.centre)))
        line = frame.camera.project(frame.centre + np.outer([-reach, reach], drag.axis))
        painter.setPen(QPen(with_opacity(color, 0.35), 1.2))
        painter.drawPolyline(to_polygon(line))
    ends = frame.camera.project(np.array([drag.frame.centre, frame.centre]))
    painter.setPen(QPen(color, 1.6, Qt.PenStyle.DotLine))
    painter.drawPolyline(to_polygon(ends))
    painter.setPen(QPen(color, 1.6))
    painter.setBrush(with_opacity(INK[look.is_dark]))
    painter.drawEllipse(QPointF(*ends[0]), 4, 4)


def _draw_slice(painter: QPainter, frame: GizmoFrame, drag: GizmoDrag, color: QColor) -> None:
    spoke = gizmo_drag.offset_in_plane(drag.frame, drag.axis, *drag.start)
    if spoke is None or abs(drag.frame.view_cosines[gizmo_drag.axis_index(drag.handle)]) < gizmo_drag.EDGE_ON:
        towards = frame.camera.position - frame.centre
        spoke = towards - (towards @ drag.axis) * drag.axis
    spoke = gizmo_drag.RING_RADIUS * frame.pixel_length * unit_vector(spoke)
    angles = np.linspace(0.0, np.clip(drag.snapped_angle, -2 * np.pi, 2 * np.pi), 65)
    rim = np.array([rotation(drag.axis, a) @ spoke for a in angles])
    points = frame.camera.project(frame.centre + np.vstack([np.zeros((1, 3)), rim]))
    painter.setPen(QPen(color, 1.4))
    painter.setBrush(with_opacity(color, 0.34))
    painter.drawPolygon(to_polygon(points))
