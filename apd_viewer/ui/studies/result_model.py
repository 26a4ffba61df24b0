"""Results of a study as the rows of a table."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QBrush, QColor

from apd_viewer.cases.case_file import FAILED
from apd_viewer.cases.results import DUPLICATE, WAITING, WRONG, ResultRow, ResultTable
from apd_viewer.ui.studies.result_columns import LINE_COLUMN, REMARK_COLUMN, STATUS_COLUMN, ResultColumn
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_ROLES = Qt.ItemDataRole
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_Index = QModelIndex | QPersistentModelIndex


class ResultModel(QAbstractTableModel):
    """Rows of the results, in the order of a column.

    Attributes
    ----------
    columns : list of ResultColumn
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
        """Show other results; order, selection and widths stay where the columns do."""
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
        """Arrange the rows anew, and have the current one go along."""
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
        self.order = np.argsort(keys, kind="stable")  # what has no number comes last

    # Qt's

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        """Number of rows."""
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        """Number of columns."""
        return 0 if parent.isValid() else len(self.columns)

    def data(self, index: _Index, role: int = _ROLES.DisplayRole) -> Any:
        """Text, alignment, colour or tip of a cell."""
        column, k = self.columns[index.column()], int(self.order[index.row()])
        if role == _ROLES.DisplayRole:
            return column.texts[k]
        if role == _ROLES.TextAlignmentRole:
            return _RIGHT if column.is_numeric else _LEFT
        if role == _ROLES.ToolTipRole:
            return self.rows[k].sentence or None
        if role == _ROLES.ForegroundRole:
            return self._ink(self.rows[k].status, column.name)
        return None

    def _ink(self, status: str, column: str) -> QBrush | None:
        if status in (FAILED, WRONG) and column in (STATUS_COLUMN, REMARK_COLUMN):
            return QBrush(QColor(self.theme.warm))
        return QBrush(QColor(self.theme.quiet)) if status in (WAITING, DUPLICATE) else None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = _ROLES.DisplayRole) -> Any:
        """Title or tip of a column."""
        if orientation is not Qt.Orientation.Horizontal or section >= len(self.columns):
            return None
        column = self.columns[section]
        if role == _ROLES.TextAlignmentRole:
            return _RIGHT if column.is_numeric else _LEFT
        return {_ROLES.DisplayRole: self._titled(column), _ROLES.ToolTipRole: column.tip}.get(_ROLES(role))

    def _titled(self, column: ResultColumn) -> str:
        """Title with a mark of the order."""
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
