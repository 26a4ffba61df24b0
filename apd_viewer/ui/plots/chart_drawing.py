"""Drawing of charts, on a screen as in a file.

They are drawn by hand: docs/architecture.md says what pyqtgraph costs.
"""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen, QPolygonF

from apd_viewer.presentation.axis import Axis
from apd_viewer.ui.plots.chart import Bars, Chart, Curve, ReferenceLine
from apd_viewer.ui.plots.dots_drawing import draw_color_bar, draw_dots, theme_color
from apd_viewer.ui.widgets.theme import Theme

# Pixels.
_PAD = 8.0
_GAP = 6.0
_ROW = 1.25  # heights of a line of text
_BETWEEN_X, _BETWEEN_Y = 64.0, 26.0


def draw_chart(painter: QPainter, rect: QRectF, chart: Chart, theme: Theme, font: QFont) -> ChartArea | None:
    """Draw a chart into a ``rect``, in the colours of a theme.

    Returns the field between its axes, None where there is nothing to be seen.
    """
    found = None
    painter.save()
    painter.setClipRect(rect)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    font = with_tabular_figures(font)
    painter.setFont(font)
    metrics = QFontMetricsF(font)
    row = _ROW * metrics.height()
    inner = rect.adjusted(_PAD, _GAP, -_PAD, -_GAP)
    _draw_words(painter, inner, chart, theme, row)
    words = 2 * row if chart.title else row if chart.readings else 0.0
    if chart.x is None or chart.y is None:
        painter.setPen(QColor(theme.quiet))
        below = inner.adjusted(0, words / 2, 0, 0)
        painter.drawText(below, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, chart.empty_text)
    else:
        below = inner.adjusted(0, words, 0, 0)
        if chart.color_bar is not None:
            below = draw_color_bar(painter, below, chart.color_bar, theme, metrics)
        found = ChartArea(painter, below, chart.x, chart.y, theme, metrics)
        found.draw(chart)
    painter.restore()
    return found


def with_tabular_figures(font: QFont) -> QFont:
    """The font with tabular figures."""
    font = QFont(font)
    font.setFeature(QFont.Tag("tnum"), 1)
    return font


def _draw_words(painter: QPainter, room: QRectF, chart: Chart, theme: Theme, row: float) -> None:
    """Draw the title, and the readings under it, elided to fit."""
    bold = QFont(painter.font())
    bold.setWeight(QFont.Weight.DemiBold)
    painter.save()
    painter.setFont(bold)
    painter.setPen(QColor(theme.quiet))
    title = QFontMetricsF(bold).elidedText(chart.title, Qt.TextElideMode.ElideRight, room.width())
    painter.drawText(QPointF(room.left(), room.top() + 0.75 * row), title)
    painter.restore()
    metrics, x = QFontMetricsF(painter.font()), room.left()
    baseline = room.top() + (1.75 if chart.title else 0.75) * row
    for text, color in chart.readings:
        shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, max(0.0, room.right() - x))
        painter.setPen(theme_color(theme, color))
        painter.drawText(QPointF(x, baseline), shown)
        x += metrics.horizontalAdvance(text) + 2 * _GAP


class ChartArea:
    """The field between two axes, and its contents."""

    def __init__(
        self, painter: QPainter, rect: QRectF, x: Axis, y: Axis, theme: Theme, metrics: QFontMetricsF
    ) -> None:
        self._painter, self._theme, self._metrics = painter, theme, metrics
        self._x, self._y = x, y
        height = rect.height() - 2 * metrics.height() - _GAP
        self._y_ticks = y.ticks(max(1, int(height / _BETWEEN_Y)))
        left = max((metrics.horizontalAdvance(text) for _, text in self._y_ticks), default=0.0) + _GAP
        self._field = rect.adjusted(left, metrics.height(), -_GAP, -metrics.height() - 1.5 * _GAP)
        widest = max((metrics.horizontalAdvance(text) for _, text in x.ticks(4)), default=0.0)
        self._x_ticks = x.ticks(max(1, int(self._field.width() / max(_BETWEEN_X, widest + 2 * _PAD))))

    def draw(self, chart: Chart) -> None:
        """Draw axes, marks, bars and curves."""
        if self._field.width() < _BETWEEN_X / 2 or self._field.height() < _BETWEEN_Y / 2:
            return
        self._draw_axes()
        if chart.bars is not None:
            self._draw_bars(chart.bars)
        for mark in chart.vertical_lines:
            self._draw_upright(mark)
        for mark in chart.horizontal_lines:
            self._draw_across(mark)
        for curve in chart.curves:
            self._draw_curve(curve)
        if chart.dots is not None:
            draw_dots(self._painter, chart.dots, self.pixel_positions, self._theme)

    def pixel_positions(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Points (n, 2) on the axes in pixels."""
        return np.column_stack([self._at_x(x), self._at_y(y)])

    def _at_x(self, x: np.ndarray) -> np.ndarray:
        axis, field = self._x, self._field
        return field.left() + field.width() * (x - axis.low) / (axis.high - axis.low)

    def _at_y(self, y: np.ndarray) -> np.ndarray:
        axis, field = self._y, self._field
        return field.bottom() - field.height() * (np.clip(y, axis.low, axis.high) - axis.low) / (
            axis.high - axis.low
        )

    def _x_of(self, place: float) -> float:
        return float(self._at_x(np.array(place)))

    def _y_of(self, place: float) -> float:
        return float(self._at_y(np.array(place)))

    def _draw_axes(self) -> None:
        painter, field, metrics = self._painter, self._field, self._metrics
        line, words = QPen(QColor(self._theme.line), 1.0), QColor(self._theme.quiet)
        for place, text in self._y_ticks:
            y = self._y_of(place)
            painter.setPen(line)
            painter.drawLine(QPointF(field.left(), y), QPointF(field.right(), y))
            painter.setPen(words)
            start = field.left() - _GAP - metrics.horizontalAdvance(text)
            painter.drawText(QPointF(start, y + 0.35 * metrics.ascent()), text)
        baseline = field.bottom() + _GAP + metrics.ascent()  # clear of the lowest figure at the left
        painter.setPen(words)
        for place, text in self._x_ticks:
            x, half = self._x_of(place), 0.5 * metrics.horizontalAdvance(text)
            start = min(x - half, field.right() + _GAP - 2 * half)
            painter.drawText(QPointF(start, baseline), text)

    def _draw_bars(self, bars: Bars) -> None:
        edges = self._at_x(bars.edges).tolist()
        tops, bottom = self._at_y(bars.heights).tolist(), self._field.bottom()
        gap = 1.0 if edges[1] - edges[0] > 4.0 else 0.0
        middle = 0.5 * (bars.edges[1:] + bars.edges[:-1])
        nothing = 1e-9 * float(bars.edges[-1] - bars.edges[0])
        for left, right, top, x in zip(edges[:-1], edges[1:], tops, middle.tolist(), strict=True):
            color = "faint" if abs(x) <= nothing else bars.negative_color if x < 0 else bars.positive_color
            bar = QRectF(left, top, right - left - gap, bottom - top)
            self._painter.fillRect(bar, QColor(getattr(self._theme, color)))

    def _draw_upright(self, mark: ReferenceLine) -> None:
        x = self._x_of(mark.place)
        self._painter.setPen(self._dashed(mark))
        self._painter.drawLine(QPointF(x, self._field.top()), QPointF(x, self._field.bottom()))
        width = self._metrics.horizontalAdvance(mark.text)
        # Above the field, where no curve is.
        start = max(self._field.left(), min(x - width / 2, self._field.right() - width))
        place = QPointF(start, self._field.top() - _GAP / 2)
        self._painter.setPen(QColor(self._theme.quiet))
        self._painter.drawText(place, mark.text)

    def _draw_across(self, mark: ReferenceLine) -> None:
        y = self._y_of(mark.place)
        self._painter.setPen(self._dashed(mark))
        self._painter.drawLine(QPointF(self._field.left(), y), QPointF(self._field.right(), y))

    def _dashed(self, mark: ReferenceLine) -> QPen:
        pen = QPen(QColor(getattr(self._theme, mark.color)), 1.0)
        pen.setDashPattern([4.0, 3.0])
        return pen

    def _draw_curve(self, curve: Curve) -> None:
        pen = QPen(theme_color(self._theme, curve.color), 1.75)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        self._painter.setPen(pen)
        known = np.isfinite(curve.y)
        x, y = self._at_x(curve.x), self._at_y(np.where(known, curve.y, self._y.low))
        ends = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]))).reshape(-1, 2)
        for first, last in ends.tolist():
            # Points in the same half of a pixel would make the line uneven. The latest is always there.
            cells = np.round(2.0 * np.column_stack([x[first:last], y[first:last]]))
            leaves = np.append((cells[1:] != cells[:-1]).any(axis=1), True)
            leaves[0] = True
            places = first + np.flatnonzero(leaves)
            points = [QPointF(a, b) for a, b in zip(x[places].tolist(), y[places].tolist(), strict=True)]
            self._painter.drawPolyline(QPolygonF(points))
