"""Dialog that sweeps the motion of the handles, and shows the curves."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QWidget

from apd_viewer.cases.case import DEFAULT_ITERATIONS, MOST_STEPS, case_of, cases_by_method
from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.animation_dialog import format_choice
from apd_viewer.ui.studies.run_bar import RunBar
from apd_viewer.ui.studies.run_dialog import RunDialog, count_field, widget_row
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox

_POSED, _TWIST = "posed", "twist"


class SweepDialog(RunDialog):
    """Sweeps the session as it was when the dialog opened.

    Parameters
    ----------
    window : QWidget
    state : State
    handle : int
        Which a twist turns.
    view : View
        How an animation looks at the mesh.
    preferences : Preferences
    """

    def __init__(
        self, window: QWidget, state: State, handle: int, view: View, preferences: Preferences
    ) -> None:
        mesh = state.document.mesh
        run = RunBar(tr("Sweep"), f"{mesh.stem}-sweep", preferences)
        title = tr("Sweep – {name}").format(name=window_title_text(mesh.name))
        super().__init__(window, title, run, "sweep.png", tr("Curves of area, volume and energy"))
        run.start_requested.connect(self.begin)
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
        self.motion = ComboBox()
        self.motion.setAccessibleName(tr("Motion to sweep"))
        pushed = self._pushed
        if document.relative_to_rest.is_posed or pushed:
            words = tr("current motion of the handles and obstacles")
            self.motion.addItem(words if pushed else tr("current motion of the handles"), _POSED)
        self.motion.setMinimumWidth(260)
        if not pushed or document.label_counts[HANDLE + self._handle]:
            self.motion.addItem(tr("twist of “{name}” by").format(name=name), _TWIST)
        self.twist = QLineEdit("180deg", objectName="typed", maximumWidth=100)
        self.twist.setAccessibleName(tr("Angle of the twist"))
        self.motion.currentIndexChanged.connect(self._show_motion)
        self._show_motion()
        return widget_row(self.motion, self.twist, spacing=8)

    @property
    def _pushed(self) -> bool:
        """True if obstacles were moved that push."""
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
        return widget_row(self.steps, first, self.to, second, self.iterations, third, spacing=8)

    def _make_methods(self) -> QHBoxLayout:
        own = self._state.document.settings.method
        self.methods = {name: CheckBox(METHODS[name].short_title) for name in COMPARED_METHODS}
        for name, check in self.methods.items():
            slow = METHODS[name].is_slow
            may = METHODS[name].may_use_contact or not self._pushed
            check.setEnabled(may)
            check.setChecked(may and (not slow or own == name))
            check.setToolTip(tr("Takes several times as long as the others") if slow else "")
        return widget_row(*self.methods.values())

    def _make_extras(self) -> QHBoxLayout:
        self.meshes = CheckBox(tr("the mesh of each step"))
        self.animation, self.format = CheckBox(tr("an animation:")), format_choice(".gif")
        self.format.setEnabled(False)
        self.animation.toggled.connect(self.format.setEnabled)
        return widget_row(self.meshes, self.animation, self.format)

    def begin(self) -> None:
        """Start the sweep with the options chosen."""
        document = self._state.document
        methods = [name for name, check in self.methods.items() if check.isChecked()]
        motion: tuple[MotionStep, ...] = ()
        words: list[str] = []
        try:
            if self.motion.currentData() == _TWIST:
                typed = f"handle {self._handle + 1}: twist {self.twist.text()}"
                motion = motion_steps(self._state.document, typed, Unit.NONE)
                words = ["--handle", str(self._handle + 1), f"--twist={self.twist.text()}"]
            steps, last_share = round(self.steps.value()), self.to.value() / 100.0
            cases_by_method(case_of(document, steps, last_share, motion=motion), methods)
        except InputError as error:
            self.run.show_failure(str(error))
            return
        words += ["--steps", str(steps), "--to", repr(last_share)]
        words += ["--methods", ",".join(methods), "--iterations", str(round(self.iterations.value()))]
        words += ["--meshes"] if self.meshes.isChecked() else []
        ending = self.format.currentData() if self.animation.isChecked() else ""

        def prepared(scratch: Path, results: Path) -> list[str]:
            session = scratch / "sweep.apd"
            save_session(session, self._state, self._view)
            animated = ["--animation", str(results / f"sweep{ending}")] if ending else []
            return ["sweep", str(session), *words, *animated, "-o", str(results)]

        self.run.begin(prepared)
