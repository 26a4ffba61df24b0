"""Commands on files, with questions before unsaved work is lost."""

from collections.abc import Callable, Mapping
from enum import Enum
from functools import partial
from pathlib import Path
from typing import NamedTuple, TypeVar

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.files.known_file import FileState, KnownFile
from apd_viewer.files.mesh_formats import POINT_CACHES
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.status_text import lost_file_text
from apd_viewer.session.model.view import View
from apd_viewer.session.processes.freed_memory import release_freed_memory
from apd_viewer.session.session import Session
from apd_viewer.session.storage.recovery_file import RecoveryFile, find_recovery_files
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.preferences.preferences import Preferences, user_file
from apd_viewer.ui.widgets.display_names import window_title_text

T = TypeVar("T")


class FileController:
    """Opens and writes files for a window.

    Parameters
    ----------
    window : QWidget
        Over which to ask.
    view : callable
        Returns the camera, overlay and unit to be saved with the mesh.
    small_picture : callable
        Returns a small picture of the view as a PNG file, empty if there is none.
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    """

    def __init__(
        self,
        window: QWidget,
        preferences: Preferences,
        session: Session,
        view: Callable[[], View],
        small_picture: Callable[[], bytes],
        recovery: Path | None = None,
    ) -> None:
        self._window = window
        self._memory = preferences
        self._session = session
        self._view, self._picture = view, small_picture
        self._recovery = recovery
        if recovery is not None:
            session.autosave.start(recovery, view)

    def recovery_files(self) -> list[RecoveryFile]:
        """Recoverable sessions of crashed processes, locked for this window."""
        return find_recovery_files(self._recovery) if self._recovery is not None else []

    def restore(self, recovery_file: RecoveryFile) -> None:
        """Open a recovered session in the background; saving asks for a path."""
        self.run_after_save_prompt(lambda: self._session.autosave.restore(recovery_file))

    def open_path(self, path: str | Path) -> None:
        """Open a file in the background; a point cache is applied to the open mesh."""
        if Path(path).suffix.lower() in POINT_CACHES:
            self._session.files.open(path)
        else:
            self.run_after_save_prompt(lambda: self._session.files.open(path))

    def open_sample(self, name: str) -> None:
        """Open a sample in the background."""
        self.run_after_save_prompt(lambda: self._session.files.open_sample(name))

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh passed in memory."""
        self.run_after_save_prompt(lambda: self._session.files.open_mesh(mesh))

    def remesh(self) -> None:
        """Ask for an edge length and a file, and open the mesh with even triangles."""
        if (state := self._session.store.state) is None or not self._session.files.can_remesh():
            return
        mesh, area = state.document.mesh, state.inspection.area
        found = file_dialogs.ask_how_to_remesh(self._window, self._memory.last_folder, mesh, area)
        if found is not None:
            self.run_after_save_prompt(lambda: self._session.files.remesh(*found))

    def export_mesh(self, on_done: Callable[[], object] = lambda: None) -> None:
        """Ask for a path, export the deformed mesh, and call ``on_done()``."""
        if (path := self._answer_to(file_dialogs.ask_where_to_save_mesh)) is not None:
            self._session.files.export(path, on_done)

    def export_scalars(self) -> None:
        """Ask for a file and export the scalars to it."""
        if (found := self._answer_to(file_dialogs.ask_where_to_save_scalars)) is not None:
            self._session.files.export_scalars(*found)

    def export_deck(self) -> None:
        """Ask for a file and export the FE deck to it."""
        if (path := self._answer_to(file_dialogs.ask_where_to_save_deck)) is not None:
            self._session.files.export_deck(path, self._view())

    def _answer_to(self, ask: Callable[[QWidget, Path, Mesh], T | None]) -> T | None:
        """Answer of a dialog; None without one, or if the mesh is another by now."""
        if (state := self._session.store.state) is None:
            return None
        answer = ask(self._window, self._memory.last_folder, state.document.mesh)
        is_meant = answer is not None and self._session.files.is_still_open(state.document.mesh)
        return answer if is_meant else None

    def save(self, on_done: Callable[[], object] = lambda: None) -> None:
        """Save the session to its file; ask for a path if none is set or its folder gone.

        ``on_done()`` follows once it is saved.
        """
        last = self._session.saved_work.last_saved
        if last is None or last.file is None or not last.file.path.parent.is_dir():
            self.save_as(on_done)
        else:
            self._save(last.file.path, last.embeds_mesh, on_done)

    def save_as(self, on_done: Callable[[], object] = lambda: None) -> None:
        """Ask for a path, and save the session with or without the mesh."""
        if (found := self._answer_to(file_dialogs.ask_where_to_save_session)) is not None:
            self._memory.remember_file(found[0])
            self._save(*found, on_done)

    def _save(
        self, path: Path, embeds: bool, then: Callable[[], object], over: KnownFile | None = None
    ) -> None:
        def changed(file: KnownFile) -> None:
            ways = {
                ChangedFileAnswer.OVERWRITE: partial(self._save, path, embeds, then, file),
                ChangedFileAnswer.SAVE_AS: partial(self.save_as, then),
                ChangedFileAnswer.RELOAD: partial(self._session.files.open, path),
            }
            ask_about_changed_file(self._window, path.name, ways)

        self._session.files.save(path, self._view(), embeds, then, self._picture(), changed, over)

    def remember_mesh_files(self, state: State) -> None:
        """Add the files of an opened mesh to the recent files, and release freed memory."""
        for path in (user_file(state.document.mesh), self._session.saved_work.path):
            if path is not None and path.is_file():  # a mesh embedded in a session may have no file
                self._memory.remember_file(path)
        release_freed_memory()  # that of closed meshes may be too fragmented for reuse

    def remember_animation(self, path: Path | None) -> None:
        """Add the file of an animation to the recent ones, before that of its mesh."""
        if path is not None:
            self._memory.remember_file(path)

    def load_selection(self) -> None:
        """Ask for a selection file and load it."""
        if self._session.store.state is None:
            return
        path = file_dialogs.ask_for_selection(self._window, self._memory.last_folder)
        if path is not None:
            self._session.files.load_selection(path)

    def save_selection(self) -> None:
        """Ask for a file and save the selection to it."""
        if (path := self._answer_to(file_dialogs.ask_where_to_save_selection)) is not None:
            self._session.files.save_selection(path)

    # Window title and unsaved work

    def show_title(self) -> None:
        """Show session, mesh and unsaved changes in the window title."""
        state, session = self._session.store.state, self._session.saved_work.path
        if state is None:
            return
        mesh, unsaved = state.document.mesh, self._has_unsaved_work
        opened = self._session.saved_work.last_saved
        name = session.name if session else opened.title if opened else ""
        title = tr("{session}[*] – {mesh} – APD Viewer") if name else tr("{mesh}[*] – APD Viewer")
        self._window.setWindowFilePath(str(session or mesh.path or ""))
        names = {"mesh": window_title_text(mesh.name), "session": window_title_text(name)}
        self._window.setWindowTitle(title.format(**names))
        # setWindowModified notifies the platform even if nothing changed.
        if self._window.isWindowModified() != unsaved:
            self._window.setWindowModified(unsaved)

    @property
    def _has_unsaved_work(self) -> bool:
        """True if the document, its picture or Wall results of its timeline are not saved."""
        work, walls = self._session.saved_work, self._session.files.unsaved_wall_count
        return work.is_unsaved or walls > 0 or not work.is_saved_with(self._view().image)

    def run_after_save_prompt(self, action: Callable[[], object], closes: bool = False) -> None:
        """Call ``action()`` unless the user cancels to keep unsaved work."""
        if self.may_discard_work(action, closes):
            action()

    def may_discard_work(self, action: Callable[[], object], closes: bool = False) -> bool:
        """True if ``action()`` loses no unsaved work, or the user agrees to the loss.

        Otherwise it is done once the user has saved or exported, or never.
        """
        state, work = self._session.store.state, self._session.saved_work
        work.check_file_now()
        if state is None or not self._has_unsaved_work:
            return True
        file, name = work.file, work.path.name if work.path else state.document.mesh.name
        found = FileState.SAME if file is None else file.state
        walls = self._session.files.unsaved_wall_count
        answer = ask_before_leaving(self._window, name, closes, found, walls)
        if answer is UnsavedAnswer.SAVE:
            # Asked again when the file is written: the user may have continued working.
            self.save(partial(self.run_after_save_prompt, action, closes))
        elif answer is UnsavedAnswer.EXPORT:
            self.export_mesh(partial(self._leave_exported, state.document, action, closes))
        return answer is UnsavedAnswer.DISCARD

    def _leave_exported(self, document: Document, action: Callable[[], object], closes: bool) -> None:
        """Call ``action()``, with a question first if the document has changed."""
        is_same = self._session.store.required_state().document is document
        action() if is_same else self.run_after_save_prompt(action, closes)


_LONGEST_NAME = 300  # px
_Role = QMessageBox.ButtonRole


class Question(NamedTuple):
    """Title, text and details of a question.

    Attributes
    ----------
    text : str
        The question, with ``{name}`` where the file is named.
    name : str
        Of the file; a long one is shortened.
    details : str
        Details for the decision, with ``{name}`` likewise.
    """

    title: str
    text: str
    name: str
    details: str


class Answer(Enum):
    """Button text and role; ``Enter`` selects the first answer, ``Esc`` the last."""

    def __init__(self, text: str, role: QMessageBox.ButtonRole) -> None:
        self.text, self.role = text, role


A = TypeVar("A", bound=Answer)


class UnsavedAnswer(Answer):
    """Answer to the question about unsaved work."""

    SAVE = tr("&Save session"), _Role.AcceptRole
    EXPORT = tr("&Export mesh…"), _Role.AcceptRole
    DISCARD = tr("&Don’t save"), _Role.DestructiveRole
    CANCEL = tr("Cancel"), _Role.RejectRole


class ChangedFileAnswer(Answer):
    """Answer to the question about a file changed on disk."""

    SAVE_AS = tr("Save &as…"), _Role.AcceptRole
    OVERWRITE = tr("&Overwrite"), _Role.DestructiveRole
    RELOAD = tr("&Reload"), _Role.ActionRole
    CANCEL = tr("Cancel"), _Role.RejectRole


def ask_question(parent: QWidget, question: Question, answers: type[A]) -> A:
    """Show the question and return the chosen answer."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setWindowTitle(question.title)
    elide = box.fontMetrics().elidedText
    name = elide(question.name, Qt.TextElideMode.ElideMiddle, _LONGEST_NAME)
    box.setText(question.text.format(name=name))
    box.setInformativeText(question.details.format(name=name))
    buttons = [(answer, box.addButton(answer.text, answer.role)) for answer in answers]
    box.setDefaultButton(buttons[0][1])
    box.setEscapeButton(buttons[-1][1])
    box.exec()
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for answer, button in buttons if button is clicked), buttons[-1][0])


def ask_before_leaving(
    parent: QWidget, name: str, closes: bool, fate: FileState = FileState.SAME, unsaved_wall_count: int = 0
) -> UnsavedAnswer:
    """Ask about unsaved work before closing, or before opening another file.

    ``unsaved_wall_count`` is the number of steps with unsaved results of the Wall method.
    """
    text = tr("Save changes to “{name}” before closing?")
    if not closes:
        text = tr("Save changes to “{name}” before opening another file?")
    kept = tr("A session keeps paint, handles, targets, settings and the shape; a mesh only the shape.")
    lost = lost_file_text("{name}", fate)
    walls = tr("Steps at which the wall is solved and not saved yet: {n}.").format(n=unsaved_wall_count)
    details = "\n".join(filter(None, (lost, kept, walls if unsaved_wall_count else "")))
    question = Question(tr("Unsaved changes"), text, name, details)
    return ask_question(parent, question, UnsavedAnswer)


def ask_about_changed_file(
    parent: QWidget, name: str, actions: Mapping[ChangedFileAnswer, Callable[[], object]]
) -> None:
    """Ask about a changed file in the next event, and run the chosen action.

    Asked in the next event, since the caller may not have finished. ``Enter`` loses nothing.
    """
    text = tr("“{name}” has been changed by another window or program. Overwrite it?")
    about = tr(
        "Overwrite discards the contents of the file. Reload opens the file instead and discards this "
        "window’s changes; Undo brings them back."
    )
    question = Question(tr("File changed"), text, name, about)

    def ask() -> None:
        actions.get(ask_question(parent, question, ChangedFileAnswer), lambda: None)()

    QTimer.singleShot(0, parent, ask)
