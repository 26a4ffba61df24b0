"""Requests to open a file, kept until a session can open it."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QFileOpenEvent
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.preferences.preferences import Preferences


class Opener(Protocol):
    """Protocol for opening meshes in the background."""

    def open_path(self, path: str | Path) -> None:
        """Open a file."""

    def open_sample(self, name: str) -> None:
        """Open a sample."""

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh that is already in memory."""


class FileRequests:
    """Forwards requests to an opener; before it is set, keeps the latest request.

    Parameters
    ----------
    window : QWidget
        Parent of the file dialog.
    """

    def __init__(self, window: QWidget, preferences: Preferences) -> None:
        self._window, self._memory = window, preferences
        self._opener: Opener | None = None
        self._waiting: Callable[[Opener], None] | None = None

    def ask_for_file(self) -> None:
        """Ask for a file to open."""
        path = file_dialogs.ask_for_mesh(self._window, self._memory.last_folder)
        if path is not None:
            self.open_path(path)

    def open_path(self, path: str | Path) -> None:
        """Open a file."""
        self._request(lambda opener: opener.open_path(path))

    def open_sample(self, name: str) -> None:
        """Open a sample."""
        self._request(lambda opener: opener.open_sample(name))

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh that is already in memory."""
        self._request(lambda opener: opener.show_mesh(mesh))

    def set_opener(self, opener: Opener) -> None:
        """Set the opener for the waiting request and all later ones."""
        self._opener = opener
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            waiting(opener)

    def _request(self, request: Callable[[Opener], None]) -> None:
        if self._opener is None:
            self._waiting = request
        else:
            request(self._opener)


class FileOpenEvents(QObject):
    """Event filter for files opened from the macOS Finder or Dock.

    macOS sends them as events instead of arguments. Used on macOS only: a Python filter of all events slows
    every gesture.
    """

    def __init__(self, application: QApplication, requests: FileRequests) -> None:
        super().__init__(application)
        self._requests = requests
        application.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Open the file of a QFileOpenEvent; pass on all other events."""
        if isinstance(event, QFileOpenEvent) and event.file():
            self._requests.open_path(event.file())
            return True
        return super().eventFilter(watched, event)
