"""Status bar: tool hint, jobs, solver speed, convergence and time left."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QStatusBar, QToolButton, QWidget

from apd_viewer.language import tr, trn
from apd_viewer.presentation.number_format import format_short
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.brush_tool import BrushSize
from apd_viewer.ui.widgets.box_layouts import row_layout
from apd_viewer.ui.widgets.convergence_progress import PROGRESS_WIDTH, ConvergenceProgress
from apd_viewer.ui.widgets.thin_bar import ElidedLabel, ThinBar

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.session import Session
    from apd_viewer.session.state_store import Activity

# Values of Activity, not imported here: its module would delay the first frame.
_SOLVING, _PAUSED = "refining", "paused"


class StatusBar(QStatusBar):
    """Hint on the left; job, progress, pace, mesh size and findings on the right.

    Parameters
    ----------
    badge : QWidget
        Of the findings.

    Attributes
    ----------
    run, run_stop : QLabel, QToolButton
        Progress of a run of the Wall method without its panel, and button to stop it.
    pause : QToolButton
        Stops the solver, or lets it go on; restarts it while it does not answer.
    hint : ElidedLabel
        About the current tool.
    extent : QLabel
        Number of vertices; size in the tip.
    """

    cancel_requested = Signal()
    run_stop_requested = Signal()
    pause_requested = Signal()
    restart_requested = Signal()

    def __init__(self, badge: QWidget) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self.hint = ElidedLabel()
        self._cancel = QToolButton(text=tr("Cancel"))
        self._cancel.clicked.connect(self.cancel_requested)
        self.run = QLabel()
        self.run_stop = QToolButton(
            text=tr("Stop"), toolTip=tr("Solve the wall no further; what has come stays")
        )
        self.run_stop.clicked.connect(self.run_stop_requested)
        self.pause = QToolButton(text=tr("Pause"), clicked=self._press_pause)
        self._silence = ""
        self.compiling = CompilingProgress()
        self.progress = ConvergenceProgress(is_waiting=self.compiling.isVisible)
        self._job, self._pace, self.extent = QLabel(), ElidedLabel(), QLabel()
        # Both may be elided, as their tooltips have the full texts; the pace gives way first.
        self.hint.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.addWidget(self.hint)
        # What comes and goes takes the room of the hint alone, so that the rest does not shift at every drag.
        coming = self._job, self._cancel, self.run, self.run_stop, self.compiling, self.progress, self.pause
        self._right = *coming, self._pace, self.extent, badge
        for widget in self._right:
            self.addPermanentWidget(widget)
        self.messageChanged.connect(self._follow_message)
        self._pace_room = 0, 0  # px: for the count alone, and for the longest text of this count
        # Text only: an animated indicator would redraw the whole window 60 times a second.
        self._job.setText(tr("Starting…"))
        self._cancel.hide()
        self.show_run("")
        self.pause.hide()

    def show_hint(self, text: str) -> None:
        """Show the hint of the current tool."""
        self.hint.setText(text)
        self._share_room()

    def _follow_message(self, message: str) -> None:
        """Show a temporary message in the tip as well; it takes the place of the hint."""
        self.setToolTip(message)
        self._share_room()

    def _share_room(self) -> None:
        """Leave the pace the room that the hint or message does not need."""
        row = self.layout()
        gap = 0 if row is None else row.spacing()
        taken = sum(
            each.sizeHint().width() + gap
            for each in self._right
            if each is not self._pace and not each.isHidden()
        )
        message = self.currentMessage()
        needed = self.hint.room_for(message) if message else self.hint.sizeHint().width()
        left = self.width() - taken - needed - 2 * gap
        least, most = self._pace_room
        room = QSize(max(least, min(most, left)), self.hint.sizeHint().height())
        if room != self._pace.maximumSize():
            # Of a fixed size, so that its numbers do not make the window lay out and draw everything anew.
            self._pace.setFixedSize(room)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Share the room anew."""
        super().resizeEvent(event)
        self._share_room()

    def show_brush_size(self, brush: BrushSize, unit: Unit) -> None:
        """Briefly show the brush size."""
        size = (
            f"{brush.radius:.0f} px"
            if brush.mesh_radius is None
            else unit.format_length(format_short(brush.mesh_radius))
        )
        self.showMessage(tr("Brush {size}").format(size=size), 1500)

    def show_edge_angle(self, degrees: float) -> None:
        """Briefly show the edge angle at which a fill stops."""
        self.showMessage(tr("Edge angle {angle:g}°").format(angle=degrees), 1500)

    def show_session(self, session: Session) -> None:
        """Show the session's jobs and the solver's activity."""
        job, state = session.jobs.current, session.store.state
        self._job.setText(tr("{job}…").format(job=job.title) if job else "")
        self._job.setVisible(job is not None)
        self._cancel.setVisible(job is not None and job.can_be_cancelled)
        self.extent.setText(_vertices(state) if state else "")
        self.extent.setToolTip(_mesh_size_text(state, session.store.unit) if state else "")
        self.compiling.show_fraction(session.store.compiled_fraction)
        activity = session.store.activity
        self._silence = session.store.silence_text
        self._show_pause(activity)
        prepared = state.document.settings.traits.short_title if state and session.store.is_preparing else ""
        self.progress.set_frame(state.frame if state else None, activity.value == _SOLVING, prepared)
        iteration = state.frame.iteration if state else 0
        pace = 1e3 * session.store.seconds_per_iteration
        # No rate to show for an opened or restored shape that this window has not iterated.
        measured = tr("iteration {iteration:,}, {pace:.1f} ms per iteration")
        count = tr("iteration {iteration:,}").format(iteration=iteration) if iteration else ""
        text = measured.format(iteration=iteration, pace=pace) if iteration and pace else count
        self._pace.setText(text)
        most = max(self._pace_room[1], self._pace.room_for(text)) if count else 0
        least = max(self._pace_room[0], self._pace.room_for(f"{count}…")) if count else 0
        self._pace_room = least, most  # it never jumps while it counts
        self._share_room()

    def show_run(self, said: str) -> None:
        """Show the progress of a background run and its Stop; hide both if empty."""
        self.run.setText(said)
        for widget in (self.run, self.run_stop):
            widget.setVisible(bool(said))
        self._share_room()

    def _press_pause(self) -> None:
        (self.restart_requested if self._silence else self.pause_requested).emit()

    def _show_pause(self, activity: Activity) -> None:
        if self._silence:
            self.pause.setText(tr("Restart solver"))
            self.pause.setToolTip(tr("Restart the solver from the shape on screen"))
            self.pause.show()
            return
        paused = activity.value == _PAUSED
        self.pause.setText(tr("Continue") if paused else tr("Pause"))
        self.pause.setToolTip(tr("Continue solving") if paused else tr("Pause the solver"))
        self.pause.setVisible(activity.value in (_PAUSED, _SOLVING))


def _vertices(state: State) -> str:
    n = state.inspection.vertices
    return trn("{n:,} vertex", "{n:,} vertices", n).format(n=n)


def _mesh_size_text(state: State, unit: Unit) -> str:
    """Text with vertex and face counts, and extents along x, y and z."""
    found = state.inspection
    size = unit.format_length(" × ".join(format_short(extent) for extent in found.size))
    return tr("{vertices:,} vertices, {faces:,} faces; {size} at rest").format(
        vertices=found.vertices, faces=found.faces, size=size
    )


class CompilingProgress(QWidget):
    """Thin bar shown while kernels are being compiled."""

    def __init__(self) -> None:
        super().__init__(toolTip=tr("The first shapes may have to wait; later starts do not."))
        self.bar = ThinBar()
        self.bar.setFixedWidth(PROGRESS_WIDTH)
        text = QLabel(tr("compiling for this computer, only once…"))
        bar = self.bar, 0, Qt.AlignmentFlag.AlignVCenter
        row_layout(bar, text, spacing=0, margins=(8, 0, 0, 0), parent=self)
        self.hide()

    def show_fraction(self, fraction: float | None) -> None:
        """Show the fraction of kernels compiled; hide if None or 1."""
        self.setVisible(fraction is not None and fraction < 1.0)
        if fraction is not None:
            self.bar.show_fraction(fraction)
