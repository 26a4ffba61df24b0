"""Files opened by macOS with the program."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QFileOpenEvent
from PySide6.QtWidgets import QApplication

from apd_viewer.ui.filing.file_requests import FileRequests


class FileOpenEvents(QObject):
    """Opener of files from the Finder and the Dock, by their events.

    They come as events and not as arguments. Of macOS only: a filter in Python of all events costs time in
    every gesture.

    Parameters
    ----------
    application : QApplication
    requests : FileRequests
    """

    def __init__(self, application: QApplication, requests: FileRequests) -> None:
        super().__init__(application)
        self._requests = requests
        application.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Open the file of such an event, and let all others pass."""
        if isinstance(event, QFileOpenEvent) and event.file():
            self._requests.open_path(event.file())
            return True
        return super().eventFilter(watched, event)
