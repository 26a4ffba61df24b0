"""Dialog that sweeps the motion of the handles, and shows the curves."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QVBoxLayout,
    QWidget,
)

from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.methods import COMPARED, METHODS
from apd_viewer.language import tr
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.session.studies.sweep import DEFAULT_ITERATIONS
from apd_viewer.session.studies.sweep_setup import MOST_STEPS, sweep_of, twist_of
from apd_viewer.ui.studies.run_bar import RunBar
from apd_viewer.ui.widgets.fields import Check, Choice, Number
from apd_viewer.ui.widgets.figure_list import FigureView
from apd_viewer.ui.widgets.fit_to_screen import resize_on_screen

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View
    from apd_viewer.ui.preferences.preferences import Preferences

_POSED, _TWIST = "posed", "twist"


class SweepDialog(QDialog):
    """Sweeps the session as it was when the dialog opened.

    Parameters
    ----------
    window : QWidget
    state : State
    handle : int
        Which a twist turns.
    view : View
        How an animation looks at the mesh.
    memory : Preferences

    Attributes
    ----------
    run : RunBar
    figure : FigureView or None
    """

    def __init__(self, window: QWidget, state: State, handle: int, view: View, memory: Preferences) -> None:
        super().__init__(window, objectName="study")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(tr("Sweep – {name}").format(name=state.document.mesh.name))
        self._state, self._handle, self._view = state, handle, view
        self.run = RunBar(tr("Sweep"), f"{state.document.mesh.stem}-sweep", memory)
        self.run.asked.connect(self.begin)
        self.run.busy.connect(self._show_busy)
        self.run.ended.connect(self._show)
        self.figure: FigureView | None = None
        self._lay_out()

    def _lay_out(self) -> None:
        self._column = QVBoxLayout(self, spacing=12)
        self._column.setContentsMargins(20, 16, 20, 16)
        words = tr(
            "Runs the motion in steps, each shape starting from the previous one, and plots area, "
            "volume and energy."
        )
        self._column.addWidget(QLabel(words, objectName="quiet", wordWrap=True))
        self._asks = QWidget()
        self._column.addWidget(self._asks)
        grid = QGridLayout(self._asks, horizontalSpacing=16, verticalSpacing=8)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(1, 1)
        rows = (
            (tr("Motion"), self._make_motion()),
            (tr("Steps"), self._make_steps()),
            (tr("Methods"), self._make_methods()),
            (tr("Also export"), self._make_extras()),
        )
        for number, (title, row) in enumerate(rows):
            grid.addWidget(QLabel(title, objectName="heading"), number, 0)
            grid.addLayout(row, number, 1)
        self.summary = QLabel(wordWrap=True, visible=False)
        self.summary.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._column.addWidget(self.summary)
        self._column.addStretch(1)
        self._column.addWidget(self.run)
        self._fit(640)

    def _make_motion(self) -> QHBoxLayout:
        document = self._state.document
        name = document.handles[self._handle].name
        self.motion = Choice()
        self.motion.setAccessibleName(tr("Motion to sweep"))
        if document.posed:
            self.motion.addItem(tr("current motion of the handles"), _POSED)
        self.motion.setMinimumWidth(260)
        self.motion.addItem(tr("twist of “{name}” by").format(name=name), _TWIST)
        self.twist = QLineEdit("180deg", objectName="typed", maximumWidth=100)
        self.twist.setAccessibleName(tr("Angle of the twist"))
        self.motion.currentIndexChanged.connect(self._show_motion)
        self._show_motion()
        return _row(self.motion, self.twist, spacing=8)

    def _show_motion(self) -> None:
        self.twist.setVisible(self.motion.currentData() == _TWIST)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = _field(tr("Number of steps"), 1, MOST_STEPS, 20)
        self.to = _field(tr("End of the motion"), 1, 1000, 100, " %")
        self.iterations = _field(tr("Iterations per step"), 1, 100_000, DEFAULT_ITERATIONS)
        words = tr("end at"), tr("of the motion, with at most"), tr("iterations each")
        first, second, third = map(QLabel, words)
        return _row(self.steps, first, self.to, second, self.iterations, third, spacing=8)

    def _make_methods(self) -> QHBoxLayout:
        own = self._state.document.method
        self.methods = {name: Check(METHODS[name].short_title) for name in COMPARED}
        for name, check in self.methods.items():
            slow = METHODS[name].slow
            check.setChecked(not slow or own == name)
            check.setToolTip(tr("Takes several times as long as the others") if slow else "")
        return _row(*self.methods.values())

    def _make_extras(self) -> QHBoxLayout:
        self.meshes = Check(tr("the mesh of each step"))
        self.animation = Check(tr("an animation (GIF)"))
        return _row(self.meshes, self.animation)

    def begin(self) -> None:
        """Start the sweep with the options chosen."""
        document = self._state.document
        methods = [name for name, check in self.methods.items() if check.isChecked()]
        twists, words = [], []
        try:
            if self.motion.currentData() == _TWIST:
                angle = twist_of(self.twist.text())
                twists = [angle if k == self._handle else 0.0 for k in range(len(document.handles))]
                # A negative angle would look like an option.
                words = [f"--twist={angle}rad" if angle else "--twist=0" for angle in twists]
            sweep_of(document, round(self.steps.value()), self.to.value() / 100.0, methods, twists)
        except InputError as error:
            self.run.fail(str(error))
            return
        words += ["--steps", str(round(self.steps.value())), "--to", repr(self.to.value() / 100.0)]
        words += ["--methods", ",".join(methods), "--iterations", str(round(self.iterations.value()))]
        words += ["--meshes"] if self.meshes.isChecked() else []
        animated = self.animation.isChecked()

        def prepared(scratch: Path, results: Path) -> list[str]:
            session = scratch / "sweep.apd"
            save_session(session, self._state, self._view)
            film = ["--animation", str(results / "sweep.gif")] if animated else []
            return ["sweep", str(session), *words, *film]

        self.run.begin(prepared)

    def _show_busy(self, on: bool) -> None:
        self._asks.setEnabled(not on)
        # Reserve room for the bar above the button: it would be taken from the fields.
        self._column.activate()
        if self._column.totalHeightForWidth(self.width()) > self.height():
            self._fit(self.width())

    def _show(self, folder: Path, said: str) -> None:
        # The first line names a temporary folder.
        self.summary.setText(re.sub(r"-(?=\d)", "−", "\n".join(said.splitlines()[1:])))
        self.summary.show()
        if self.figure is not None:
            self._column.removeWidget(self.figure)
            self.figure.deleteLater()
        self.figure = FigureView(folder / "sweep.png", tr("Curves of area, volume and energy"))
        self._column.insertWidget(self._column.indexOf(self.summary), self.figure)
        self.figure.show()  # hidden widgets take no room
        self._fit(max(self.width(), 900))

    def _fit(self, width: int) -> None:
        """Set the width, and the height it needs."""
        self._column.activate()
        resize_on_screen(self, QSize(width, self._column.totalHeightForWidth(width)))

    def done(self, result: int) -> None:
        """Close the dialog, and end a run in progress."""
        self.run.close_all()
        super().done(result)


def _field(name: str, least: int, most: int, value: int, suffix: str = "") -> Number:
    field = Number(accessibleName=name, minimum=least, maximum=most, value=value, decimals=0, suffix=suffix)
    field.setFixedWidth(72)
    return field


def _row(*widgets: QWidget, spacing: int = 16) -> QHBoxLayout:
    row = QHBoxLayout(spacing=spacing)
    for widget in widgets:
        row.addWidget(widget)
    row.addStretch(1)
    return row
