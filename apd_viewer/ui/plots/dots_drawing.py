"""Drawing of the dots of a scatter plot, and of the scale of their colours."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QLinearGradient, QPainter, QPen, QPixmap

from apd_viewer.ui.plots.chart import ColorBar, Dots
from apd_viewer.ui.widgets.theme import LIGHT, Theme

PixelPositions = Callable[[np.ndarray, np.ndarray], np.ndarray]

# Pixels.
DOT_RADIUS = 4.0
_HALF = 5.0  # side of the stamp of a dot
_RING = 7.0
_CROSS = 3.5
_BAR, _GAP, _TICK_ROOM = 10.0, 6.0, 26.0
_RIM = 90  # opacity of 255: dots of the lightest colour stay visible, and heaps stay countable


def theme_color(theme: Theme, color: str) -> QColor:
    """Colour of a theme by its name, or #rrggbb."""
    return QColor(color if color.startswith("#") else getattr(theme, color))


def draw_dots(painter: QPainter, dots: Dots, pixel_positions: PixelPositions, theme: Theme) -> None:
    """Draw dots and crosses.

    A dot is a stamp at whole pixels: 10,000 take 6 ms, and as ellipses 44.
    """
    painter.save()
    painter.setPen(QPen(QColor(theme.warm), 1.5))
    for x, y in pixel_positions(*dots.crosses.T).tolist():
        for way in (_CROSS, -_CROSS):
            painter.drawLine(QPointF(x - _CROSS, y - way), QPointF(x + _CROSS, y + way))
    scale = painter.device().devicePixelRatioF()
    stamps = {color: _stamp(color, scale, theme) for color in set(dots.colors)}
    at = _at_pixels(pixel_positions(dots.x, dots.y), scale)
    for k in np.flatnonzero(np.isfinite(at).all(axis=1)).tolist():
        x, y = at[k].tolist()
        painter.drawPixmap(QPointF(x - _HALF, y - _HALF), stamps[dots.colors[k]])
    painter.restore()


def draw_rings(
    painter: QPainter, dots: Dots, rings: Mapping[int, str], pixel_positions: PixelPositions, theme: Theme
) -> None:
    """Draw rings of these colours around dots, and these above the others."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    scale = painter.device().devicePixelRatioF()
    marked = list(rings)
    at = _at_pixels(pixel_positions(dots.x[marked], dots.y[marked]), scale)
    for k, (x, y) in zip(marked, at.tolist(), strict=True):
        if np.isfinite([x, y]).all():
            painter.drawPixmap(QPointF(x - _HALF, y - _HALF), _stamp(dots.colors[k], scale, theme))
            painter.setPen(QPen(theme_color(theme, rings[k]), 2.5))
            painter.drawEllipse(QPointF(x, y), _RING, _RING)
    painter.restore()


def _at_pixels(at: np.ndarray, scale: float) -> np.ndarray:
    """Points (n, 2) moved to whole pixels of a screen of this scale."""
    return np.asarray(np.rint(scale * at) / scale)


def _stamp(color: str, scale: float, theme: Theme) -> QPixmap:
    """Picture of a dot for a screen of this scale."""
    stamp = QPixmap(QSize(round(2 * _HALF * scale), round(2 * _HALF * scale)))
    stamp.setDevicePixelRatio(scale)
    stamp.fill(Qt.GlobalColor.transparent)
    painter = QPainter(stamp)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(_rim(theme), 1.0))
    painter.setBrush(QColor(color))
    painter.drawEllipse(QPointF(_HALF, _HALF), DOT_RADIUS, DOT_RADIUS)
    painter.end()
    return stamp


def _rim(theme: Theme) -> QColor:
    """Colour of the rim of a dot."""
    rim = QColor(theme.ink)
    rim.setAlpha(_RIM if theme is LIGHT else 2 * _RIM)
    return rim


def draw_color_bar(
    painter: QPainter, rect: QRectF, color_bar: ColorBar, theme: Theme, metrics: QFontMetricsF
) -> QRectF:
    """Draw a scale of colours at the right of a room; return what is left of the room."""
    bar = rect.adjusted(0.0, metrics.height(), 0.0, -metrics.height() - 1.5 * _GAP)
    ticks = color_bar.axis.ticks(max(1, int(bar.height() / _TICK_ROOM)))
    widest = max((metrics.horizontalAdvance(text) for _, text in ticks), default=0.0)
    bar.setLeft(rect.right() - widest - _GAP - _BAR)
    bar.setWidth(_BAR)
    fill = QLinearGradient(bar.bottomLeft(), bar.topLeft())
    for share, color in zip(
        np.linspace(0.0, 1.0, len(color_bar.colors)).tolist(), color_bar.colors, strict=True
    ):
        fill.setColorAt(share, QColor(color))
    painter.fillRect(bar, fill)
    painter.setPen(QPen(QColor(theme.line), 1.0))
    painter.drawRect(bar)
    painter.setPen(QColor(theme.quiet))
    for place, text in ticks:
        share = (place - color_bar.axis.low) / (color_bar.axis.high - color_bar.axis.low)
        y = bar.bottom() - share * bar.height() + 0.35 * metrics.ascent()
        painter.drawText(QPointF(bar.right() + _GAP, y), text)
    return rect.adjusted(0.0, 0.0, -(widest + 3 * _GAP + _BAR), 0.0)
