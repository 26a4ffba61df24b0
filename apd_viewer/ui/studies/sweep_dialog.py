"""Dialogs to sweep the motion of the handles, for curves or an animation."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QWidget

from apd_viewer.cases.case import DEFAULT_ITERATIONS, MOST_STEPS, Case, case_of, cases_by_method
from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import check_animation
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.filing.file_dialogs import ask_where_to_save
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_dialog import RunBar, RunDialog, count_field
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, TextField

_POSED, _TWIST = "posed", "twist"
ANIMATION_FORMATS: Mapping[str, str] = {
    ".glb": tr("glTF with morph targets (GLB)"),
    ".pc2": tr("Blender point cache (PC2)"),
    ".mdd": tr("Blender point cache (MDD)"),
    ".usdc": tr("USD with time samples (USDC)"),
    ".pvd": tr("ParaView series (PVD)"),
    ".gif": tr("film (GIF)"),
}


class SweepDialog(RunDialog):
    """Dialog to sweep the motion of the document open when the dialog is created.

    Parameters
    ----------
    handle : int
        Index of the handle turned by a twist.
    view : View
        View of the mesh in an animation.

    Attributes
    ----------
    play_requested : Signal(Case)
        Emitted to solve the motion in the window, with the shape of each step on the timeline.
    """

    play_requested = Signal(object)

    def __init__(
        self, window: QWidget, state: State, handle: int, view: View, preferences: Preferences
    ) -> None:
        mesh = state.document.mesh
        run = RunBar(tr("Sweep"), f"{mesh.stem}-sweep", preferences)
        title = tr("Sweep – {name}").format(name=window_title_text(mesh.name))
        super().__init__(window, title, run, "sweep.png", tr("Curves of area, volume and energy"))
        run.start_requested.connect(self.begin)
        tip = tr("Solve the motion in the window by the method of the panel, each step on the timeline")
        self.in_view = QPushButton(tr("In the view"), toolTip=tip)
        self.in_view.clicked.connect(self.play)
        run.add_button(self.in_view)
        self._state, self._handle, self._view = state, handle, view
        about = tr("Runs the motion in steps, and plots area, volume and energy.")
        rows = (
            (tr("Motion"), self._make_motion()),
            (tr("Steps"), self._make_steps()),
            (tr("Methods"), self._make_methods()),
            (tr("Also export"), self._make_extras()),
        )
        self.lay_out(about, rows)

    def _make_motion(self) -> QHBoxLayout:
        document = self._state.document
        name = document.handles[self._handle].name
        self.motion = ComboBox(accessibleName=tr("Motion to sweep"))
        pushed = self._is_pushed
        if document.relative_to_rest.is_posed or pushed:
            words = tr("current motion of the handles and obstacles")
            self.motion.addItem(words if pushed else tr("current motion of the handles"), _POSED)
        self.motion.setMinimumWidth(260)
        if not pushed or document.label_counts[HANDLE + self._handle]:
            self.motion.addItem(tr("twist of “{name}” by").format(name=name), _TWIST)
        self.twist = TextField(accessibleName=tr("Angle of the twist"), maximumWidth=100)
        self.twist.setText("180deg")
        self.twist.show_unit("°")
        self.motion.currentIndexChanged.connect(self._show_motion)
        self._show_motion()
        return row_layout(self.motion, self.twist, STRETCH)

    @property
    def _is_pushed(self) -> bool:
        """True if moved obstacles push the mesh by contact."""
        return self._state.is_contact_active and any(
            each.shift.any() for each in self._state.document.obstacles
        )

    def _show_motion(self) -> None:
        self.twist.setVisible(self.motion.currentData() == _TWIST)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = count_field(tr("Number of steps"), 1, MOST_STEPS, 20)
        self.to = count_field(tr("End of the motion"), 1, 1000, 100, " %")
        self.iterations = count_field(tr("Iterations per step"), 1, 100_000, DEFAULT_ITERATIONS)
        words = tr("end at"), tr("of the motion, with at most"), tr("iterations each")
        first, second, third = map(QLabel, words)
        return row_layout(self.steps, first, self.to, second, self.iterations, third, STRETCH)

    def _make_methods(self) -> QHBoxLayout:
        own = self._state.document.settings.method
        names = filter(COMPARED_METHODS.__contains__, METHODS)  # in the order of the panel
        self.methods = {name: CheckBox(METHODS[name].short_title) for name in names}
        for name, check in self.methods.items():
            slow = METHODS[name].is_slow
            may = METHODS[name].may_use_contact or not self._is_pushed
            check.setEnabled(may)
            check.setChecked(may and (not slow or own == name))
            check.setToolTip(tr("Takes several times as long as the others") if slow else "")
        return row_layout(*self.methods.values(), STRETCH, spacing=16)

    def _make_extras(self) -> QHBoxLayout:
        self.meshes = CheckBox(tr("the mesh of each step"))
        self.animation, self.format = CheckBox(tr("an animation:")), format_choice(".gif")
        self.format.setEnabled(False)
        self.animation.toggled.connect(self.format.setEnabled)
        return row_layout(self.meshes, self.animation, self.format, STRETCH, spacing=16)

    def _case(self) -> Case:
        """Case of the motion and steps chosen; raises InputError."""
        document = self._state.document
        motion: tuple[MotionStep, ...] = ()
        if self.motion.currentData() == _TWIST:
            typed = f"handle {self._handle + 1}: twist {self.twist.text()}"
            motion = motion_steps(document, typed, Unit.NONE)
        return case_of(document, round(self.steps.value()), self.to.value() / 100.0, motion=motion)

    def play(self) -> None:
        """Request the motion in the main window, and close the dialog."""
        try:
            case = self._case()
        except InputError as error:
            self.run.show_failure(str(error))
            return
        self.close()
        self.play_requested.emit(case)

    def begin(self) -> None:
        """Start the sweep with the options chosen."""
        methods = [name for name, check in self.methods.items() if check.isChecked()]
        try:
            cases_by_method(self._case(), methods)
        except InputError as error:
            self.run.show_failure(str(error))
            return
        words: list[str] = []
        if self.motion.currentData() == _TWIST:
            words = ["--handle", str(self._handle + 1), f"--twist={self.twist.text()}"]
        steps, last_fraction = round(self.steps.value()), self.to.value() / 100.0
        words += ["--steps", str(steps), "--to", repr(last_fraction)]
        words += ["--methods", ",".join(methods), "--iterations", str(round(self.iterations.value()))]
        words += ["--meshes"] if self.meshes.isChecked() else []
        animation = Path(f"sweep{self.format.currentData()}") if self.animation.isChecked() else None
        self.run.begin(partial(_sweep_arguments, self._state, self._view, words, animation))


class AnimationDialog(RunDialog):
    """Dialog to solve a motion in steps and export the shapes as an animation.

    Parameters
    ----------
    motions : sequence of (str, Document)
        Motions available for export, with their titles; at least one.
    view : View
        View of the mesh in a film.
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
        run.ended.connect(self._report_export)
        about = tr("Solves the motion in steps, and writes the shapes for other programs.")
        rows = (
            (tr("Motion"), self._make_motion(motions)),
            (tr("Steps"), self._make_steps()),
            (tr("Format"), self._make_format()),
        )
        self.lay_out(about, rows)

    def _make_motion(self, motions: Sequence[tuple[str, Document]]) -> QHBoxLayout:
        self.motion = ComboBox(accessibleName=tr("Motion to export"))
        for title, document in motions:
            self.motion.addItem(title, document)
        return row_layout(self.motion, STRETCH, spacing=16)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = count_field(tr("Number of steps"), 1, MOST_STEPS, 24)
        return row_layout(self.steps, QLabel(tr("shapes after the first")), STRETCH)

    def _make_format(self) -> QHBoxLayout:
        self.format = format_choice(".glb")
        return row_layout(self.format, STRETCH, spacing=16)

    def begin(self) -> None:
        """Ask for the file, and start."""
        document, steps = self.motion.currentData(), round(self.steps.value())
        try:
            case_of(document, steps)
            path = self._ask_path()
        except InputError as error:
            self.run.show_failure(str(error))
            return
        if path is None:
            return
        self._path, self._before = path, _file_identity(path)
        words = ["--steps", str(steps), "--methods", document.settings.method]
        state = self._state.updated(document)
        self.run.begin(partial(_sweep_arguments, state, self._view, words, path), other_folder=path.parent)

    def _ask_path(self) -> Path | None:
        """Ask for the path of the animation; None if cancelled; raises InputError."""
        name = f"{self._state.document.mesh.stem}-animation{self.format.currentData()}"
        path = ask_where_to_save(self, tr("Export animation"), self._memory.last_folder / name)
        if path is not None:
            check_animation(path)
        return path

    def _report_export(self) -> None:
        # A failed export leaves an existing file unchanged; the summary gives the reason.
        if self._path is not None and _file_identity(self._path) != self._before:
            self.run.message.setText(tr("Exported {name}.").format(name=self._path.name))


def _sweep_arguments(
    state: State, view: View, words: Sequence[str], animation: Path | None, scratch: Path, results: Path
) -> list[str]:
    """Command arguments for a sweep of the session saved in ``scratch``."""
    session = scratch / "sweep.apd"
    save_session(session, state, view)
    animated = [] if animation is None else ["--animation", str(results / animation)]
    return ["sweep", str(session), *words, *animated, "-o", str(results)]


def _file_identity(path: Path) -> tuple[int, int] | None:
    """Modification time and inode of a file, to detect a replacement; None if missing."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ino


def format_choice(first: str) -> ComboBox:
    """Combo box of animation formats by suffix, with ``first`` selected."""
    choice = ComboBox(accessibleName=tr("Format of the animation"))
    for ending, title in ANIMATION_FORMATS.items():
        choice.addItem(title, ending)
    choice.setCurrentIndex(choice.findData(first))
    return choice
