"""Table of the compared methods' readings."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QHeaderView,
    QSizePolicy,
    QTableWidget,
    QTableWidgetItem,
)

from apd_viewer.language import tr
from apd_viewer.presentation.method_readings import ReadingColumn, ReadingsByName
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures

_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_ROW, _COLUMN = 28, 96  # px


class MethodTable(QTableWidget):
    """Rows of methods and columns of readings, with aligned figures."""

    def __init__(self) -> None:
        super().__init__(objectName="outcomes", accessibleName=tr("Measurements of the methods"))
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setShowGrid(False)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFont(with_tabular_figures(self.font()))
        across, down = self.horizontalHeader(), self.verticalHeader()
        across.setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        across.setMinimumSectionSize(_COLUMN)
        across.setDefaultAlignment(_RIGHT)
        across.setHighlightSections(False)
        down.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        down.setDefaultSectionSize(_ROW)
        down.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self.columns: list[ReadingColumn] = []

    def set_columns(self, columns: list[ReadingColumn]) -> None:
        """Set the columns."""
        self.columns = columns
        self.setColumnCount(len(columns))
        for k, column in enumerate(columns):
            head = QTableWidgetItem(column.title)
            head.setToolTip(column.tip)
            self.setHorizontalHeaderItem(k, head)
        across = self.horizontalHeader()
        across.setMinimumSectionSize(max([_COLUMN, *map(across.sectionSizeHint, range(len(columns)))]))

    def show_methods(self, titles: Sequence[str]) -> None:
        """Set the rows."""
        self.setRowCount(len(titles))
        self.setVerticalHeaderLabels(list(titles))
        self.updateGeometry()

    def show_readings(self, row: int, readings: ReadingsByName) -> None:
        """Write a row; unknown values stay empty."""
        for k, column in enumerate(self.columns):
            text = column.cell_text(readings) if readings else ""
            item = self.item(row, k)
            if item is None:
                item = QTableWidgetItem()
                item.setTextAlignment(_RIGHT)
                item.setToolTip(column.tip)
                self.setItem(row, k, item)
            if item.text() != text:
                item.setText(text)

    def sizeHint(self) -> QSize:
        """Height of all rows."""
        head = self.horizontalHeader().sizeHint().height()
        bar = self.horizontalScrollBar().sizeHint().height()
        return QSize(super().sizeHint().width(), head + _ROW * self.rowCount() + bar)

    def minimumSizeHint(self) -> QSize:
        """The same."""
        return QSize(240, self.sizeHint().height())
