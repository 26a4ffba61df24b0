"""Base dialog to run a command with options, and to show and save its results."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QSize, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QDialog, QFileDialog, QGridLayout, QLabel, QLayout, QPushButton, QWidget

from apd_viewer.files.storage.atomic_file import remove_scratch_of, staging_folder, unused_folder
from apd_viewer.language import tr
from apd_viewer.session.background_job import Job, JobOutcome
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.command_process import CommandProcess
from apd_viewer.ui.widgets.box_layouts import (
    STRETCH,
    add_parts,
    column_layout,
    largest_on_screen,
    resize_on_screen,
    row_layout,
)
from apd_viewer.ui.widgets.fields import NumberField
from apd_viewer.ui.widgets.figure_view import FigureView
from apd_viewer.ui.widgets.help_button import HelpButton
from apd_viewer.ui.widgets.thin_bar import ThinBar

_WIDTH, _WIDTH_WITH_FIGURE = 640, 900  # px: width without and with a figure


class RunDialog(QDialog):
    """Base dialog with options, a run bar, and the summary and figure of the result.

    Parameters
    ----------
    figure : str
        File name of the figure among the results.
    caption : str
        Description of the figure for screen readers.

    Attributes
    ----------
    figure_caption : str
        That of the figure of the last run.
    figure_is_drawn : bool
        Whether it consists of lines and text on white.
    """

    def __init__(self, window: QWidget, title: str, run: RunBar, figure: str = "", caption: str = "") -> None:
        super().__init__(window, objectName="study")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(title)
        self.run, self._named, self.figure_caption = run, figure, caption
        self.run.busy_changed.connect(self._show_busy)
        self.run.ended.connect(self._show)
        self.figure_is_drawn = True
        self.figure: FigureView | None = None
        self._column = column_layout(spacing=12, margins=(20, 16, 20, 16), parent=self)

    def lay_out(self, description: str, rows: Sequence[tuple[str, QLayout]]) -> None:
        """Arrange the description and the titled rows of options."""
        self._column.addWidget(QLabel(description, objectName="quiet", wordWrap=True))
        self._asks = QWidget()
        self._column.addWidget(self._asks)
        self._rows = grid = QGridLayout(self._asks, horizontalSpacing=16, verticalSpacing=8)
        grid.setContentsMargins(0, 0, 0, 0)
        add_titled_rows(grid, rows)
        tip = tr("Show or hide the options, whose room the figure takes on a low screen")
        self.options = QPushButton(tr("Options"), toolTip=tip, checkable=True, checked=True, visible=False)
        self.options.toggled.connect(self._asks.setVisible)
        self.options.toggled.connect(lambda: self._fit(self.width()))
        self.run.add_button(self.options, lambda: self.figure is not None)
        self.summary = QLabel(wordWrap=True, visible=False)
        self.summary.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        add_parts(self._column, self.summary, STRETCH, self.run)
        self._fit(_WIDTH)

    def _show_busy(self, on: bool) -> None:
        self._asks.setEnabled(not on)
        # Reserve room for the progress bar above the button, which would otherwise shrink the fields.
        self._column.activate()
        if self._column.totalHeightForWidth(self.width()) > self.height():
            self._fit(self.width())

    def _show(self, folder: Path, said: str) -> None:
        # Omit the line with the temporary folder; repeated spaces align columns only in a terminal.
        lines = "\n".join(re.sub(" +", " ", line.lstrip(" ")) for line in said.splitlines()[1:])
        self.summary.setText(re.sub(r"-(?=\d)", "−", lines))
        self.summary.show()
        if self.figure is not None:
            self._column.removeWidget(self.figure)
            self.figure.deleteLater()
        self.figure = FigureView(folder / self._named, self.figure_caption, self.figure_is_drawn)
        self._column.insertWidget(self._column.indexOf(self.summary), self.figure)
        self.figure.show()  # hidden widgets take no room
        self.options.show()
        width = max(self.width(), _WIDTH_WITH_FIGURE)
        self.options.setChecked(True)
        self.options.setChecked(not self._fit(width))

    def _fit(self, width: int) -> int:
        """Set width and height; return the height that a low screen takes from the figure."""
        self._rows.activate()  # otherwise a longer text changes the layout only in the event loop
        self._column.activate()
        lacking = 0
        if self.figure is not None:
            self.figure.shrink_by(0)
            lacking = max(0, self._column.totalHeightForWidth(width) - largest_on_screen(self).height())
            self.figure.shrink_by(lacking)
        resize_on_screen(self, QSize(width, self._column.totalHeightForWidth(width)))
        return lacking

    def done(self, result: int) -> None:
        """Close the dialog, and end a run in progress."""
        self.run.discard_run()
        super().done(result)


def count_field(name: str, least: int, most: int, value: int, suffix: str = "") -> NumberField:
    """Field for a whole number."""
    field = NumberField(
        accessibleName=name, minimum=least, maximum=most, value=value, decimals=0, suffix=suffix
    )
    field.setFixedWidth(72)
    return field


def add_titled_rows(grid: QGridLayout, rows: Sequence[tuple[str, QLayout]]) -> None:
    """Fill a grid with rows, each with its title in front."""
    grid.setColumnStretch(1, 1)
    for number, (title, row) in enumerate(rows):
        grid.addWidget(QLabel(title, objectName="heading"), number, 0)
        grid.addLayout(row, number, 1)


class RunBar(QWidget):
    """Runs a command with results in a temporary folder, and saves them on request.

    Parameters
    ----------
    start : str
        Text of the start button.
    name : str
        Name of the folder for saved results.
    preferences : Preferences
        Preferences with the folder last used.
    mesh : str
        File name of the mesh among the results, if one can be opened in the window.

    Attributes
    ----------
    start_requested : Signal()
        Whoever owns it then calls :meth:`begin`.
    ended : Signal(object, str)
        The folder of the results, and what the command said.
    mesh_requested : Signal(object)
        The file of the saved mesh, which is to be opened.
    busy_changed : Signal(bool)
        Work has begun, or is over.
    scratch_folder : Path or None
        The temporary folder.
    """

    start_requested = Signal()
    ended = Signal(object, str)
    mesh_requested = Signal(object)
    busy_changed = Signal(bool)
    _delivered = Signal(object)

    def __init__(self, start: str, name: str, preferences: Preferences, mesh: str = "") -> None:
        super().__init__()
        self._name, self.mesh = name, mesh
        self._memory = preferences
        self.scratch_folder: Path | None = None
        self._beside: Path | None = None
        self._job: Job | None = None
        self._saved: Path | None = None
        self.command = CommandProcess(self)
        self.command.reported.connect(self._show_progress)
        self.command.ended.connect(self._end)
        self.command.failed.connect(self.show_failure)
        self._delivered.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        application = QCoreApplication.instance()
        assert application is not None
        application.aboutToQuit.connect(self.discard_run)  # quitting by a signal closes no dialog
        self._lay_out(start)
        self._show_busy(False)

    def _lay_out(self, start: str) -> None:
        self.message = QLabel(objectName="quiet", wordWrap=True)
        self.message.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.bar = ThinBar()
        tip = tr("Closes the dialog and opens the saved mesh in the window; undo returns to the mesh before")
        self.open_mesh = QPushButton(tr("Open mesh"), toolTip=tip, clicked=self._ask_for_mesh)
        self.open = QPushButton(tr("Open folder"), clicked=self._open)
        self.save = QPushButton(tr("Save…"), clicked=self._ask_where)
        self.cancel = QPushButton(tr("Cancel"), clicked=self.stop)
        self.start = QPushButton(start, objectName="primary", clicked=lambda: self.start_requested.emit())
        self.start.setDefault(True)
        self.help = HelpButton()
        buttons = self.open_mesh, self.open, self.save, self.cancel, self.start
        self._row = row_layout(self.help, (self.message, 1), *buttons)
        column_layout(self.bar, self._row, spacing=8, parent=self)

    def add_button(self, button: QPushButton, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Add a button beside the start button, hidden while a command runs."""
        self._row.insertWidget(self._row.indexOf(self.start), button)
        self.busy_changed.connect(lambda on: button.setVisible(not on and is_wanted()))

    @property
    def is_running(self) -> bool:
        """True while a command is in progress."""
        return self._job is not None or self.command.is_running

    @property
    def has_unsaved_results(self) -> bool:
        """True while a command runs, or if its results are saved nowhere yet."""
        return self.is_running or (self.scratch_folder is not None and self._saved is None)

    @property
    def results_folder(self) -> Path:
        """Folder of the last command's results."""
        assert self.scratch_folder is not None
        return self.scratch_folder / "results"

    def begin(
        self, make_arguments: Callable[[Path, Path], list[str]], other_folder: Path | None = None
    ) -> None:
        """Start a command in a new temporary folder.

        Parameters
        ----------
        make_arguments : callable
            ``make_arguments(scratch, results)`` gives what to run, all but ``--progress-lines``: it is called
            on a thread, and may write to the first folder what the command reads. The second is empty: there
            the command has to write its results.
        other_folder : Path, optional
            Another folder that it writes to.
        """
        self.discard_run()
        self._saved, self._beside = None, other_folder
        self.scratch_folder = scratch = Path(tempfile.mkdtemp(prefix="apd-viewer-"))
        results = self.results_folder

        def work() -> list[str]:
            results.mkdir()
            return [*make_arguments(scratch, results), "--progress-lines"]

        start = partial(self.command.start, scratch=scratch)
        self._job = Job(tr("Preparing"), work, start, self._delivered.emit)
        self.message.setText(tr("preparing"))
        self.bar.show_fraction(None)
        self._show_busy(True)

    def stop(self) -> None:
        """End the command in progress and delete its results."""
        self.discard_run()
        self.message.setText(tr("Cancelled; nothing was written."))
        self._show_busy(False)

    def discard_run(self) -> None:
        """End the command in progress, and delete unsaved results."""
        if self._job is not None:
            job, self._job = self._job, None
            job.join()
        self.command.cancel()
        if self.scratch_folder is not None:
            shutil.rmtree(self.scratch_folder, ignore_errors=True)
            self.scratch_folder = None
        if self._beside is not None:
            remove_scratch_of(self.command.process_id, self._beside)
            self._beside = None

    def show_failure(self, sentence: str) -> None:
        """Show the reason for a missing result."""
        self.message.setText(sentence)
        self._show_busy(False)

    def _receive(self, outcome: JobOutcome) -> None:
        if outcome.job is not self._job:  # the run has been cancelled
            return
        self._job = None
        if outcome.failure is not None:
            self.show_failure(outcome.failure)
        else:
            outcome.job.on_done(outcome.value)

    def _show_progress(self, progress: dict[str, Any]) -> None:
        self.bar.show_fraction(progress["done"])
        self.message.setText(f"{100 * progress['done']:.0f} %  {progress['doing']}")

    def _end(self, said: str) -> None:
        self.message.setText("")
        self._show_busy(False)
        self.ended.emit(self.results_folder, said)

    def _show_busy(self, on: bool) -> None:
        there = not on and self.scratch_folder is not None and any(self.results_folder.glob("*"))
        self.bar.setVisible(on)
        self.cancel.setVisible(on)
        self.start.setVisible(not on)
        self.save.setVisible(there and self._saved is None)
        self.save.setEnabled(True)
        saved = not on and self._saved is not None
        self.open.setVisible(saved)
        self.open_mesh.setVisible(saved and bool(self.mesh))
        self.busy_changed.emit(on)

    # Saving

    def _ask_where(self) -> None:
        folder = QFileDialog.getExistingDirectory(
            self, tr("Choose a folder to save in"), str(self._memory.last_folder)
        )
        if folder:
            self.save_in(Path(folder))

    def save_in(self, folder: Path) -> None:
        """Save the results as a new subfolder of ``folder``, in the background."""
        results, target = self.results_folder, unused_folder(folder, self._name)

        def work() -> Path:
            with staging_folder(target) as scratch:
                shutil.copytree(results, scratch, dirs_exist_ok=True)
            return target

        self._job = Job(tr("Saving"), work, self._show_saved, self._delivered.emit)
        self.save.setEnabled(False)

    def _show_saved(self, folder: Path) -> None:
        self._saved = folder
        self.message.setText(tr("Saved as {folder}.").format(folder=folder))
        self._show_busy(False)

    def _ask_for_mesh(self) -> None:
        if self._saved is not None:
            self.mesh_requested.emit(self._saved / self.mesh)

    def _open(self) -> None:
        if self._saved is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._saved)))
