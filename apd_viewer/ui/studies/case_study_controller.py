"""Controller of case studies: their dialog, process and dock."""

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDockWidget, QFileDialog, QMessageBox, QWidget

from apd_viewer.cases.case_file import DONE
from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.cases.results import read_results, status_text
from apd_viewer.cases.run_case import case_session
from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.session import Session
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.posing.motion_ghost import MotionGhost
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.plan_dialog import PlanDialog
from apd_viewer.ui.studies.result_columns import ResultsSnapshot, shown_columns
from apd_viewer.ui.studies.results_panel import ResultsPanel
from apd_viewer.ui.studies.study_run import StudyRun, scheduler_option, stored_options
from apd_viewer.ui.widgets.background_task import BackgroundTask
from apd_viewer.ui.widgets.theme import Theme

_EVERY = 1000  # ms
_TIMES = 20.0  # smallest pause between two reads, as a multiple of the time to read


class CaseStudyController(QObject):
    """Designs, runs and shows studies, one at a time.

    Parameters
    ----------
    dock : QDockWidget
        For the results.
    files : FileController
        Asks before unsaved work is left.
    open_document : callable
        Function giving the open state, the active handle and the view; None without a mesh.
    ghost : MotionGhost
        Of handles where a motion would bring them.
    """

    def __init__(
        self,
        window: QWidget,
        dock: QDockWidget,
        preferences: Preferences,
        session: Session,
        files: FileController,
        open_document: Callable[[], tuple[State, int, View] | None],
        notice: Notice,
        ghost: MotionGhost,
    ) -> None:
        super().__init__(window)
        self._window, self._dock, self._memory, self._notice = window, dock, preferences, notice
        self._session, self._filing, self._opened = session, files, open_document
        self._ghost = ghost
        self._studied: Document | None = None  # document of the latest study, also stored in its folder
        self.dialog: PlanDialog | None = None
        self.panel = ResultsPanel()
        dock.setWidget(self.panel)
        self.run = StudyRun(self)
        self.folder_watch = FolderWatch(self)
        self.folder_watch.results_read.connect(self.panel.show_results)
        self.folder_watch.failed.connect(notice.show_failure)
        dock.visibilityChanged.connect(self.folder_watch.set_enabled)
        self.run.reported.connect(self._report)
        self.run.ended.connect(self._end)
        self.panel.case_requested.connect(self._open_case)
        self.panel.continue_requested.connect(self._continue_study)
        self.panel.retry_requested.connect(partial(self._continue_study, retry_failed=True))
        self.panel.stop_requested.connect(self._stop)
        self.panel.open_requested.connect(self.ask_for_folder)

    # Commands

    def design_study(self) -> None:
        """Open the dialog to design a study of the current document."""
        found = self._opened()
        if found is None:
            return
        state, handle, view = found
        if state.document.paint_problem:
            self._notice.show_failure(state.document.paint_problem)
        elif self._is_free():
            if self.dialog is None:
                self.dialog = dialog = PlanDialog(
                    self._window, self._session, handle, view, self._memory, self._ghost
                )
                dialog.study_designed.connect(partial(self._begin_designed, state.document))
                dialog.finished.connect(self._forget_dialog)
            self.dialog.show()
            self.dialog.raise_()
            self.dialog.activateWindow()

    def ask_for_folder(self) -> None:
        """Ask for the folder of a study and show its results."""
        folder = QFileDialog.getExistingDirectory(
            self._window, tr("Open the folder of a study"), str(self._memory.last_folder)
        )
        if folder:
            self.open_study(Path(folder))

    def open_study(self, folder: Path) -> None:
        """Show the results in a folder, and watch them for changes."""
        if not (folder / DATABASE_NAME).is_file() and folder != self.run.folder:
            self._notice.show_failure(
                tr("{folder} contains no study; choose a study folder.").format(folder=folder.name)
            )
            return
        self.panel.show_study(folder)
        self.panel.show_running(folder == self.run.folder, self.run.stopping)
        self.folder_watch.watch_folder(folder)
        self._dock.show()
        self._dock.raise_()

    def _forget_dialog(self) -> None:
        self.dialog = None

    def _is_free(self) -> bool:
        """True if no study is running; otherwise show a message."""
        if self.run.is_running:
            self._notice.show_failure(tr("A study is running; wait for it or stop it, then begin another."))
            self._dock.show()
        return not self.run.is_running

    def _begin_designed(self, document: Document, folder: Path, options: list[str]) -> None:
        self._studied = document
        self._begin(folder, options)

    def _begin(self, folder: Path, options: list[str] | None, retry_failed: bool = False) -> None:
        if not self._is_free():
            return
        try:
            self.run.begin(folder, options, retry_failed)
        except InputError as error:
            self._notice.show_failure(str(error))
            return
        self.open_study(folder)

    def _continue_study(self, retry_failed: bool = False) -> None:
        if self.panel.folder is not None and self._confirm_scheduler(stored_options(self.panel.folder)):
            self._begin(self.panel.folder, None, retry_failed)

    def _confirm_scheduler(self, options: list[str]) -> bool:
        """Ask before connecting to a scheduler named in a folder of unknown origin."""
        address = scheduler_option(options)
        if not address:
            return True
        buttons = QMessageBox.StandardButton
        answer = QMessageBox.question(
            self._window,
            tr("Continue on a scheduler"),
            tr("Connect to {address}? Answer Yes only if you trust it: it can run programs here.").format(
                address=address
            ),
            buttons.Yes | buttons.Cancel,
            buttons.Cancel,
        )
        return answer == buttons.Yes

    def _stop(self) -> None:
        self.run.stop()
        if self.run.is_running:
            self.panel.show_running(True, stopping=True)

    # Progress and end of a run

    def _report(self, progress: object) -> None:
        if self.run.folder == self.panel.folder and isinstance(progress, dict):
            self.panel.show_progress(progress)

    def _end(self, folder: object, sentence: str) -> None:
        if self.panel.folder is not None and folder == self.panel.folder:
            self.panel.show_running(False, sentence=sentence)
            self.folder_watch.watch_folder(self.panel.folder)
        elif sentence:
            self._notice.show_failure(sentence)

    # Opening of cases

    def _open_case(self, row: int) -> None:
        """Open the shape of a case, or show the reason for a missing shape."""
        folder, found = self.panel.folder, self.panel.model.rows[row]
        if folder is None:
            return
        if found.status != DONE:
            words = found.sentence or status_text(found.status)
            self._notice.show_message(f"{self.panel.model.row_name(row)}: {words}")
            return
        case = self.panel.model.row_name(row, is_short=True)
        name = tr("{case} of {study}").format(case=case, study=folder.name)

        def go() -> None:
            before = self._opened()
            self._session.files.open_result(
                name, lambda: _with_kept_view(before, *case_session(folder, found.key)), is_named=True
            )

        state = self._session.store.state
        if state is not None and state.document is self._studied:  # already saved with the study
            go()
        else:
            self._filing.run_after_save_prompt(go)

    # Window events

    def set_theme(self, theme: Theme) -> None:
        """Recolour widgets not covered by the style sheet."""
        self.panel.set_theme(theme)

    def ask_before_closing(self, event: QCloseEvent) -> None:
        """Ask before the window closes during a running study."""
        if not self.run.is_running or not event.isAccepted():
            return
        buttons = QMessageBox.StandardButton
        answer = QMessageBox.question(
            self._window,
            tr("A study is running"),
            tr("Close and stop the study? Finished cases are kept; File > Open study continues it."),
            buttons.Close | buttons.Cancel,
            buttons.Cancel,
        )
        if answer != buttons.Close:
            event.ignore()

    def close(self) -> None:
        """End the run, and stop loading results."""
        if self.dialog is not None:
            self.dialog.close()
        self.run.kill()
        self.folder_watch.close()


def _with_kept_view(before: tuple[State, int, View] | None, state: State, view: View) -> tuple[State, View]:
    """State of a case with its view; the previous view is kept for an equal mesh.

    The shapes can then be compared.
    """
    same = before is not None and np.array_equal(before[0].document.mesh.V, state.document.mesh.V)
    return state, before[2] if before is not None and same else view


class FolderWatch(QObject):
    """Reads results on a thread, initially and after each change.

    Attributes
    ----------
    results_read : Signal(object)
        :class:`ResultsSnapshot`.
    failed : Signal(str)
        Reason for unreadable results, once.
    """

    results_read = Signal(object)
    failed = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.folder: Path | None = None
        self._seen: tuple[int, int] | None = None
        self._next, self._said = 0.0, ""
        self._shown = True
        self._task = BackgroundTask(self)
        self._task.done.connect(self._take)
        self._timer = QTimer(self, interval=_EVERY, timeout=self.check_folder)

    def watch_folder(self, folder: Path) -> None:
        """Start watching a folder, even before it holds results."""
        self.folder, self._seen, self._next, self._said = folder, None, 0.0, ""
        self.set_enabled(self._shown)

    def set_enabled(self, on: bool) -> None:
        """Enable or suspend the watching, depending on the visibility of the results."""
        self._shown = on
        if on and self.folder is not None:
            self._timer.start()
            self.check_folder()
        else:
            self._timer.stop()

    def check_folder(self) -> None:
        """Read the results if they have changed."""
        folder = self.folder
        if folder is None or self._task.is_busy or time.monotonic() < self._next:
            return
        try:
            found = (folder / DATABASE_NAME).stat()
        except OSError:
            return
        stamp = found.st_mtime_ns, found.st_size
        if stamp != self._seen:
            self._seen = stamp
            self._task.begin(lambda _: _results(folder))

    def _take(self, found: tuple[Path, ResultsSnapshot | str, float] | None) -> None:
        if found is None or found[0] != self.folder:
            return
        _, results, took = found
        self._next = time.monotonic() + _TIMES * took
        if isinstance(results, ResultsSnapshot):
            self._said = ""
            self.results_read.emit(results)
        else:
            self._seen = None  # read again at the next check, even if the file is unchanged
            if results != self._said:
                self.failed.emit(results)
            self._said = results

    def close(self) -> None:
        """Stop watching the folder."""
        self._timer.stop()
        self.folder = None
        self._task.close()


def _results(folder: Path) -> tuple[Path, ResultsSnapshot | str, float]:
    started = time.monotonic()
    try:
        table = read_results(folder)
        found: ResultsSnapshot | str = ResultsSnapshot(table, shown_columns(table))
    except InputError as error:
        found = str(error)
    return folder, found, time.monotonic() - started
