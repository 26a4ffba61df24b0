"""Controller of the dialogs for sweeps, animations, presses, tables and cases."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from itertools import chain
from pathlib import Path
from weakref import WeakKeyDictionary

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QDialog, QWidget

from apd_viewer.cases.case import Case
from apd_viewer.files.html_page import PageBlock, PageNote, PagePicture, PagePictureRow
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, rest_frame
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.initial_positions import gesture_motion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.session import Session
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.paper_dialog import PaperDialog
from apd_viewer.ui.studies.press_dialog import PressDialog
from apd_viewer.ui.studies.run_dialog import RunDialog
from apd_viewer.ui.studies.sweep_dialog import AnimationDialog, SweepDialog
from apd_viewer.ui.studies.verification_dialog import VerificationDialog


class RunController(QObject):
    """Opens the dialogs to run commands, one of each kind at most.

    Parameters
    ----------
    session : Session
        Session with the gesture to export.
    files : FileController
        Asks about unsaved work before another mesh is opened.
    open_document : callable
        Function giving the open state, the active handle and the view; None without a mesh.
    show_failure : callable
        Says a sentence.

    Attributes
    ----------
    wall_requested : Signal()
        The fields of the wall are to be shown.
    motion_played : Signal()
        A motion has begun whose steps come onto the timeline.
    """

    wall_requested = Signal()
    motion_played = Signal()

    def __init__(
        self,
        window: QWidget,
        preferences: Preferences,
        session: Session,
        files: FileController,
        open_document: Callable[[], tuple[State, int, View] | None],
        show_failure: Callable[[str], object],
    ) -> None:
        super().__init__(window)
        self._window, self._memory = window, preferences
        self._session, self._filing = session, files
        self._opened, self._failed = open_document, show_failure
        self.dialogs: dict[str, QDialog] = {}
        self._made_for: dict[str, Document | None] = {}
        # Last results of each mesh, by the kind of run.
        self._pressed = WeakKeyDictionary[Mesh, dict[str, tuple[PageBlock, ...]]]()

    def open_sweep(self) -> None:
        """Open the dialog to sweep the current motion of the handles."""
        found = self._opened()
        if found is None:
            return
        state, handle, view = found
        if state.document.paint_problem:
            self._failed(state.document.paint_problem)
            return
        self._show("sweep", lambda: self._sweep_dialog(state, handle, view), state.document)

    def _sweep_dialog(self, state: State, handle: int, view: View) -> SweepDialog:
        dialog = SweepDialog(self._window, state, handle, view, self._memory)
        dialog.play_requested.connect(self._play)
        return dialog

    def _play(self, case: Case) -> None:
        """Play the motion of a case from rest, with each step on the timeline."""
        state = self._session.store.required_state()
        if state.document.mesh is not case.document.mesh:
            self._failed(tr("Another mesh has been opened; open the dialog again."))
            return
        start, *documents = (case.document_along_paths(fraction) for fraction in case.fractions)
        at_rest = state.updated(start, rest_frame(start.mesh, state.inspection))
        self._session.player.play(tr("Motion in steps"), documents, at_rest)
        self.motion_played.emit()

    def open_animation(self) -> None:
        """Open the dialog to export the current motion or the last gesture."""
        found = self._opened()
        if found is None:
            return
        state, _, view = found
        motions = self._motions(state)
        if state.document.paint_problem or not motions:
            words = tr("No handle has moved, so there is no motion to export; move a handle first.")
            self._failed(state.document.paint_problem or words)
            return
        self._show(
            "animate",
            lambda: AnimationDialog(self._window, state, motions, view, self._memory),
            state.document,
        )

    def _motions(self, state: State) -> list[tuple[str, Document]]:
        """Motions that can be exported, with their titles."""
        document, found = state.document, []
        latest = self._session.gestures.history.last_entry
        if document.relative_to_rest.is_posed:
            found.append((tr("current motion of the handles"), document))
        gesture = gesture_motion(latest.state, document) if latest is not None else None
        if latest is not None and gesture is not None:
            found.append((tr("last step: “{gesture}”").format(gesture=latest.gesture), gesture))
        return found

    def open_press(self) -> None:
        """Open the dialog to press the mesh between two plates; no paint is needed."""
        found = self._opened()
        if found is not None:
            state, _, view = found
            self._show("press", lambda: self._press_dialog(state, view), state.document)

    def _press_dialog(self, state: State, view: View) -> PressDialog:
        dialog = PressDialog(self._window, state, view, self._memory)
        unit = Unit(view.unit)
        leave_for, show = self._filing.run_after_save_prompt, self._show_pressed
        dialog.run.mesh_requested.connect(lambda path: leave_for(partial(show, path, unit)))
        dialog.wall_requested.connect(self.wall_requested)
        dialog.run.ended.connect(lambda folder, _: self._keep_pressed(dialog, state.document.mesh, folder))
        return dialog

    def _keep_pressed(self, dialog: PressDialog, mesh: Mesh, folder: Path) -> None:
        with suppress(OSError):
            picture = PagePicture(read_bytes(folder / "press.png"), dialog.figure_caption)
            notes = map(PageNote, dialog.summary.text().splitlines())
            self._pressed.setdefault(mesh, {})[dialog.figure_caption] = (PagePictureRow((picture,)), *notes)

    def pressed_blocks(self, mesh: Mesh) -> tuple[PageBlock, ...]:
        """Blocks of a report on what the press dialog last found of a mesh."""
        return tuple(chain.from_iterable(self._pressed.get(mesh, {}).values()))

    def show_wall(self, wall: WallText) -> None:
        """Show another wall in an open dialog that presses."""
        dialog = self.dialogs.get("press")
        if isinstance(dialog, PressDialog):
            dialog.show_wall(wall)

    def _show_pressed(self, path: Path, unit: Unit) -> None:
        """Close the press dialog, and open the pressed mesh in the window."""
        if (dialog := self.dialogs.get("press")) is not None:
            dialog.close()
        if unit is not Unit.NONE and not unit.is_guess:
            self._memory.remember_unit(path, unit)
        self._session.files.open(path)

    def open_paper(self) -> None:
        """Open the dialog to recompute the paper's tables."""
        self._show("paper", lambda: PaperDialog(self._window, self._memory))

    def open_verification(self) -> None:
        """Open the dialog to run the verification cases."""
        self._show("verify", lambda: VerificationDialog(self._window, self._memory))

    def close_all(self) -> None:
        """Close the dialogs, and end their runs."""
        for dialog in list(self.dialogs.values()):
            dialog.close()

    def _show(self, name: str, make: Callable[[], QDialog], document: Document | None = None) -> None:
        """Raise a dialog, made anew if it is of an earlier document and holds no work."""
        dialog = self.dialogs.get(name)
        is_idle = isinstance(dialog, RunDialog) and not dialog.run.has_unsaved_results
        if dialog is not None and is_idle and self._made_for[name] is not document:
            dialog.close()
        dialog = self.dialogs.get(name) or self._made(name, make, document)
        dialog.show()
        dialog.raise_()
        dialog.activateWindow()

    def _made(self, name: str, make: Callable[[], QDialog], document: Document | None) -> QDialog:
        dialog = self.dialogs[name] = make()
        self._made_for[name] = document

        def forget() -> None:
            if self.dialogs.get(name) is dialog:  # another may be open once this one is deleted
                del self.dialogs[name]

        dialog.destroyed.connect(forget)
        dialog.finished.connect(forget)
        return dialog
