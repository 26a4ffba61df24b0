"""Drawing of measurements over the view: lines, points and labels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPen

from apd_viewer.geometry.measuring.measurement import MeasurementResult
from apd_viewer.ui.scene.camera import Camera

# Dark on a white halo: seen on any paint, overlay and background.
_INK, _HALO = QColor("#1d2129"), QColor(255, 255, 255, 215)
_CHOSEN = QColor("#2f6fde")
_PAPER = QColor(255, 255, 255, 240)
_BACK = 0.3  # opacity on the side of the surface that looks away
_DOT, _ROOM, _GAP = 3.5, 6.0, 8.0


def draw_lines(painter: QPainter, camera: Camera, measured: MeasurementResult, chosen: bool) -> None:
    """Draw the lines of a measurement, faint where the surface hides them."""
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
            QPen(_HALO, 5.0 if chosen else 4.2),
            QPen(_CHOSEN if chosen else _INK, 2.4 if chosen else 1.8),
        ):
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawLines(lines)
    painter.setOpacity(1.0)


def draw_points(painter: QPainter, camera: Camera, points: np.ndarray, chosen: bool = False) -> None:
    """Draw a dot at each point (k, 3)."""
    painter.setBrush(_CHOSEN if chosen else _INK)
    painter.setPen(QPen(_HALO, 1.6))
    for point in points[camera.depth(points) > 0.0] if len(points) else ():
        painter.drawEllipse(QPointF(*camera.project(point[None])[0]), _DOT, _DOT)


def draw_labels(
    painter: QPainter, camera: Camera, labels: Sequence[tuple[MeasurementResult, Sequence[str], bool]]
) -> None:
    """Write lines of text beside measurements, none over another.

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
            room = _free(_beside(painter, camera, measured, lines), taken)
            taken.append(room)
            _write(painter, room, lines, chosen)


def _beside(painter: QPainter, eye: Camera, measured: MeasurementResult, lines: Sequence[str]) -> QRectF:
    """Rectangle of a label that covers as little of its measurement as possible."""
    metrics = painter.fontMetrics()
    wide = max(metrics.horizontalAdvance(line) for line in lines) + 2 * _ROOM
    tall = len(lines) * metrics.height() + _ROOM
    assert measured.label_position is not None
    at = eye.project(measured.label_position[None])[0]
    aside = np.array(_aside(eye, measured, at))
    # Its nearest corner, or side, is beside the point: so no slanted line runs under it.
    middle = at + _GAP * aside + np.clip(4.0 * aside, -1.0, 1.0) * [wide / 2, tall / 2]
    left = min(max(middle[0] - wide / 2, 4.0), eye.width - wide - 4.0)
    return QRectF(left, middle[1] - tall / 2, wide, tall)


def _aside(eye: Camera, measured: MeasurementResult, at: np.ndarray) -> tuple[float, float]:
    """Unit vector on the screen from a measurement to its label."""
    if measured.label_away_from is not None:
        way = at - eye.project(measured.label_away_from[None])[0]
    else:
        p, q = eye.project(measured.segments[len(measured.segments) // 2])
        way = np.array([p[1] - q[1], q[0] - p[0]])
        way = -way if way[0] < 0.0 else way
    long = float(np.hypot(*way))
    return (float(way[0]) / long, float(way[1]) / long) if long > 0.0 else (1.0, 0.0)


def _free(room: QRectF, taken: Sequence[QRectF]) -> QRectF:
    """The place, moved down until it covers none that is taken."""
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
