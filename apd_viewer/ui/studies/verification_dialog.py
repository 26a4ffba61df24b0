"""Dialog to run the verification cases, row by row."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QFont, QGuiApplication, QResizeEvent
from PySide6.QtWidgets import QHeaderView, QLabel, QPushButton, QTreeWidget, QTreeWidgetItem, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.verification_text import COLUMN_TITLES, row_cells
from apd_viewer.ui.plots.chart_drawing import with_tabular_figures
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_dialog import RunBar, RunDialog
from apd_viewer.ui.widgets.box_layouts import resize_on_screen, row_layout
from apd_viewer.ui.widgets.figure_view import FigureView
from apd_viewer.verification.verification_run import VerificationRow

_WIDTH, _RESULTS = 640, QSize(960, 760)
_FIGURE, _TABLE = 300, 120  # px: greatest height of the figure, least height of the table
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_CASE = Qt.ItemDataRole.UserRole
_Parent = QTreeWidget | QTreeWidgetItem


class VerificationDialog(RunDialog):
    """Dialog to run the verification cases, with a table and the chosen case's figure."""

    def __init__(self, window: QWidget, preferences: Preferences) -> None:
        super().__init__(window, tr("Verify"), RunBar(tr("Run"), "verification", preferences))
        self.run.start_requested.connect(self._begin)
        self.run.command.reported.connect(self._add_rows)
        self.table = VerificationTable()
        self.table.currentItemChanged.connect(self._show_figure)
        self.summary = QLabel(wordWrap=True, objectName="verdict")
        self.copy = QPushButton(tr("Copy table"), clicked=self._copy)
        below = row_layout((self.summary, 1), self.copy)
        about = tr(
            "Runs cases with exact or published answers, from coarse to fine, and shows the errors of this "
            "program. It takes a few minutes; you can keep working in the window."
        )
        self._column.addWidget(QLabel(about, objectName="quiet", wordWrap=True))
        self._column.addWidget(self.table, 1)
        self._column.addLayout(below)
        self._column.addWidget(self.run)
        self.run.start.setFocus()  # the help comes first
        self._folder: Path | None = None
        self.table.setMinimumHeight(_TABLE)
        for part in (self.table, self.summary, self.copy):
            part.hide()
        resize_on_screen(self, QSize(_WIDTH, self._column.totalHeightForWidth(_WIDTH)))

    def _begin(self) -> None:
        self._folder = None
        self._remove_figure()
        self.table.remove_rows()
        self.summary.clear()
        self.run.begin(lambda _, results: ["verify", "-o", str(results)])
        for part in (self.table, self.summary, self.copy):
            part.show()
        resize_on_screen(self, self.size().expandedTo(_RESULTS))

    def _show_busy(self, on: bool) -> None:
        self.copy.setEnabled(not on)

    def _add_rows(self, progress: dict[str, Any]) -> None:
        self.table.add_case([VerificationRow(**fields) for fields in progress.get("rows", ())])

    def _show(self, folder: Path, said: str) -> None:
        self._folder = folder
        self.summary.setText(said)
        if self.table.currentItem() is None:
            self.table.setCurrentIndex(self.table.model().index(0, 0))
        self._show_figure(self.table.currentItem())

    def _show_figure(self, item: QTreeWidgetItem | None, _: QTreeWidgetItem | None = None) -> None:
        """Show the figure of the current row's case, once the run has ended."""
        self._remove_figure()
        if item is None or self._folder is None:
            return
        path = self._folder / f"{item.data(0, _CASE)}.png"
        if path.exists():
            title = (item.parent() or item).text(0)
            self.figure = FigureView(path, tr("Exact curve and answers of {case}").format(case=title))
            self.figure.setMaximumHeight(_FIGURE)
            self._column.insertWidget(self._column.indexOf(self.table) + 1, self.figure)

    def _remove_figure(self) -> None:
        if self.figure is not None:
            self._column.removeWidget(self.figure)
            self.figure.deleteLater()
            self.figure = None

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.table.text)


class VerificationTable(QTreeWidget):
    """Table of the cases, each with a title, a row per quantity, and reasons."""

    def __init__(self) -> None:
        super().__init__(objectName="verification", accessibleName=tr("Cases with exact answers"))
        self.setHeaderLabels(COLUMN_TITLES)
        self.setRootIsDecorated(False)
        self.setItemsExpandable(False)
        self.setIndentation(12)
        self.setUniformRowHeights(True)
        self.setHorizontalScrollMode(QTreeWidget.ScrollMode.ScrollPerPixel)
        self.setFont(with_tabular_figures(self.font()))
        head = self.header()
        head.setStretchLastSection(False)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Fixed)
        for column in range(1, len(COLUMN_TITLES)):
            self.headerItem().setTextAlignment(column, _RIGHT)
        self.remove_rows()

    def remove_rows(self) -> None:
        """Remove all rows."""
        self.clear()
        self._widest = 0
        self._lines = ["\t".join(COLUMN_TITLES)]

    def add_case(self, rows: list[VerificationRow]) -> None:
        """Add the rows of a finished case, if there are any, and scroll there."""
        if not rows:
            return
        title = last = self._item(self, rows[0].case, [f"{rows[0].case}  {rows[0].title}"])
        bold = QFont(self.font())
        bold.setWeight(QFont.Weight.DemiBold)
        title.setFont(0, bold)
        for row in rows:
            if row.quantity:
                last = self._item(title, row.case, row_cells(row))
                self._widest = max(self._widest, self.fontMetrics().horizontalAdvance(row.quantity))
        for reason in dict.fromkeys(row.reason for row in rows):
            if reason:
                last = self._item(title, rows[0].case, [reason])
                last.setFirstColumnSpanned(True)
                last.setDisabled(True)
        title.setFirstColumnSpanned(True)
        title.setExpanded(True)
        self._fill()
        self.scrollToItem(last)

    def _item(
        self, parent: QTreeWidget | QTreeWidgetItem, case: str, cells: Sequence[str]
    ) -> QTreeWidgetItem:
        self._lines.append("\t".join(cells))
        item = QTreeWidgetItem(parent, list(cells))
        item.setData(0, _CASE, case)
        for column in range(1, len(cells)):
            item.setTextAlignment(column, _RIGHT)
        return item

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Give the quantities the width left by the numbers."""
        super().resizeEvent(event)
        self._fill()

    def _fill(self) -> None:
        numbers = sum(map(self.columnWidth, range(1, self.columnCount())))
        least = self._widest + 3 * self.indentation()
        self.setColumnWidth(0, max(least, self.viewport().width() - numbers))

    @property
    def text(self) -> str:
        """All rows, with cells separated by tabs for spreadsheets."""
        return "\n".join(self._lines)
