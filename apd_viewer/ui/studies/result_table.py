"""Table of the results of a study."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import (
    QItemSelection,
    QItemSelectionModel,
    QItemSelectionRange,
    QModelIndex,
    QSignalBlocker,
    Qt,
    Signal,
)
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QFrame, QHeaderView, QTableView

from apd_viewer.language import tr
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures
from apd_viewer.ui.studies.result_model import ResultModel

_ROW = 24  # px
_WIDEST, _NARROWEST = 360, 48
_PAD = 18  # px, left and right of a text
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
    case_opened : Signal(int)
        A row of the plan, from 0.
    choice_changed : Signal()
        Other rows are chosen.
    """

    case_opened = Signal(int)
    choice_changed = Signal()

    def __init__(self, model: ResultModel) -> None:
        super().__init__(objectName="results", accessibleName=tr("Results of the study"))
        self._results, self._chooses = model, False
        self._held: list[int] = []
        self.setModel(model)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerItem)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setTabKeyNavigation(False)
        self.setFont(with_tabular_figures(self.font()))
        self.setSortingEnabled(True)
        across, down = self.horizontalHeader(), self.verticalHeader()
        across.setSortIndicator(0, Qt.SortOrder.AscendingOrder)
        across.setHighlightSections(False)
        # One of its own, always empty: to draw itself it would ask for each chosen row.
        across.setSelectionModel(QItemSelectionModel(model, self))
        across.setMinimumSectionSize(_NARROWEST)
        across.setSectionsMovable(True)
        down.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        down.setDefaultSectionSize(_ROW)
        down.hide()
        model.modelReset.connect(self._fit)
        model.rows_moving.connect(self._hold)
        model.rows_moved.connect(self._hold_no_more)
        self.clicked.connect(self._click)

    def _fit(self) -> None:
        """Give each column the width of its title and its texts."""
        metrics, head = self.fontMetrics(), self.horizontalHeader()
        for k, column in enumerate(self._results.columns):
            widest = max(map(metrics.horizontalAdvance, column.longest_texts), default=0) + _PAD
            self.setColumnWidth(k, min(max(widest, head.sectionSizeHint(k)) + 8, _WIDEST))

    def _hold(self) -> None:
        """Remember the chosen rows: Qt would take seconds to move 5,000 of them."""
        self._held = self.chosen_rows
        with QSignalBlocker(self.selectionModel()):
            self.selectionModel().clearSelection()

    def _hold_no_more(self) -> None:
        """Choose the same rows at their other places."""
        with QSignalBlocker(self.selectionModel()):
            self._select(self._held, _SELECTION.Select)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Remember whether more rows are chosen."""
        self._chooses = bool(event.modifiers() & _MORE)
        super().mouseReleaseEvent(event)

    def _click(self, index: QModelIndex) -> None:
        if not self._chooses:
            self._open(index)

    def _open(self, index: QModelIndex) -> None:
        self.case_opened.emit(int(self._results.order[index.row()]))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Open the current row on Enter."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().isValid():
            self._open(self.currentIndex())
        else:
            super().keyPressEvent(event)

    def selectionChanged(self, selected: QItemSelection, deselected: QItemSelection) -> None:
        """Announce a change of the selected rows."""
        super().selectionChanged(selected, deselected)
        self.choice_changed.emit()

    @property
    def chosen_rows(self) -> list[int]:
        """Chosen rows of the plan, from 0, in the order of the table."""
        # By ranges: an index for each of 10,000 rows takes half a second.
        selection, order = self.selectionModel().selection(), self._results.order
        parts = map(selection.at, range(selection.count()))
        places = sorted({(part.top(), part.bottom() + 1) for part in parts})
        return [int(k) for first, end in places for k in order[first:end]]

    def choose(self, rows: Sequence[int]) -> None:
        """Select rows of the plan, and show the last."""
        self._select(rows, _SELECTION.ClearAndSelect)
        self._show(rows[-1:])

    def toggle(self, row: int) -> None:
        """Choose a row of the plan besides the others, or no longer."""
        self._select([row], _SELECTION.Toggle)
        self._show([row])

    def _show(self, rows: Sequence[int]) -> None:
        """Scroll to a row of the plan, and make it the current one."""
        for row in rows:
            shown = self._results.index(int(np.flatnonzero(self._results.order == row)[0]), 0)
            self.selectionModel().setCurrentIndex(shown, _SELECTION.NoUpdate)
            self.scrollTo(shown)

    def _select(self, rows: Sequence[int], how: QItemSelectionModel.SelectionFlag) -> None:
        """Select rows of the plan; those below each other as one range."""
        index, last = self._results.index, self._results.columnCount() - 1
        places = np.sort(np.argsort(self._results.order)[list(rows)])
        selection = QItemSelection()
        for part in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(places) else []:
            selection.append(QItemSelectionRange(index(int(part[0]), 0), index(int(part[-1]), last)))
        self.selectionModel().select(selection, how)
