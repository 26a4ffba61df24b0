"""Commands on files, with their questions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.session.model.view import SUFFIX
from apd_viewer.session.storage.recovery import Leftover, leftovers
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.preferences.preferences import Preferences, own_file

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View
    from apd_viewer.session.session import Session


class Filing:
    """Opens and writes for a window.

    Parameters
    ----------
    window : QWidget
        Over which to ask.
    memory : Preferences
    session : Session
    view : callable
        Returns the camera, overlay and unit to be saved with the mesh.
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    """

    def __init__(
        self,
        window: QWidget,
        memory: Preferences,
        session: Session,
        view: Callable[[], View],
        recovery: Path | None = None,
    ) -> None:
        self._window = window
        self._memory = memory
        self._session = session
        self._view = view
        self._recovery = recovery
        self._asked: Path | None = None
        self._path: Path | None = None  # of the session file
        self._embeds = False
        if recovery is not None:
            session.autosave.keep_in(recovery, view)

    def leftovers(self) -> list[Leftover]:
        """Recoverable sessions of killed programs, locked for this window."""
        return leftovers(self._recovery) if self._recovery is not None else []

    def restore(self, left: Leftover) -> None:
        """Open a recovered session in the background; its file is not for saving."""
        self._asked = None
        self._session.autosave.restore(left)

    def open_path(self, path: str | Path) -> None:
        """Open a file in the background."""
        if self._session.jobs.current is None:  # unless it is refused
            self._asked = Path(path)
        self._session.files.open(path)

    def open_sample(self, name: str) -> None:
        """Open a sample in the background."""
        self._session.files.open_sample(name)

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh from memory."""
        self._session.files.open_mesh(mesh)

    def ask_for_target(self) -> None:
        """Choose a target for the deformed mesh."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_for_target(self._window, self._memory.folder, state.document.mesh)
        if path is not None:
            self._session.files.export(path)

    def save(self) -> None:
        """Save the session to its file; ask for one if there is none."""
        if self._path is None:
            self.save_as()
        elif self._session.store.state is not None:
            self._session.files.save(self._path, self._view(), self._embeds)

    def save_as(self) -> None:
        """Choose a target for the session, with or without the mesh."""
        if (state := self._session.store.state) is None:
            return
        mesh = state.document.mesh
        found = file_dialogs.ask_for_session(self._window, self._memory.folder, mesh)
        if found is not None:
            self._path, self._embeds = found
            self._memory.remember(self._path)
            self.save()

    def opened(self, state: State) -> None:
        """Note another mesh: the next save is of another session."""
        self._path, self._embeds = None, False
        if path := own_file(state.document.mesh):
            self._memory.remember(path)

    def viewed(self) -> None:
        """Note the session's file as the target of the next save."""
        if self._asked is not None and self._asked.suffix.lower() == SUFFIX:
            self._path = self._asked
            self._memory.remember(self._asked)

    def load_selection(self) -> None:
        """Choose a selection file to load."""
        if self._session.store.state is None:
            return
        path = file_dialogs.ask_for_selection(self._window, self._memory.folder)
        if path is not None:
            self._session.files.load_selection(path)

    def save_selection(self) -> None:
        """Choose a target for the selection."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_where_to_put_selection(self._window, self._memory.folder, state.document.mesh)
        if path is not None:
            self._session.files.save_selection(path)

    def may_close(self) -> bool:
        """True if nothing is lost by closing, or the user agrees."""
        if not self.worth_asking:
            return True
        answer = file_dialogs.ask_before_losing(self._window)
        if answer == QMessageBox.StandardButton.Save:
            self.ask_for_target()  # but keep the window open: the user can close it once the file is written
        return answer == QMessageBox.StandardButton.Discard

    @property
    def worth_asking(self) -> bool:
        """True if a shape would be lost; samples do not count."""
        return any(mesh.path is None or own_file(mesh) is not None for mesh in self._session.files.unsaved)
