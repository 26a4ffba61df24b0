"""Colour bar with the shape's range and the value under the cursor."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QImage, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.session.quantities.units import Unit

_STEPS = 256
_TALL, _SPAN, _TICK = 14, 3, 7  # px: of the colours, of the line below them, of the tick


class ScaleBar(QWidget):
    """Colour bar, labelled at its ends and zero, with a tick at a value.

    A line below the colours spans the values that the shape has, as far as the scale reaches.

    Attributes
    ----------
    value : float or None
        Under the cursor.
    """

    def __init__(self) -> None:
        super().__init__(accessibleName=tr("Overlay colours"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._scale = Scale(Measure.AREA, 0.1)
        self._unit = Unit.NONE
        self._span: tuple[float, float] | None = None
        self.value: float | None = None
        self._colors = QImage()

    def show_scale(self, scale: Scale, unit: Unit) -> None:
        """Show the colours of another scale."""
        self._scale, self._unit = scale, unit
        self._colors = scale_image(scale)
        self.update()

    def show_values(self, span: tuple[float, float] | None, value: float | None) -> None:
        """Show least, largest and current value; None hides them."""
        if (span, value) != (self._span, self.value):
            self._span, self.value = span, value
            self.update()

    @property
    def labels(self) -> tuple[tuple[float, str], ...]:
        """Label positions, from 0 to 1, and texts."""
        scale = self._scale
        return tuple((scale.position(x), scale.format_value(x, self._unit)) for x in scale.tick_values)

    def sizeHint(self) -> QSize:
        """Tick, colours, line and figures."""
        return QSize(200, _TICK + _TALL + 2 * _SPAN + self.fontMetrics().height() + 2)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw all of it."""
        painter = QPainter(self)
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        palette, wide = self.palette(), float(self.width())
        bar = QRectF(0.5, _TICK, wide - 1.0, _TALL)
        painter.drawImage(bar, self._colors)
        painter.setPen(QPen(palette.mid().color(), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(bar)
        ink = palette.windowText().color()
        if self._span is not None:
            low, high = (self._at(value, bar) for value in self._span)
            painter.setPen(QPen(ink, 2.0, c=Qt.PenCapStyle.FlatCap))
            y = bar.bottom() + _SPAN
            painter.drawLine(QPointF(min(low, high - 2.0), y), QPointF(high, y))
        if self.value is not None and self.value == self.value:
            self._draw_tick(painter, self._at(self.value, bar), bar)
        painter.setPen(ink)
        for place, text in self.labels:
            room = QRectF(self.fontMetrics().boundingRect(text)).adjusted(-1, 0, 3, 0)
            left = min(max(place * wide - room.width() / 2, 0.0), wide - room.width())
            top = bar.bottom() + 2 * _SPAN
            painter.drawText(
                QRectF(left, top, room.width(), self.fontMetrics().height()),
                Qt.AlignmentFlag.AlignCenter,
                text,
            )

    def _at(self, value: float, bar: QRectF) -> float:
        return bar.left() + self._scale.position(value) * bar.width()

    def _draw_tick(self, painter: QPainter, x: float, bar: QRectF) -> None:
        ink, paper = self.palette().windowText().color(), self.palette().base().color()
        painter.setPen(QPen(paper, 3.0))
        painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.bottom()))
        painter.setPen(QPen(ink, 1.25))
        painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.bottom()))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(ink)
        top = bar.top() - _TICK + 1.0
        x = min(max(x, 5.0), self.width() - 5.0)
        painter.drawPolygon(
            QPolygonF([QPointF(x - 4.5, top), QPointF(x + 4.5, top), QPointF(x, bar.top() - 0.5)])
        )


def scale_image(scale: Scale) -> QImage:
    """The colours of a scale from one end to the other, a pixel high."""
    colors = scale.colors(np.linspace(0.0, 1.0, _STEPS))
    return QImage(colors.tobytes(), _STEPS, 1, colors.nbytes, QImage.Format.Format_RGB888).copy()
