"""Commands on files, with their questions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QWidget

from apd_viewer.files.known_file import Fate, KnownFile
from apd_viewer.language import tr
from apd_viewer.session.jobs.freed_memory import give_back_freed_memory
from apd_viewer.session.storage.recovery import Leftover, leftovers
from apd_viewer.ui.filing import file_dialogs, unsaved_question
from apd_viewer.ui.filing.changed_file_question import Decision, ask_soon
from apd_viewer.ui.filing.unsaved_question import Answer
from apd_viewer.ui.preferences.preferences import Preferences, own_file
from apd_viewer.ui.widgets.names import in_title

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
    picture : callable
        Returns a small picture of the view as a PNG file, empty if there is none.
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    """

    def __init__(
        self,
        window: QWidget,
        memory: Preferences,
        session: Session,
        view: Callable[[], View],
        picture: Callable[[], bytes],
        recovery: Path | None = None,
    ) -> None:
        self._window = window
        self._memory = memory
        self._session = session
        self._view, self._picture = view, picture
        self._recovery = recovery
        if recovery is not None:
            session.autosave.keep_in(recovery, view)

    def leftovers(self) -> list[Leftover]:
        """Recoverable sessions of killed programs, locked for this window."""
        return leftovers(self._recovery) if self._recovery is not None else []

    def restore(self, left: Leftover) -> None:
        """Open a recovered session in the background; its file is not for saving."""
        self.leave_for(lambda: self._session.autosave.restore(left))

    def open_path(self, path: str | Path) -> None:
        """Open a file in the background."""
        self.leave_for(lambda: self._session.files.open(path))

    def open_sample(self, name: str) -> None:
        """Open a sample in the background."""
        self.leave_for(lambda: self._session.files.open_sample(name))

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh from memory."""
        self.leave_for(lambda: self._session.files.open_mesh(mesh))

    def ask_for_target(self, then: Callable[[], object] = lambda: None) -> None:
        """Choose a target for the deformed mesh; ``then()`` follows once it is written."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_for_target(self._window, self._memory.folder, state.document.mesh)
        if path is not None:
            self._session.files.export(path, then)

    def ask_for_scalars(self) -> None:
        """Choose a target for the scalars."""
        if (state := self._session.store.state) is None:
            return
        found = file_dialogs.ask_for_scalars(self._window, self._memory.folder, state.document.mesh)
        if found is not None:
            self._session.files.export_scalars(*found)

    def ask_for_deck(self) -> None:
        """Choose a target for the FE deck."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_where_to_put_deck(self._window, self._memory.folder, state.document.mesh)
        if path is not None:
            self._session.files.export_deck(path, self._view())

    def save(self, then: Callable[[], object] = lambda: None) -> None:
        """Save the session to its file; ask for one if there is none or no folder.

        ``then()`` follows once it is saved.
        """
        last = self._session.saved_work.last
        if last is None or last.file is None or not last.file.path.parent.is_dir():
            self.save_as(then)
        else:
            self._save(last.file.path, last.embeds, then)

    def save_as(self, then: Callable[[], object] = lambda: None) -> None:
        """Choose a target for the session, with or without the mesh."""
        if (state := self._session.store.state) is None:
            return
        mesh = state.document.mesh
        found = file_dialogs.ask_for_session(self._window, self._memory.folder, mesh)
        if found is not None:
            self._memory.remember(found[0])
            self._save(*found, then)

    def _save(
        self, path: Path, embeds: bool, then: Callable[[], object], over: KnownFile | None = None
    ) -> None:
        def changed(file: KnownFile) -> None:
            ways = {
                Decision.OVERWRITE: partial(self._save, path, embeds, then, file),
                Decision.SAVE_AS: partial(self.save_as, then),
                Decision.RELOAD: partial(self._session.files.open, path),
            }
            ask_soon(self._window, path.name, ways)

        self._session.files.save(path, self._view(), embeds, then, self._picture(), changed, over)

    def opened(self, state: State) -> None:
        """Add the files of another mesh to the recent ones, and make room."""
        for path in (own_file(state.document.mesh), self._session.saved_work.path):
            if path is not None and path.is_file():  # a mesh out of a session may have none
                self._memory.remember(path)
        give_back_freed_memory()  # of the meshes before, whose sizes may never be needed again

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

    # Unsaved work

    def show_title(self) -> None:
        """Name session and mesh in the title of the window, and mark unsaved work."""
        state, session = self._session.store.state, self._session.saved_work.path
        if state is None:
            return
        mesh, unsaved = state.document.mesh, self._session.saved_work.unsaved
        title = tr("{session}[*] – {mesh} – APD Viewer") if session else tr("{mesh}[*] – APD Viewer")
        self._window.setWindowFilePath(str(session or mesh.path or ""))
        names = {"mesh": in_title(mesh.name), "session": in_title(session.name if session else "")}
        self._window.setWindowTitle(title.format(**names))
        if self._window.isWindowModified() != unsaved:  # Qt tells the screen again what it knows
            self._window.setWindowModified(unsaved)

    def leave_for(self, go: Callable[[], object], closes: bool = False) -> None:
        """Do ``go()`` unless unsaved work is to stay; if it is to be saved, afterwards."""
        if self.may_leave(go, closes):
            go()

    def may_leave(self, go: Callable[[], object], closes: bool = False) -> bool:
        """True if nothing unsaved is lost by ``go()``, or the user agrees.

        Otherwise it is done once the user has saved or exported, or never.
        """
        state, work = self._session.store.state, self._session.saved_work
        work.look_now()
        if state is None or not work.unsaved:
            return True
        file, name = work.file, work.path.name if work.path else state.document.mesh.name
        found = Fate.SAME if file is None else file.found
        answer = unsaved_question.ask_before_leaving(self._window, name, closes, found)
        if answer is Answer.SAVE:
            self.save(partial(self.leave_for, go, closes))  # the work may go on while it is written
        elif answer is Answer.EXPORT:
            self.ask_for_target(go)
        return answer is Answer.DISCARD
