"""Dialog that exports a motion of the handles as an animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from apd_viewer.cases.case import MOST_STEPS, case_of
from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import check_animation
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.filing.file_dialogs import ask_where_to_save
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_bar import RunBar
from apd_viewer.ui.studies.run_dialog import RunDialog, count_field, widget_row
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import ComboBox

_STEPS = 24


class AnimationDialog(RunDialog):
    """Solves a motion in steps by the method of the session, and writes the shapes.

    Parameters
    ----------
    window : QWidget
    state : State
    motions : sequence of (str, Document)
        What can be exported, with its title; at least one.
    view : View
        How a film looks at the mesh.
    preferences : Preferences
    """

    def __init__(
        self,
        window: QWidget,
        state: State,
        motions: Sequence[tuple[str, Document]],
        view: View,
        preferences: Preferences,
    ) -> None:
        mesh = state.document.mesh
        run = RunBar(tr("Export…"), f"{mesh.stem}-animation", preferences)
        title = tr("Export animation – {name}").format(name=window_title_text(mesh.name))
        super().__init__(window, title, run, "sweep.png", tr("Curves of area, volume and energy"))
        self._state, self._view, self._memory = state, view, preferences
        self._path: Path | None = None
        self._before: tuple[int, int] | None = None
        run.start_requested.connect(self.begin)
        run.ended.connect(self._tell)
        about = tr("Solves the motion in steps, and writes the shapes for other programs.")
        rows = (
            (tr("Motion"), self._make_motion(motions)),
            (tr("Steps"), self._make_steps()),
            (tr("Format"), self._make_format()),
        )
        self.lay_out(about, rows)

    def _make_motion(self, motions: Sequence[tuple[str, Document]]) -> QHBoxLayout:
        self.motion = ComboBox()
        self.motion.setAccessibleName(tr("Motion to export"))
        for title, document in motions:
            self.motion.addItem(title, document)
        return widget_row(self.motion)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = count_field(tr("Number of steps"), 1, MOST_STEPS, _STEPS)
        return widget_row(self.steps, QLabel(tr("shapes after the first")), spacing=8)

    def _make_format(self) -> QHBoxLayout:
        self.format = format_choice(".glb")
        return widget_row(self.format)

    def begin(self) -> None:
        """Ask for the file, and start."""
        document, steps = self.motion.currentData(), round(self.steps.value())
        try:
            case_of(document, steps)
            path = self._ask()
        except InputError as error:
            self.run.show_failure(str(error))
            return
        if path is None:
            return
        self._path, self._before = path, _stamp(path)

        def prepared(scratch: Path, results: Path) -> list[str]:
            session = scratch / "animation.apd"
            save_session(session, self._state.updated(document), self._view)
            words = ["--steps", str(steps), "--methods", document.settings.method, "--animation", str(path)]
            return ["sweep", str(session), *words, "-o", str(results)]

        self.run.begin(prepared, other_folder=path.parent)

    def _ask(self) -> Path | None:
        """File to write to; None if cancelled; raises InputError."""
        name = f"{self._state.document.mesh.stem}-animation{self.format.currentData()}"
        path = ask_where_to_save(self, tr("Export animation"), self._memory.last_folder / name)
        if path is not None:
            check_animation(path)
        return path

    def _tell(self) -> None:
        # A film that could not be drawn leaves what was there; the summary says why.
        if self._path is not None and _stamp(self._path) != self._before:
            self.run.words.setText(tr("Exported {name}.").format(name=self._path.name))


def _stamp(path: Path) -> tuple[int, int] | None:
    """Mark of a file that one replacing it does not have; None without a file."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ino


ANIMATION_FORMATS: Mapping[str, str] = {
    ".glb": tr("glTF with morph targets (GLB)"),
    ".pc2": tr("Blender point cache (PC2)"),
    ".mdd": tr("Blender point cache (MDD)"),
    ".pvd": tr("ParaView series (PVD)"),
    ".gif": tr("film (GIF)"),
}


def format_choice(first: str) -> ComboBox:
    """Choice of a format by its ending; ``first`` is chosen to begin with."""
    choice = ComboBox()
    choice.setAccessibleName(tr("Format of the animation"))
    for ending, title in ANIMATION_FORMATS.items():
        choice.addItem(title, ending)
    choice.setCurrentIndex(choice.findData(first))
    return choice
