"""Results of a study: progress, table, scatter plot and curves."""

import time
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QResizeEvent
from PySide6.QtWidgets import QPushButton, QSizePolicy, QWidget

from apd_viewer.cases.case_file import DONE, FAILED
from apd_viewer.cases.results import WAITING, WRONG, ResultTable
from apd_viewer.cases.study_progress import CaseCounts, ProgressMeter
from apd_viewer.language import comma_separated, tr, trn
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.ui.studies.case_plots import CaseColors, CaseCurves, ScatterPlot
from apd_viewer.ui.studies.result_columns import ResultsSnapshot
from apd_viewer.ui.studies.result_table import ResultModel, ResultsView
from apd_viewer.ui.studies.study_run import may_continue
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.pane_splitter import Pane, PaneSplitter
from apd_viewer.ui.widgets.theme import Theme
from apd_viewer.ui.widgets.thin_bar import ElidedLabel, ThinBar

_SMALLEST, _NARROWEST = QSize(320, 160), 72  # px: minimum size of the panel; minimum width of the study name
# Preferred width, and height as a clipped fraction of the window; the mesh needs most of the space.
_WIDTH, _SHARE, _LOWEST, _HIGHEST = 960, 0.3, 210, 420
_SILENT = 120.0  # s without a new result before a run elsewhere counts as stopped


class ResultsPanel(QWidget):
    """Contents of the dock with the results of a study.

    Attributes
    ----------
    case_requested : Signal(int)
        A row of the plan whose shape is to be opened.
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
        self.panes = PaneSplitter(
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
        self.bar = ThinBar()
        self.name = ElidedLabel(objectName="heading", margin=8, minimumWidth=_NARROWEST)
        self.message = ElidedLabel(objectName="quiet")
        self.message.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.go_on = QPushButton(tr("Continue"), toolTip=tr("Compute the cases that are missing"))
        self.retry = QPushButton(tr("Run failed again"), toolTip=tr("Run failed cases once more"))
        self.stop = QPushButton(tr("Stop"))
        self.stop.clicked.connect(self.stop_requested)
        self.show_folder = QPushButton(tr("Show folder"), toolTip=tr("Plan, tables and cases as files"))
        self.open = QPushButton(tr("Open study…"))
        self.open.clicked.connect(self.open_requested)
        self.go_on.clicked.connect(self.continue_requested)
        self.retry.clicked.connect(self.retry_requested)
        self.show_folder.clicked.connect(self._show_folder)
        buttons = self.go_on, self.retry, self.stop, self.show_folder, self.open
        head = row_layout(self.name, self.panes.tabs, (self.message, 1), *buttons, margins=(4, 4, 8, 4))
        column_layout(head, self.bar, (self.panes, 1), spacing=0, parent=self)

    # Display

    def show_study(self, folder: Path) -> None:
        """Set the folder of a study, before its results are read."""
        self.folder = folder
        self.status.reset_for(folder)
        self.name.setText(folder.name)
        self.name.setToolTip(str(folder))
        self.curves.show_study(folder)
        self._follow_status()

    def show_results(self, results: ResultsSnapshot) -> None:
        """Show results read from the study folder."""
        self.model.show_results(results.table, results.columns)
        self.status.set_results(results.table)
        self.scatter.refresh()
        self._choose()
        self._follow_status()

    def show_progress(self, progress: dict[str, Any]) -> None:
        """Show the progress reported by the running command."""
        self.status.set_progress(progress)
        self._follow_status()

    def show_running(self, is_running: bool, stopping: bool = False, sentence: str = "") -> None:
        """Show whether the study runs in this program, and how the run ended."""
        self.status.set_running(is_running, stopping, sentence)
        self._follow_status()

    def _follow_status(self) -> None:
        status = self.status
        self.message.setText(status.text)
        self.bar.show_fraction(status.finished_fraction)
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

    # Selection of cases

    def _choose(self) -> None:
        colors = self._colors.colors_of(self.table.chosen_rows)
        self.scatter.mark_rows(colors)
        self.curves.show_cases(colors)

    def _pick(self, row: int, more: bool) -> None:
        """Select the row of a dot and open its case, or toggle it if ``more``."""
        if more:
            self.table.toggle_row(row)
        else:
            self.table.choose_rows([row])
            self.case_requested.emit(row)

    def _show_folder(self) -> None:
        if self.folder is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.folder)))

    # Theme and colours

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
        """Minimum size, to fit into a column beside the canvas."""
        return _SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the panes by the aspect ratio of the dock."""
        super().resizeEvent(event)
        self.panes.arrange(self.size())


class StudyStatus:
    """Counts of a study, from its results or from the command that runs it.

    Attributes
    ----------
    is_running, is_stopping : bool
        Whether this program runs it, and whether it only finishes the running cases.
    """

    def __init__(self) -> None:
        self._folder: Path | None = None
        self.is_running = self.is_stopping = False
        self._sentence = ""
        self._forget()

    def _forget(self) -> None:
        self._counts: CaseCounts | None = None
        self._wrong = 0
        self._pace: ProgressMeter | None = None
        self._grown, self._began = -_SILENT, time.monotonic()

    def reset_for(self, folder: Path) -> None:
        """Reset the counts for the study in another folder."""
        self._folder, self._sentence = folder, ""
        self.is_running = self.is_stopping = False
        self._forget()

    def set_running(self, is_running: bool, stopping: bool, sentence: str) -> None:
        """Set whether this program runs the study, and the sentence about its end."""
        if is_running and not self.is_running:
            self._forget()
            self._began = time.monotonic()
        self.is_running, self.is_stopping, self._sentence = is_running, stopping, sentence

    def set_progress(self, progress: dict[str, Any]) -> None:
        """Update the counts from the progress reported by the command."""
        self._counts = CaseCounts(*(progress[name] for name in CaseCounts._fields))

    def set_results(self, table: ResultTable) -> None:
        """Update the counts from the results, unless a run reports them itself."""
        states = [row.status for row in table.rows if row.status in (DONE, FAILED, WAITING)]
        self._wrong = sum(row.status == WRONG for row in table.rows)
        done, failed = len(states) - states.count(WAITING), states.count(FAILED)
        if self.is_running:
            return
        before = self._counts
        # The counts have grown, unless cases were run again or the plan has changed.
        grown = before is not None and 0 <= failed - before.failed <= done - before.finished
        if before is None or self._pace is None or before.cases != len(states) or not grown:
            self._pace = ProgressMeter(len(states), done, failed)
        else:
            for k in range(done - before.finished):
                self._pace.count_case(k < failed - before.failed)
            if done > before.finished:
                self._grown = time.monotonic()
        self._counts = self._pace.counts(0)

    @property
    def _has_grown_recently(self) -> bool:
        """True if results of a run elsewhere have recently arrived."""
        return time.monotonic() - self._grown < _SILENT

    @property
    def is_unfinished(self) -> bool:
        """True if cases remain to be computed."""
        return self.is_running or (self._counts is not None and self._counts.finished < self._counts.cases)

    @property
    def finished_fraction(self) -> float | None:
        """Finished fraction of the cases; None while unknown."""
        if self._counts is None:
            return None if self.is_running else 0.0
        return self._counts.fraction

    @property
    def _may_run(self) -> bool:
        """True if the study can run here, and seems not to run elsewhere."""
        folder = self._folder
        return (
            folder is not None
            and not self.is_running
            and not self._has_grown_recently
            and may_continue(folder)
        )

    @property
    def may_continue(self) -> bool:
        """True if the remaining cases can be computed on this machine."""
        counts = self._counts
        return counts is not None and counts.finished < counts.cases and self._may_run

    @property
    def may_retry(self) -> bool:
        """True if failed cases can be run again on this machine."""
        return self._counts is not None and self._counts.failed > 0 and self._may_run

    @property
    def text(self) -> str:
        """Summary of counts, rate, remaining time and state."""
        if self._counts is None:
            waiting = tr("starting …") if self.is_running else ""
            return self._sentence or waiting or (tr("No study is open.") if self._folder is None else "")
        now = self._counts
        words = [tr("{done:,} of {cases:,} done").format(done=now.finished, cases=now.cases)]
        if now.failed:
            words.append(tr("{failed:,} failed").format(failed=now.failed))
        if self._wrong:
            words.append(trn("{n:,} row wrong", "{n:,} rows wrong", self._wrong).format(n=self._wrong))
        if self.is_running and now.running:
            words.append(tr("{running:,} running").format(running=now.running))
        if (
            now.finished < now.cases
            and (self.is_running or self._has_grown_recently)
            and now.rate
            and now.seconds_left is not None
        ):
            words.append(tr("{rate:.3g} per minute").format(rate=60.0 * now.rate))
            words.append(tr("{time} left").format(time=duration_text(now.seconds_left)))
        elif self.is_running and now.running:
            words.append(
                tr("{duration} so far").format(duration=duration_text(time.monotonic() - self._began))
            )
        if self.is_stopping:
            words.append(tr("finishing the running cases"))
        summary = comma_separated(words)
        return f"{summary}. {self._sentence}" if self._sentence else summary
