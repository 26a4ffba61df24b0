"""Results of a study: progress, table, scatter plot and curves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QResizeEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from apd_viewer.language import tr
from apd_viewer.ui.case_studies.case_colors import CaseColors
from apd_viewer.ui.case_studies.case_curves import CaseCurves
from apd_viewer.ui.case_studies.folder_watch import ReadResults
from apd_viewer.ui.case_studies.result_model import ResultModel
from apd_viewer.ui.case_studies.result_table import ResultsView
from apd_viewer.ui.case_studies.scatter_plot import ScatterPlot
from apd_viewer.ui.case_studies.study_status import StudyStatus
from apd_viewer.ui.panel.status_bar import ElidedLabel
from apd_viewer.ui.widgets.side_by_side import Pane, SideBySide
from apd_viewer.ui.widgets.theme import Theme

_SCALE = 1000
_SMALLEST, _NARROWEST = QSize(320, 160), 72  # px, of it and of the name of a study
# Of the window, at first: the mesh is more important.
_WIDTH, _SHARE, _LOWEST, _HIGHEST = 960, 0.3, 210, 420


class ResultsPanel(QWidget):
    """Contents of the dock of a study.

    Attributes
    ----------
    case_requested : Signal(int)
        A row of the plan whose shape is to be opened.
    continue_requested, retry_requested, stop_requested, open_requested : Signal()
    model : ResultModel
    table : ResultsView
    scatter : ScatterPlot
    curves : CaseCurves
    folder : Path or None
    """

    case_requested = Signal(int)
    continue_requested = Signal()
    retry_requested = Signal()
    stop_requested = Signal()
    open_requested = Signal()

    def __init__(self) -> None:
        super().__init__(objectName="casestudy")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.folder: Path | None = None
        self.status = StudyStatus()
        self._colors = CaseColors()
        self.model = ResultModel()
        self.model.setParent(self)
        self.table = ResultsView(self.model)
        self.scatter = ScatterPlot(self.model)
        self.curves = CaseCurves(self.model)
        self.panes = SideBySide(
            (
                Pane(tr("Table"), self.table, 34),
                Pane(tr("Plot"), self.scatter, 42),
                Pane(tr("Curves"), self.curves, 24),
            )
        )
        self.table.choice_changed.connect(self._choose)
        self.table.case_opened.connect(self.case_requested)
        self.scatter.view.dot_picked.connect(self._pick)
        self._lay_out()
        self._follow_status()

    def _lay_out(self) -> None:
        self.bar = QProgressBar(maximum=_SCALE, textVisible=False, objectName="thin")
        self.name = ElidedLabel(objectName="heading", margin=8, minimumWidth=_NARROWEST)
        self.words = ElidedLabel(objectName="quiet")
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.go_on = QPushButton(tr("Continue"), toolTip=tr("Compute the cases that are missing"))
        self.retry = QPushButton(tr("Run failed again"), toolTip=tr("Run failed cases once more"))
        self.stop = QPushButton(tr("Stop"))
        self.show_folder = QPushButton(tr("Show folder"), toolTip=tr("Plan, tables and cases as files"))
        self.open = QPushButton(tr("Open study…"))
        self.go_on.clicked.connect(self.continue_requested)
        self.retry.clicked.connect(self.retry_requested)
        self.stop.clicked.connect(self.stop_requested)
        self.open.clicked.connect(self.open_requested)
        self.show_folder.clicked.connect(self._show_folder)
        head = QHBoxLayout(spacing=8)
        head.setContentsMargins(4, 4, 8, 4)
        head.addWidget(self.name)
        head.addWidget(self.panes.tabs)
        head.addWidget(self.words, 1)
        for button in (self.go_on, self.retry, self.stop, self.show_folder, self.open):
            head.addWidget(button)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.bar)
        column.addWidget(self.panes, 1)

    # What is shown

    def show_study(self, folder: Path) -> None:
        """Show another study, of which nothing is read yet."""
        self.folder = folder
        self.status.reset_for(folder)
        self.name.setText(folder.name)
        self.name.setToolTip(str(folder))
        self.curves.show_study(folder)
        self._follow_status()

    def show_results(self, results: ReadResults) -> None:
        """Show the results of the study as they were read."""
        self.model.show_results(results.table, results.columns)
        self.status.set_results(results.table)
        self.scatter.refresh()
        self._choose()
        self._follow_status()

    def show_progress(self, progress: dict[str, Any]) -> None:
        """Show the progress told by the command that runs it."""
        self.status.set_progress(progress)
        self._follow_status()

    def show_running(self, is_running: bool, stopping: bool = False, sentence: str = "") -> None:
        """Show whether it runs here, and how it has ended."""
        self.status.set_running(is_running, stopping, sentence)
        self._follow_status()

    def _follow_status(self) -> None:
        status = self.status
        self.words.setText(status.text)
        self.bar.setMaximum(0 if status.share is None else _SCALE)  # of unknown length
        self.bar.setValue(round(_SCALE * (status.share or 0.0)))
        self.bar.setVisible(status.is_unfinished)
        self.go_on.setVisible(status.may_continue)
        self.retry.setVisible(status.may_retry)
        self.stop.setVisible(status.is_running)
        self.stop.setText(tr("Stop now") if status.is_stopping else tr("Stop"))
        self.stop.setToolTip(
            tr("End the running cases too; they are computed again")
            if status.is_stopping
            else tr("Finish the running cases, and start no more; Continue goes on")
        )
        self.show_folder.setVisible(self.folder is not None)
        self.open.setVisible(self.folder is None)

    # Choosing cases

    def _choose(self) -> None:
        colors = self._colors.colors_of(self.table.chosen_rows)
        self.scatter.mark_rows(colors)
        self.curves.show_cases(colors)

    def _pick(self, row: int, more: bool) -> None:
        """Choose the row of a dot, or add it; open it alone."""
        if more:
            self.table.toggle(row)
        else:
            self.table.choose([row])
            self.case_requested.emit(row)

    def _show_folder(self) -> None:
        if self.folder is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.folder)))

    # Looks

    def set_theme(self, theme: Theme) -> None:
        """Redraw in the colours of a theme."""
        self.model.theme = theme
        for view in (self.scatter.view, self.curves.view):
            view.theme = theme
            view.update()
        self.table.viewport().update()

    def sizeHint(self) -> QSize:
        """Height for a readable table below a larger canvas."""
        return QSize(_WIDTH, round(min(_HIGHEST, max(_LOWEST, _SHARE * self.window().height()))))

    def minimumSizeHint(self) -> QSize:
        """As narrow as a column beside the canvas."""
        return _SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the parts by the aspect of the dock."""
        super().resizeEvent(event)
        self.panes.arrange(self.size())
