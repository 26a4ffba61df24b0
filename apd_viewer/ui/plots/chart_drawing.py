"""Contents of charts, and their drawing on the screen and in files.

They are drawn without a library: see docs/architecture.md for the cost of pyqtgraph.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QLinearGradient, QPainter, QPen, QPixmap, QPolygonF

from apd_viewer.presentation.axis import Axis
from apd_viewer.ui.widgets.theme import LIGHT, Theme
from apd_viewer.ui.widgets.thin_bar import elided_text

# Sizes in pixels, unless noted.
_PAD = 8.0
_GAP = 6.0
_ROW = 1.25  # height of a text row, in line heights of the font
_BETWEEN_X, _BETWEEN_Y = 64.0, 26.0


def draw_chart(painter: QPainter, rect: QRectF, chart: Chart, theme: Theme, font: QFont) -> ChartArea | None:
    """Draw a chart into a ``rect``, in the colours of a theme.

    Returns the area between its axes; None without contents.
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
    title = elided_text(chart.title, QFontMetricsF(bold), room.width())
    painter.drawText(QPointF(room.left(), room.top() + 0.75 * row), title)
    painter.restore()
    metrics, x = QFontMetricsF(painter.font()), room.left()
    baseline = room.top() + (1.75 if chart.title else 0.75) * row
    for text, color in chart.readings:
        shown = elided_text(text, metrics, max(0.0, room.right() - x))
        painter.setPen(theme_color(theme, color))
        painter.drawText(QPointF(x, baseline), shown)
        x += metrics.horizontalAdvance(text) + 2 * _GAP


class ChartArea:
    """Plot area between two axes, with its contents."""

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
        self._draw_axes(chart.x_title)
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
        """Pixel positions (n, 2) of points in chart coordinates."""
        return np.column_stack([self._pixel_columns(x), self._pixel_rows(y)])

    def _pixel_columns(self, x: np.ndarray) -> np.ndarray:
        axis, field = self._x, self._field
        return field.left() + field.width() * (x - axis.low) / (axis.high - axis.low)

    def _pixel_rows(self, y: np.ndarray) -> np.ndarray:
        axis, field = self._y, self._field
        return field.bottom() - field.height() * (np.clip(y, axis.low, axis.high) - axis.low) / (
            axis.high - axis.low
        )

    def _x_of(self, place: float) -> float:
        return float(self._pixel_columns(np.array(place)))

    def _y_of(self, place: float) -> float:
        return float(self._pixel_rows(np.array(place)))

    def _draw_axes(self, x_title: str) -> None:
        painter, field, metrics = self._painter, self._field, self._metrics
        line, words = QPen(QColor(self._theme.line), 1.0), QColor(self._theme.quiet)
        for place, text in self._y_ticks:
            y = self._y_of(place)
            painter.setPen(line)
            painter.drawLine(QPointF(field.left(), y), QPointF(field.right(), y))
            painter.setPen(words)
            start = field.left() - _GAP - metrics.horizontalAdvance(text)
            painter.drawText(QPointF(start, y + 0.35 * metrics.ascent()), text)
        baseline = field.bottom() + _GAP + metrics.ascent()  # below all labels of the y axis
        painter.setPen(words)
        before = metrics.horizontalAdvance(self._x_ticks[0][1]) if self._x_ticks else 0.0
        start = field.left() - 0.5 * before - _GAP - metrics.horizontalAdvance(x_title)
        painter.drawText(QPointF(max(0.0, start), baseline), x_title)
        for place, text in self._x_ticks:
            x, half = self._x_of(place), 0.5 * metrics.horizontalAdvance(text)
            start = min(x - half, field.right() + _GAP - 2 * half)
            painter.drawText(QPointF(start, baseline), text)

    def _draw_bars(self, bars: Bars) -> None:
        edges = self._pixel_columns(bars.edges).tolist()
        tops, bottom = self._pixel_rows(bars.heights).tolist(), self._field.bottom()
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
        # Draw the text above the plot area, clear of the curves.
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
        known = np.isfinite(curve.x) & np.isfinite(curve.y)
        x, y = self._pixel_columns(curve.x), self._pixel_rows(np.where(known, curve.y, self._y.low))
        ends = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]))).reshape(-1, 2)
        for first, last in ends.tolist():
            # Points that share a half-pixel cell would make the line uneven; the last point is always kept.
            cells = np.round(2.0 * np.column_stack([x[first:last], y[first:last]]))
            leaves = np.append((cells[1:] != cells[:-1]).any(axis=1), True)
            leaves[0] = True
            places = first + np.flatnonzero(leaves)
            points = [QPointF(a, b) for a, b in zip(x[places].tolist(), y[places].tolist(), strict=True)]
            self._painter.drawPolyline(QPolygonF(points))
            if curve.has_dots:
                self._painter.setBrush(pen.color())
                for point in points:
                    self._painter.drawEllipse(point, _SMALL_DOT, _SMALL_DOT)
                self._painter.setBrush(Qt.BrushStyle.NoBrush)


PixelPositions = Callable[[np.ndarray, np.ndarray], np.ndarray]

# Sizes in pixels, unless noted.
DOT_RADIUS = 4.0
_SMALL_DOT = 1.75
_HALF = 5.0  # half the side of a dot's pixmap
_RING = 7.0
_CROSS = 3.5
_BAR, _TICK_ROOM = 10.0, 26.0
_RIM = 90  # rim opacity out of 255: keeps light dots visible and overlapping dots countable


def theme_color(theme: Theme, color: str) -> QColor:
    """Colour of a theme by its name, or #rrggbb."""
    return QColor(color if color.startswith("#") else getattr(theme, color))


def draw_dots(painter: QPainter, dots: Dots, pixel_positions: PixelPositions, theme: Theme) -> None:
    """Draw the dots, and crosses for cases without a result.

    Dots are pixmaps at whole pixels: 10,000 take 6 ms, compared with 44 ms for ellipses.
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
    """Draw coloured rings around marked dots, and redraw these dots on top."""
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
    """Points (n, 2) rounded to device pixels at a given scale."""
    return np.asarray(np.rint(scale * at) / scale)


def _stamp(color: str, scale: float, theme: Theme) -> QPixmap:
    """Pixmap of a dot at a given device pixel ratio."""
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
    """Draw a colour bar at the right of ``rect``; return the remaining rectangle."""
    bar = rect.adjusted(0.0, metrics.height(), 0.0, -metrics.height() - 1.5 * _GAP)
    ticks = color_bar.axis.ticks(max(1, int(bar.height() / _TICK_ROOM)))
    widest = max((metrics.horizontalAdvance(text) for _, text in ticks), default=0.0)
    bar.setLeft(rect.right() - widest - _GAP - _BAR)
    bar.setWidth(_BAR)
    fill = QLinearGradient(bar.bottomLeft(), bar.topLeft())
    for fraction, color in zip(
        np.linspace(0.0, 1.0, len(color_bar.colors)).tolist(), color_bar.colors, strict=True
    ):
        fill.setColorAt(fraction, QColor(color))
    painter.fillRect(bar, fill)
    painter.setPen(QPen(QColor(theme.line), 1.0))
    painter.drawRect(bar)
    painter.setPen(QColor(theme.quiet))
    for place, text in ticks:
        fraction = (place - color_bar.axis.low) / (color_bar.axis.high - color_bar.axis.low)
        y = bar.bottom() - fraction * bar.height() + 0.35 * metrics.ascent()
        painter.drawText(QPointF(bar.right() + _GAP, y), text)
    return rect.adjusted(0.0, 0.0, -(widest + 3 * _GAP + _BAR), 0.0)


@dataclass(frozen=True, eq=False)
class Curve:
    """Polyline in chart coordinates, in a theme colour or #rrggbb.

    It is broken where ``x`` or ``y`` is not finite. With ``has_dots`` each point is a dot, too.
    """

    x: np.ndarray
    y: np.ndarray
    color: str = "accent"
    has_dots: bool = False


@dataclass(frozen=True, eq=False)
class Bars:
    """Histogram of ``heights`` (b,) between ``edges`` (b + 1,), coloured by sign."""

    edges: np.ndarray
    heights: np.ndarray
    negative_color: str = "less"
    positive_color: str = "more"


@dataclass(frozen=True, eq=False)
class Dots:
    """Scatter points in chart coordinates, each with its own colour.

    Attributes
    ----------
    x, y : (n,) float array
        Not drawn where one is not finite.
    colors : tuple of str
        #rrggbb.
    crosses : (m, 2) float array
        Places of crosses, for what has no result.
    """

    x: np.ndarray
    y: np.ndarray
    colors: tuple[str, ...]
    crosses: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True)
class ColorBar:
    """Colour scale of the dots, beside the chart."""

    axis: Axis
    colors: tuple[str, ...]


@dataclass(frozen=True)
class ReferenceLine:
    """Dashed line across the chart at an axis position; upright ones have text."""

    place: float
    text: str = ""
    color: str = "faint"


@dataclass(frozen=True, eq=False)
class Chart:
    """Contents of a chart.

    Attributes
    ----------
    title : str
        Empty where it stands elsewhere: the chart then has its room.
    readings : tuple of (str, str)
        Texts under the title, and their colours of the theme or #rrggbb.
    x, y : Axis or None
        None where there is nothing to be seen yet.
    curves, bars, dots, color_bar, horizontal_lines, vertical_lines
        ``horizontal_lines`` are marks at places of y, ``vertical_lines`` at places of x.
    empty_text : str
        Text shown without contents.
    x_title : str
        Quantity of the x axis, before its numbers.
    """

    title: str
    readings: tuple[tuple[str, str], ...] = ()
    x: Axis | None = None
    y: Axis | None = None
    curves: tuple[Curve, ...] = ()
    bars: Bars | None = None
    dots: Dots | None = None
    color_bar: ColorBar | None = None
    horizontal_lines: tuple[ReferenceLine, ...] = ()
    vertical_lines: tuple[ReferenceLine, ...] = ()
    empty_text: str = field(default="", repr=False)
    x_title: str = ""
