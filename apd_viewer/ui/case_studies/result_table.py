"""Table of the results of a study."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QItemSelection, QItemSelectionModel, QModelIndex, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QFrame, QHeaderView, QTableView

from apd_viewer.language import tr
from apd_viewer.ui.plots.chart_drawing import tabular

if TYPE_CHECKING:
    from apd_viewer.ui.case_studies.result_model import ResultModel

_ROW = 24  # px
_WIDEST, _NARROWEST = 360, 48
# With these a click adds rows to the chosen ones.
_MORE = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
_SELECTION = QItemSelectionModel.SelectionFlag


class ResultsView(QTableView):
    """Sortable rows of cases; a click or Enter opens one, Ctrl and Shift choose more.

    Parameters
    ----------
    model : ResultModel

    Attributes
    ----------
    opened : Signal(int)
        A row of the plan, from 0.
    chosen : Signal()
        Other rows are chosen.
    """

    opened = Signal(int)
    chosen = Signal()

    def __init__(self, model: ResultModel) -> None:
        super().__init__(objectName="results", accessibleName=tr("Results of the study"))
        self._results, self._chooses = model, False
        self.setModel(model)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerItem)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setTabKeyNavigation(False)
        self.setFont(tabular(self.font()))
        self.setSortingEnabled(True)
        across, down = self.horizontalHeader(), self.verticalHeader()
        across.setSortIndicator(0, Qt.SortOrder.AscendingOrder)
        across.setHighlightSections(False)
        across.setMinimumSectionSize(_NARROWEST)
        across.setSectionsMovable(True)
        down.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        down.setDefaultSectionSize(_ROW)
        down.hide()
        model.modelReset.connect(self._fit)
        self.clicked.connect(self._click)

    def _fit(self) -> None:
        """Give each column the width of its contents."""
        self.resizeColumnsToContents()
        for k in range(self._results.columnCount()):
            self.setColumnWidth(k, min(self.columnWidth(k) + 8, _WIDEST))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Remember whether more rows are chosen."""
        self._chooses = bool(event.modifiers() & _MORE)
        super().mouseReleaseEvent(event)

    def _click(self, index: QModelIndex) -> None:
        if not self._chooses:
            self._open(index)

    def _open(self, index: QModelIndex) -> None:
        self.opened.emit(int(self._results.order[index.row()]))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Open the current row on Enter."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().isValid():
            self._open(self.currentIndex())
        else:
            super().keyPressEvent(event)

    def selectionChanged(self, selected: QItemSelection, deselected: QItemSelection) -> None:
        """Announce other rows."""
        super().selectionChanged(selected, deselected)
        self.chosen.emit()

    @property
    def rows(self) -> list[int]:
        """Chosen rows of the plan, from 0, in the order of the table."""
        found = self.selectionModel().selectedRows() if self.selectionModel() else []
        return [int(self._results.order[index.row()]) for index in found]

    def choose(self, rows: Sequence[int]) -> None:
        """Choose rows of the plan; show the last."""
        places = {int(k): place for place, k in enumerate(self._results.order)}
        last = self._results.columnCount() - 1
        selection = QItemSelection()
        for row in rows:
            first = self._results.index(places[row], 0)
            selection.select(first, self._results.index(places[row], last))
        self.selectionModel().select(selection, _SELECTION.ClearAndSelect)
        if rows:
            shown = self._results.index(places[rows[-1]], 0)
            self.selectionModel().setCurrentIndex(shown, _SELECTION.NoUpdate)
            self.scrollTo(shown)
