"""Table of the compared methods' readings, and export of a comparison picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QResizeEvent
from PySide6.QtWidgets import QFrame, QHeaderView, QSizePolicy, QTableWidget, QTableWidgetItem

from apd_viewer.language import tr
from apd_viewer.presentation.method_readings import ReadingColumn, ReadingsByName
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.legend import scale_image
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures
from apd_viewer.ui.plots.plots import write_drawing
from apd_viewer.ui.widgets.theme import LIGHT
from apd_viewer.ui.widgets.thin_bar import elided_text

_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_ROW = 28  # px; row height
_LONGEST_TITLE = 200  # px; longer titles of rows are elided


class MethodTable(QTableWidget):
    """Table with a row per method and a column per reading, with aligned digits."""

    def __init__(self) -> None:
        super().__init__(objectName="outcomes", accessibleName=tr("Measurements of the methods"))
        self.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.setSelectionMode(QTableWidget.SelectionMode.NoSelection)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setShowGrid(False)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollMode(QTableWidget.ScrollMode.ScrollPerPixel)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFont(with_tabular_figures(self.font()))
        across, down = self.horizontalHeader(), self.verticalHeader()
        across.setDefaultAlignment(_RIGHT)
        across.setHighlightSections(False)
        down.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        down.setDefaultSectionSize(_ROW)
        down.setMaximumWidth(_LONGEST_TITLE)
        down.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self.columns: list[ReadingColumn] = []

    def set_columns(self, columns: list[ReadingColumn]) -> None:
        """Set the columns and their titles."""
        self.columns = columns
        self.clearSpans()
        self.setColumnCount(len(columns))
        for k, column in enumerate(columns):
            head = QTableWidgetItem(_narrow_text(column.title))
            head.setToolTip(column.tip)
            self.setHorizontalHeaderItem(k, head)
        self._share_width()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Share the new width among the columns."""
        super().resizeEvent(event)
        self._share_width()

    def _share_width(self) -> None:
        """Make the columns equally wide if there is room for the longest text in each."""
        across, modes = self.horizontalHeader(), QHeaderView.ResizeMode
        places = range(across.count())
        widest = max((max(across.sectionSizeHint(k), self.sizeHintForColumn(k)) for k in places), default=0)
        is_wide = self.viewport().width() >= across.count() * widest
        across.setSectionResizeMode(modes.Stretch if is_wide else modes.ResizeToContents)

    def show_methods(self, titles: Sequence[str]) -> None:
        """Set the rows by the titles of their methods."""
        self.setRowCount(len(titles))
        self.setVerticalHeaderLabels(list(titles))
        self.updateGeometry()

    def show_title(self, row: int, title: str, tip: str = "") -> None:
        """Set the title of a row, and its tooltip below the whole title."""
        head = self.verticalHeaderItem(row)
        if head is None:
            return
        head.setToolTip(f"{title}\n{tip}".rstrip())
        if head.text() != title:
            head.setText(title)
            self.updateGeometry()
            self._share_width()

    def show_readings(self, row: int, readings: ReadingsByName, instead: str = "") -> None:
        """Fill a row, ``instead`` of missing readings with a text across it."""
        is_note = bool(instead) and not readings
        if is_note is not (self.columnSpan(row, 0) > 1):
            self.setSpan(row, 0, 1, len(self.columns) if is_note else 1)
        is_new = False
        for k, column in enumerate(self.columns):
            text = column.cell_text(readings) if readings else "" if k else instead
            item = self.item(row, k)
            if item is None:
                item = QTableWidgetItem()
                self.setItem(row, k, item)
            if item.text() != text:
                item.setText(text)
                is_new = True
            item.setTextAlignment(_LEFT if is_note else _RIGHT)
            item.setToolTip("" if is_note else column.cell_tip(readings))
        if is_new:
            self._share_width()

    def sizeHint(self) -> QSize:
        """Height of the header and all rows."""
        head = self.horizontalHeader().sizeHint().height()
        bar = self.horizontalScrollBar().sizeHint().height()
        return QSize(super().sizeHint().width(), head + _ROW * self.rowCount() + bar)

    def minimumSizeHint(self) -> QSize:
        """Preferred size, so that no row is cut off."""
        return QSize(240, self.sizeHint().height())


def _narrow_text(title: str) -> str:
    """Title of a column on two lines, broken also at a soft hyphen."""
    words = title.replace("\u00ad", "- ").split()
    return "\n".join(line for line in (" ".join(words[:1]), " ".join(words[1:])) if line)


PIXEL_RATIO = 2  # picture pixels for each pixel on the screen
_HEAD, _FOOT, _PAD = 52, 72, 16  # px; heights of title and legend, and padding
_LEGEND = QSize(320, 14)


class ComparisonShape(NamedTuple):
    """Shape in the picture: title, caption and pixels (h, w, 3) uint8."""

    title: str
    caption: str
    pixels: np.ndarray


def write_comparison(
    path: Path, shapes: Sequence[ComparisonShape], columns: int, scale: Scale, font: QFont
) -> None:
    """Write pictures of equal size side by side as PNG; raises InputError."""
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
    line = elided_text(shape.caption, painter.fontMetrics(), below.width())
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
