"""Picture of a comparison: titled shapes with a common legend."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QImage, QPainter

from apd_viewer.presentation.scales import Scale
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.filing.plot_export import write_drawing
from apd_viewer.ui.overlays.scale_bar import scale_image
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures
from apd_viewer.ui.widgets.theme import LIGHT

PIXEL_RATIO = 2  # pixels of a shape for each on the screen
_HEAD, _FOOT, _PAD = 52, 72, 16  # px
_LEGEND = QSize(320, 14)


class ComparisonShape(NamedTuple):
    """Shape in the picture: name, line below and pixels (h, w, 3) uint8."""

    title: str
    caption: str
    pixels: np.ndarray


def write_comparison(
    path: Path, shapes: Sequence[ComparisonShape], columns: int, scale: Scale, font: QFont
) -> None:
    """Write shapes of one size side by side as PNG; raises InputError."""
    height, width = (length // PIXEL_RATIO for length in shapes[0].pixels.shape[:2])
    rows = -(-len(shapes) // columns)
    size = QSize(columns * width, rows * (height + _HEAD) + _FOOT)

    def draw(painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.setFont(with_tabular_figures(font))
        for k, shape in enumerate(shapes):
            corner = QPointF(k % columns * width, k // columns * (height + _HEAD))
            _draw_shape(painter, QRectF(corner, QSize(width, height + _HEAD)), shape)
        _draw_legend(painter, QRectF(0, size.height() - _FOOT, size.width(), _FOOT), scale)

    write_drawing(path, size, draw)


def _draw_shape(painter: QPainter, room: QRectF, shape: ComparisonShape) -> None:
    pixels = np.ascontiguousarray(shape.pixels[:, :, :3])
    height, width = pixels.shape[:2]
    image = QImage(pixels.data, width, height, 3 * width, QImage.Format.Format_RGB888)
    painter.drawImage(room.adjusted(0, _HEAD, 0, 0), image)
    lines = room.adjusted(_PAD, 10, -_PAD, 0)
    painter.save()
    bold = QFont(painter.font())
    bold.setWeight(QFont.Weight.DemiBold)
    painter.setFont(bold)
    painter.setPen(QColor(LIGHT.ink))
    painter.drawText(lines, Qt.AlignmentFlag.AlignTop, shape.title)
    below = lines.adjusted(0, painter.fontMetrics().height() + 2, 0, 0)
    painter.restore()
    painter.setPen(QColor(LIGHT.quiet))
    line = painter.fontMetrics().elidedText(shape.caption, Qt.TextElideMode.ElideRight, int(below.width()))
    painter.drawText(below, Qt.AlignmentFlag.AlignTop, line)


def _draw_legend(painter: QPainter, room: QRectF, scale: Scale) -> None:
    wide = min(_LEGEND.width(), room.width() - 2 * _PAD)
    row = painter.fontMetrics().height()
    painter.setPen(QColor(LIGHT.ink))
    painter.drawText(room.adjusted(0, 8, 0, 0), Qt.AlignmentFlag.AlignHCenter, scale.measure.traits.title)
    bar = QRectF(room.center().x() - wide / 2, room.top() + 12 + row, wide, _LEGEND.height())
    painter.drawImage(bar, scale_image(scale))
    for value in scale.tick_values:
        place = bar.left() + scale.position(value) * wide
        under = QRectF(place - 60, bar.bottom() + 3, 120, row)
        painter.drawText(under, Qt.AlignmentFlag.AlignCenter, scale.format_value(value, Unit.NONE))
