"""Drawing of polylines, polygons and measurements on the tool layer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPainterPath, QPen, QPolygonF

from apd_viewer.ui.scene.camera import Camera

if TYPE_CHECKING:
    from apd_viewer.geometry.measuring.measurement import MeasurementResult

_MARGIN = 0.06  # margin of a plane around the shape, as a fraction of its extent
_PLANE = 40 / 255  # opacity of a plane's fill


def draw_polyline(
    painter: QPainter, line: np.ndarray, colour: QColor, width: float, halo: str | None = None
) -> None:
    """Draw a polyline (k, 2), over a halo if its colour is given."""
    shape = to_polygon(line)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if halo is not None:
        painter.setPen(QPen(with_opacity(halo), width + 2.2, c=Qt.PenCapStyle.FlatCap))
        painter.drawPolyline(shape)
    painter.setPen(QPen(colour, width, c=Qt.PenCapStyle.FlatCap, j=Qt.PenJoinStyle.RoundJoin))
    painter.drawPolyline(shape)


def with_opacity(colour: str | QColor, alpha: float = 0.65) -> QColor:
    """Colour with a changed opacity."""
    clear = QColor(colour)
    clear.setAlphaF(alpha)
    return clear


def axis_rectangle(U: np.ndarray, axis: int, height: float) -> np.ndarray:
    """Corners (4, 3) of a rectangle around ``U`` (n, 3), normal to an axis."""
    low, high = U.min(axis=0), U.max(axis=0)
    pad = _MARGIN * float((high - low).max())
    low, high = low - pad, high + pad
    j, k = (i for i in range(3) if i != axis)
    corners = np.full((4, 3), height)
    corners[:, j] = low[j], high[j], high[j], low[j]
    corners[:, k] = low[k], low[k], high[k], high[k]
    return corners


def draw_plane(
    painter: QPainter,
    camera: Camera,
    corners: np.ndarray,
    colour: QColor,
    halo: QColor,
    style: Qt.PenStyle = Qt.PenStyle.SolidLine,
) -> None:
    """Draw a translucent polygon (k, 3) if it lies in front of the camera."""
    if (camera.depth(corners) <= 0.0).any():
        return
    shape = to_polygon(camera.project(corners))
    painter.setBrush(with_opacity(colour, _PLANE))
    painter.setPen(QPen(halo, 3.0))
    painter.drawPolygon(shape)
    painter.setPen(QPen(colour, 1.6, style))
    painter.drawPolygon(shape)


def to_polygon(points: np.ndarray) -> QPolygonF:
    """Qt polygon of points (k, 2)."""
    return QPolygonF([QPointF(x, y) for x, y in points])


def chosen_runs(points: np.ndarray, chosen: np.ndarray) -> list[np.ndarray]:
    """Runs of consecutive chosen points of a closed polyline.

    Parameters
    ----------
    points : (k, 2) float array
        The last is the first.
    chosen : (k,) bool array
    """
    if chosen.all():
        return [points]
    # Start at an unchosen point, so that no run is split where the polyline closes.
    first = int(np.argmin(chosen[:-1]))
    order = (np.arange(len(points)) + first) % (len(points) - 1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen[order], [False]]).astype(np.int8)))
    # Extend each run by one point at both ends, so that near and far parts join.
    return [points[order[max(a - 1, 0) : b + 1]] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def convex_hull(points: np.ndarray) -> np.ndarray:
    """Ordered corners of the convex hull of points (k, 2)."""
    ordered = points[np.lexsort(points.T[::-1])]

    def chain(sequence: np.ndarray) -> list[np.ndarray]:
        corners: list[np.ndarray] = []
        for p in sequence:
            while len(corners) > 1 and _side(corners[-2], corners[-1], p) <= 0:
                corners.pop()
            corners.append(p)
        return corners[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> float:
    return float((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))


# Dark on a white halo, to be legible on any paint, overlay and background.
_INK, _PALE = QColor("#1d2129"), QColor(255, 255, 255, 215)
_CHOSEN = QColor("#2f6fde")
LIQUID, CAP = QColor(47, 111, 222, 90), QColor(122, 130, 142, 170)
_PAPER = QColor(255, 255, 255, 240)
_BACK = 0.3  # opacity of lines on the far side of the surface
_DOT, _ROOM, _GAP = 3.5, 6.0, 8.0


def fill_contours(painter: QPainter, camera: Camera, segments: np.ndarray, colour: QColor) -> None:
    """Fill the inside of plane contours (s, 2, 3) in front of the camera."""
    if not len(segments) or (camera.depth(segments.reshape(-1, 3)) <= 0.0).any():
        return
    ends = camera.project(segments.reshape(-1, 3)).reshape(-1, 2, 2)
    # A point is inside where an odd number of triangles of one corner and the segments cover it.
    surface = QPainterPath()
    surface.setFillRule(Qt.FillRule.OddEvenFill)
    for p, q in ends:
        surface.addPolygon(to_polygon(np.array([ends[0, 0], p, q, ends[0, 0]])))
    painter.fillPath(surface, colour)


def draw_lines(painter: QPainter, camera: Camera, measured: MeasurementResult, chosen: bool) -> None:
    """Draw the lines of a measurement, faint on the far side of the surface."""
    if not len(measured.segments) or (camera.depth(measured.segments.reshape(-1, 3)) <= 0.0).any():
        return
    front = np.ones(len(measured.segments), dtype=bool)
    if measured.normals is not None:
        towards = camera.position - measured.segments[:, 0]
        front = np.einsum("ij,ij->i", measured.normals, towards) >= 0.0
    ends = camera.project(measured.segments.reshape(-1, 3)).reshape(-1, 2, 2)
    for side, opacity in ((~front, _BACK), (front, 1.0)):
        painter.setOpacity(opacity)
        lines = [QLineF(*p, *q) for p, q in ends[side].tolist()]
        for pen in (
            QPen(_PALE, 5.0 if chosen else 4.2),
            QPen(_CHOSEN if chosen else _INK, 2.4 if chosen else 1.8),
        ):
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawLines(lines)
    painter.setOpacity(1.0)


def draw_points(painter: QPainter, camera: Camera, points: np.ndarray, chosen: bool = False) -> None:
    """Draw a dot at each point (k, 3)."""
    painter.setBrush(_CHOSEN if chosen else _INK)
    painter.setPen(QPen(_PALE, 1.6))
    for point in points[camera.depth(points) > 0.0] if len(points) else ():
        painter.drawEllipse(QPointF(*camera.project(point[None])[0]), _DOT, _DOT)


def draw_labels(
    painter: QPainter, camera: Camera, labels: Sequence[tuple[MeasurementResult, Sequence[str], bool]]
) -> None:
    """Draw text labels beside the measurements, without overlaps.

    Parameters
    ----------
    labels : sequence of (Measured, sequence of str, bool)
        The last is whether it is the chosen one.
    """
    font = QFont(painter.font())
    font.setPixelSize(13)
    font.setWeight(QFont.Weight.Medium)
    painter.setFont(font)
    taken: list[QRectF] = []
    for measured, lines, chosen in labels:
        if measured.label_position is not None and camera.depth(measured.label_position[None])[0] > 0.0:
            room = _avoid_overlap(_label_rectangle(painter, camera, measured, lines), taken)
            taken.append(room)
            _write(painter, room, lines, chosen)


def _label_rectangle(
    painter: QPainter, eye: Camera, measured: MeasurementResult, lines: Sequence[str]
) -> QRectF:
    """Rectangle of a label, placed to cover little of its measurement."""
    metrics = painter.fontMetrics()
    wide = max(metrics.horizontalAdvance(line) for line in lines) + 2 * _ROOM
    tall = len(lines) * metrics.height() + _ROOM
    assert measured.label_position is not None
    at = eye.project(measured.label_position[None])[0]
    aside = np.array(_label_direction(eye, measured, at))
    # The label's nearest corner or side faces the point, so no slanted line runs under the label.
    middle = at + _GAP * aside + np.clip(4.0 * aside, -1.0, 1.0) * [wide / 2, tall / 2]
    left = min(max(middle[0] - wide / 2, 4.0), eye.width - wide - 4.0)
    return QRectF(left, middle[1] - tall / 2, wide, tall)


def _label_direction(eye: Camera, measured: MeasurementResult, at: np.ndarray) -> tuple[float, float]:
    """Unit vector on the screen from a measurement to its label."""
    if measured.label_away_from is not None:
        way = at - eye.project(measured.label_away_from[None])[0]
    else:
        p, q = eye.project(measured.segments[len(measured.segments) // 2])
        way = np.array([p[1] - q[1], q[0] - p[0]])
        way = -way if way[0] < 0.0 else way
    long = float(np.hypot(*way))
    return (float(way[0]) / long, float(way[1]) / long) if long > 0.0 else (1.0, 0.0)


def _avoid_overlap(room: QRectF, taken: Sequence[QRectF]) -> QRectF:
    """Move a label rectangle down until it overlaps no other label."""
    for other in sorted(taken, key=lambda other: other.top()):
        if room.intersects(other):
            room.moveTop(other.bottom() + 3.0)
    return room


def _write(painter: QPainter, room: QRectF, lines: Sequence[str], chosen: bool) -> None:
    painter.setPen(QPen(_CHOSEN if chosen else QColor(29, 33, 41, 110), 1.6 if chosen else 1.0))
    painter.setBrush(_PAPER)
    painter.drawRoundedRect(room, 5, 5)
    painter.setPen(_INK)
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, "\n".join(lines))
