"""Drawing of the dots of a scatter plot, and of the scale of their colours."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QFontMetricsF, QLinearGradient, QPainter, QPen

from apd_viewer.ui.widgets.theme import LIGHT

if TYPE_CHECKING:
    from collections.abc import Callable

    from apd_viewer.ui.plots.chart import Dots, Ramp
    from apd_viewer.ui.widgets.theme import Theme

# Pixels.
DOT = 4.0
_RING = 7.0
_CROSS = 3.5
_BAR, _GAP, _TICK_ROOM = 10.0, 6.0, 26.0
_RIM = 90  # opacity of 255: dots of the lightest colour stay visible, and heaps stay countable


def ink_of(theme: Theme, color: str) -> QColor:
    """Colour of a theme by its name, or #rrggbb."""
    return QColor(color if color.startswith("#") else getattr(theme, color))


def draw_dots(
    painter: QPainter, dots: Dots, places: Callable[[np.ndarray, np.ndarray], np.ndarray], theme: Theme
) -> None:
    """Draw dots, crosses and rings; ``places`` tells points on the axes in pixels."""
    painter.save()
    painter.setPen(QPen(QColor(theme.warm), 1.5))
    for x, y in places(*dots.crosses.T).tolist():
        for way in (_CROSS, -_CROSS):
            painter.drawLine(QPointF(x - _CROSS, y - way), QPointF(x + _CROSS, y + way))
    at = places(dots.x, dots.y)
    seen = np.isfinite(at).all(axis=1)
    painter.setPen(QPen(_rim(theme), 1.0))
    for k in np.flatnonzero(seen).tolist():
        painter.setBrush(QColor(dots.colors[k]))
        painter.drawEllipse(QPointF(*at[k].tolist()), DOT, DOT)
    for k, color in dots.rings:
        if seen[k]:
            painter.setBrush(QColor(dots.colors[k]))
            painter.setPen(QPen(_rim(theme), 1.0))
            painter.drawEllipse(QPointF(*at[k].tolist()), DOT, DOT)
            painter.setBrush(QColor(0, 0, 0, 0))
            painter.setPen(QPen(ink_of(theme, color), 2.5))
            painter.drawEllipse(QPointF(*at[k].tolist()), _RING, _RING)
    painter.restore()


def _rim(theme: Theme) -> QColor:
    """Colour of the rim of a dot."""
    rim = QColor(theme.ink)
    rim.setAlpha(_RIM if theme is LIGHT else 2 * _RIM)
    return rim


def draw_ramp(painter: QPainter, room: QRectF, ramp: Ramp, theme: Theme, metrics: QFontMetricsF) -> QRectF:
    """Draw a scale of colours at the right of a room; return what is left of the room."""
    bar = room.adjusted(0.0, metrics.height(), 0.0, -metrics.height() - 1.5 * _GAP)
    ticks = ramp.axis.ticks(max(1, int(bar.height() / _TICK_ROOM)))
    widest = max((metrics.horizontalAdvance(text) for _, text in ticks), default=0.0)
    bar.setLeft(room.right() - widest - _GAP - _BAR)
    bar.setWidth(_BAR)
    fill = QLinearGradient(bar.bottomLeft(), bar.topLeft())
    for share, color in zip(np.linspace(0.0, 1.0, len(ramp.colors)).tolist(), ramp.colors, strict=True):
        fill.setColorAt(share, QColor(color))
    painter.fillRect(bar, fill)
    painter.setPen(QPen(QColor(theme.line), 1.0))
    painter.drawRect(bar)
    painter.setPen(QColor(theme.quiet))
    for place, text in ticks:
        share = (place - ramp.axis.low) / (ramp.axis.high - ramp.axis.low)
        y = bar.bottom() - share * bar.height() + 0.35 * metrics.ascent()
        painter.drawText(QPointF(bar.right() + _GAP, y), text)
    return room.adjusted(0.0, 0.0, -(widest + 3 * _GAP + _BAR), 0.0)
