"""Table of study results, with its model."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from PySide6.QtCore import (
    QAbstractTableModel,
    QItemSelection,
    QItemSelectionModel,
    QItemSelectionRange,
    QModelIndex,
    QPersistentModelIndex,
    QSignalBlocker,
    Qt,
    Signal,
)
from PySide6.QtGui import QBrush, QColor, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QFrame, QHeaderView, QTableView

from apd_viewer.cases.case_file import FAILED
from apd_viewer.cases.results import DUPLICATE, WAITING, WRONG, ResultRow, ResultTable
from apd_viewer.language import comma_separated, tr
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures
from apd_viewer.ui.studies.result_columns import LINE_COLUMN, REMARK_COLUMN, STATUS_COLUMN, ResultColumn
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_ROLES = Qt.ItemDataRole
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_Index = QModelIndex | QPersistentModelIndex
_ROW = 24  # px: height of a row
_WIDEST, _NARROWEST = 360, 48
_PAD = 18  # px: horizontal padding of a text, both sides together
# Modifier keys for a click to extend the selection.
_MORE = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
_SELECTION = QItemSelectionModel.SelectionFlag


class ResultModel(QAbstractTableModel):
    """Table model of the results, sortable by a column.

    Attributes
    ----------
    rows : tuple of ResultRow
        In the order of the plan.
    order : (n,) int array
        Place in ``rows`` of each row of the table.
    rows_moving, rows_moved : Signal()
        Before and after the rows get other places.
    """

    rows_moving = Signal()
    rows_moved = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.columns: list[ResultColumn] = []
        self.rows: tuple[ResultRow, ...] = ()
        self.order = np.empty(0, dtype=int)
        self.theme: Theme = LIGHT
        self._sorted_by = LINE_COLUMN, Qt.SortOrder.AscendingOrder

    def show_results(self, table: ResultTable, columns: list[ResultColumn]) -> None:
        """Set the results; order and selection are kept if the columns are unchanged."""
        alike = len(table.rows) == len(self.rows) and [c.name for c in columns] == [
            c.name for c in self.columns
        ]
        if alike:
            with self._moving_rows():
                self.rows, self.columns = table.rows, columns
            return
        self.beginResetModel()
        self.rows, self.columns = table.rows, columns
        self._arrange()
        self.endResetModel()

    @contextmanager
    def _moving_rows(self) -> Iterator[None]:
        """Context manager that re-sorts the rows on exit and updates persistent indexes."""
        self.rows_moving.emit()
        self.layoutAboutToBeChanged.emit()
        before, held = self.order, self.persistentIndexList()
        yield
        self._arrange()
        place = np.argsort(self.order)
        moved = [self.index(int(place[before[each.row()]]), each.column()) for each in held]
        self.changePersistentIndexList(held, moved)
        self.layoutChanged.emit()
        self.rows_moved.emit()

    @property
    def numeric_columns(self) -> list[ResultColumn]:
        """Numeric columns, except the line number."""
        return [column for column in self.columns[1:] if column.is_numeric]

    def _arrange(self) -> None:
        name, way = self._sorted_by
        column = next((each for each in self.columns if each.name == name), None)
        self.order = np.arange(len(self.rows))
        if column is None:
            return
        keys = column.sort_keys if way is Qt.SortOrder.AscendingOrder else -column.sort_keys
        self.order = np.argsort(keys, kind="stable")  # NaN sorts last

    # Overrides of Qt methods

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        """Number of rows."""
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        """Number of columns."""
        return 0 if parent.isValid() else len(self.columns)

    def data(self, index: _Index, role: int = _ROLES.DisplayRole) -> Any:
        """Text, alignment, colour or tooltip of a cell."""
        column, k = self.columns[index.column()], int(self.order[index.row()])
        if role == _ROLES.DisplayRole:
            return column.texts[k]
        if role == _ROLES.TextAlignmentRole:
            return _RIGHT if column.is_numeric else _LEFT
        if role == _ROLES.ToolTipRole:
            return self.rows[k].sentence or self.row_name(k)
        if role == _ROLES.ForegroundRole:
            return self._text_color(self.rows[k].status, column.name)
        return None

    def row_name(self, k: int, is_short: bool = False) -> str:
        """Name of a row: what the plan varies with its values, or only those."""
        varied = [column for column in self.columns if column.is_from_plan and column.texts[k]]
        words = [column.texts[k] if is_short else f"{column.title} {column.texts[k]}" for column in varied]
        return comma_separated(words) or tr("case {line}").format(line=self.rows[k].line)

    def _text_color(self, status: str, column: str) -> QBrush | None:
        if status in (FAILED, WRONG) and column in (STATUS_COLUMN, REMARK_COLUMN):
            return QBrush(QColor(self.theme.warm))
        return QBrush(QColor(self.theme.quiet)) if status in (WAITING, DUPLICATE) else None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = _ROLES.DisplayRole) -> Any:
        """Title or tooltip of a column."""
        if orientation is not Qt.Orientation.Horizontal or section >= len(self.columns):
            return None
        column = self.columns[section]
        if role == _ROLES.TextAlignmentRole:
            return _RIGHT if column.is_numeric else _LEFT
        return {_ROLES.DisplayRole: self._header_text(column), _ROLES.ToolTipRole: column.tip}.get(
            _ROLES(role)
        )

    def _header_text(self, column: ResultColumn) -> str:
        """Title of a column, with an arrow for the sort order."""
        name, way = self._sorted_by
        mark = "▴" if way is Qt.SortOrder.AscendingOrder else "▾"
        return f"{column.title} {mark}" if column.name == name else column.title

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort by a column."""
        if not 0 <= column < len(self.columns):
            return
        with self._moving_rows():
            self._sorted_by = self.columns[column].name, order
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(self.columns) - 1)


class ResultsView(QTableView):
    """Sortable table of cases; Enter or a click opens one, Ctrl or Shift selects more.

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
        # Separate and always empty selection model; with the table's, painting queries each selected row.
        across.setSelectionModel(QItemSelectionModel(model, self))
        across.setMinimumSectionSize(_NARROWEST)
        across.setSectionsMovable(True)
        down.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        down.setDefaultSectionSize(_ROW)
        down.hide()
        model.modelReset.connect(self._fit)
        model.rows_moving.connect(self._store_selection)
        model.rows_moved.connect(self._restore_selection)
        self.clicked.connect(self._click)

    def _fit(self) -> None:
        """Give each column the width of its title and its texts."""
        metrics, head = self.fontMetrics(), self.horizontalHeader()
        for k, column in enumerate(self._results.columns):
            widest = max(map(metrics.horizontalAdvance, column.longest_texts), default=0) + _PAD
            self.setColumnWidth(k, min(max(widest, head.sectionSizeHint(k)) + 8, _WIDEST))

    def _store_selection(self) -> None:
        """Store and clear the selection, as Qt would take seconds to move 5,000 rows."""
        self._held = self.chosen_rows
        with QSignalBlocker(self.selectionModel()):
            self.selectionModel().clearSelection()

    def _restore_selection(self) -> None:
        """Restore the stored selection at the new row positions."""
        with QSignalBlocker(self.selectionModel()):
            self._select(self._held, _SELECTION.Select)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Record whether the click extends the selection."""
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
        """Emit ``choice_changed`` after a change of the selection."""
        super().selectionChanged(selected, deselected)
        self.choice_changed.emit()

    @property
    def chosen_rows(self) -> list[int]:
        """Selected rows of the plan, from 0, in table order."""
        # Selection ranges are read, since an index for each of 10,000 rows takes half a second.
        selection, order = self.selectionModel().selection(), self._results.order
        parts = map(selection.at, range(selection.count()))
        places = sorted({(part.top(), part.bottom() + 1) for part in parts})
        return [int(k) for first, end in places for k in order[first:end]]

    def choose_rows(self, rows: Sequence[int]) -> None:
        """Select rows of the plan, and scroll to the last."""
        self._select(rows, _SELECTION.ClearAndSelect)
        self._show(rows[-1:])

    def toggle_row(self, row: int) -> None:
        """Toggle the selection of a row of the plan."""
        self._select([row], _SELECTION.Toggle)
        self._show([row])

    def _show(self, rows: Sequence[int]) -> None:
        """Scroll to a row of the plan, and make it the current one."""
        for row in rows:
            shown = self._results.index(int(np.flatnonzero(self._results.order == row)[0]), 0)
            self.selectionModel().setCurrentIndex(shown, _SELECTION.NoUpdate)
            self.scrollTo(shown)

    def _select(self, rows: Sequence[int], how: QItemSelectionModel.SelectionFlag) -> None:
        """Select rows of the plan, with adjacent rows as one range."""
        index, last = self._results.index, self._results.columnCount() - 1
        places = np.sort(np.argsort(self._results.order)[list(rows)])
        selection = QItemSelection()
        for part in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(places) else []:
            selection.append(QItemSelectionRange(index(int(part[0]), 0), index(int(part[-1]), last)))
        self.selectionModel().select(selection, how)
