"""Results of a study read from its folder, as often as they change.

The folder is looked at and not watched by the system, whose watches do not see other machines.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import NamedTuple

from PySide6.QtCore import QObject, QTimer, Signal

from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.cases.results import ResultTable, read_results
from apd_viewer.errors import InputError
from apd_viewer.ui.studies.result_columns import ResultColumn, shown_columns
from apd_viewer.ui.widgets.background_task import BackgroundTask

_EVERY = 1000  # ms
_TIMES = 20.0  # so many times longer than reading takes is waited before the next


class ReadResults(NamedTuple):
    """Results with their columns, as read at a moment."""

    table: ResultTable
    columns: list[ResultColumn]


class FolderWatch(QObject):
    """Reads results on a thread, at first and after each change.

    Attributes
    ----------
    results_read : Signal(object)
        :class:`ReadResults`.
    failed : Signal(str)
        Why they cannot be read, once.
    folder : Path or None
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
        self._timer = QTimer(self, interval=_EVERY)
        self._timer.timeout.connect(self.check_folder)

    def watch_folder(self, folder: Path) -> None:
        """Read the results of a folder from now on; it need not hold any yet."""
        self.folder, self._seen, self._next, self._said = folder, None, 0.0, ""
        self.set_enabled(self._shown)

    def set_enabled(self, on: bool) -> None:
        """Look at the folder from now on, or leave it alone, as nobody sees it."""
        self._shown = on
        if on and self.folder is not None:
            self._timer.start()
            self.check_folder()
        else:
            self._timer.stop()

    def check_folder(self) -> None:
        """Read the results if they have changed."""
        folder = self.folder
        if folder is None or self._task.busy or time.monotonic() < self._next:
            return
        try:
            found = (folder / DATABASE_NAME).stat()
        except OSError:
            return
        stamp = found.st_mtime_ns, found.st_size
        if stamp != self._seen:
            self._seen = stamp
            self._task.begin(lambda _: _results(folder))

    def _take(self, found: tuple[Path, ReadResults | str, float] | None) -> None:
        if found is None or found[0] != self.folder:
            return
        _, results, took = found
        self._next = time.monotonic() + _TIMES * took
        if isinstance(results, ReadResults):
            self._said = ""
            self.results_read.emit(results)
        else:
            self._seen = None  # try again
            if results != self._said:
                self.failed.emit(results)
            self._said = results

    def close(self) -> None:
        """Read nothing any more."""
        self._timer.stop()
        self.folder = None
        self._task.close()


def _results(folder: Path) -> tuple[Path, ReadResults | str, float]:
    started = time.monotonic()
    try:
        table = read_results(folder)
        found: ReadResults | str = ReadResults(table, shown_columns(table))
    except InputError as error:
        found = str(error)
    return folder, found, time.monotonic() - started
