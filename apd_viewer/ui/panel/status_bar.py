"""Status bar: tool hint, jobs, solver speed, convergence and time left."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QLabel, QSizePolicy, QStatusBar, QToolButton, QWidget

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr, trn
from apd_viewer.presentation.number_format import format_short
from apd_viewer.presentation.time_left import TimeLeftEstimate, time_left_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.brush_tool import BrushSize
from apd_viewer.ui.widgets.box_layouts import row_layout
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
    pause : QToolButton
        Stops the solver, or lets it go on; restarts it while it does not answer.
    hint : ElidedLabel
        About the current tool.
    extent : QLabel
        Number of vertices; size in the tip.
    """

    cancel_requested = Signal()
    pause_requested = Signal()
    restart_requested = Signal()

    def __init__(self, badge: QWidget) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self.hint = ElidedLabel()
        self._cancel = QToolButton(text=tr("Cancel"))
        self._cancel.clicked.connect(self.cancel_requested)
        self.pause = QToolButton(text=tr("Pause"), clicked=self._press_pause)
        self._silence = ""
        policy = self.pause.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # keeps its space, so that nothing moves at every drag
        self.pause.setSizePolicy(policy)
        self.compiling = CompilingProgress()
        self.progress = ConvergenceProgress(is_waiting=self.compiling.isVisible)
        self._job, self._pace, self.extent = QLabel(), ElidedLabel(), QLabel()
        # Gives way first: it may be elided, as its tooltip has the full text.
        self.hint.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.addWidget(self.hint, 1)
        for widget in (
            self._job,
            self._cancel,
            self.compiling,
            self.progress,
            self._pace,
            self.pause,
            self.extent,
            badge,
        ):
            self.addPermanentWidget(widget)
        # Text only: an animated indicator would redraw the whole window 60 times a second.
        self._job.setText(tr("Starting…"))
        self._cancel.hide()
        self.pause.hide()

    def show_hint(self, text: str) -> None:
        """Show the hint of the current tool."""
        self.hint.show_text(text)

    def show_brush_size(self, brush: BrushSize, unit: Unit) -> None:
        """Show the brush size for a moment."""
        size = (
            f"{brush.radius:.0f} px"
            if brush.mesh_radius is None
            else unit.format_length(format_short(brush.mesh_radius))
        )
        self.showMessage(tr("Brush {size}").format(size=size), 1500)

    def show_edge_angle(self, degrees: float) -> None:
        """Show the edge angle limiting a fill for a moment."""
        self.showMessage(tr("Edge angle {angle:g}°").format(angle=degrees), 1500)

    def show_session(self, session: Session) -> None:
        """Show the session's jobs and the solver's activity."""
        job, state = session.jobs.current, session.store.state
        self._job.setText(tr("{job}…").format(job=job.title) if job else "")
        self._job.setVisible(job is not None)
        self._cancel.setVisible(job is not None and job.can_be_cancelled)
        self.extent.setText(_vertices(state) if state else "")
        self.extent.setToolTip(_extent(state, session.store.unit) if state else "")
        self.compiling.follow(session.store.compiled_share)
        activity = session.store.activity
        self._silence = session.store.silence_text
        self._show_pause(activity)
        self.progress.follow(state.frame if state else None, activity.value == _SOLVING)
        iteration = state.frame.iteration if state else 0
        pace = 1e3 * session.store.seconds_per_iteration
        # No rate to show for an opened or restored shape that this window has not iterated.
        measured = tr("iteration {iteration:,}, {pace:.1f} ms per iteration")
        words = measured if pace else tr("iteration {iteration:,}")
        self._pace.show_text(words.format(iteration=iteration, pace=pace) if iteration else "")

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


def _extent(state: State, unit: Unit) -> str:
    """Vertex and face counts, and extents along x, y and z, as text."""
    found = state.inspection
    size = unit.format_length(" × ".join(format_short(extent) for extent in found.size))
    return tr("{vertices:,} vertices, {faces:,} faces; {size} at rest").format(
        vertices=found.vertices, faces=found.faces, size=size
    )


_WIDTH = 88


class CompilingProgress(QWidget):
    """Thin bar shown while kernels are being compiled."""

    def __init__(self) -> None:
        super().__init__(toolTip=tr("The first shapes may have to wait; later starts do not."))
        self.bar = ThinBar()
        self.bar.setFixedWidth(_WIDTH)
        text = QLabel(tr("compiling for this computer, only once…"))
        bar = self.bar, 0, Qt.AlignmentFlag.AlignVCenter
        row_layout(bar, text, spacing=0, margins=(8, 0, 0, 0), parent=self)
        self.hide()

    def follow(self, fraction: float | None) -> None:
        """Show the fraction of kernels compiled; hide if None or 1."""
        self.setVisible(fraction is not None and fraction < 1.0)
        if fraction is not None:
            self.bar.show_fraction(fraction)


# Faster convergence needs no progress bar; during a drag of a handle the solver restarts constantly.
_PATIENCE = 2.0  # s
_TICK = 500  # ms; updates the time left even without new frames
_UNKNOWN, _SEARCHING = tr("estimating the time left…"), tr("looking for a lower energy…")


class ConvergenceProgress(QWidget):
    """Thin bar with the time left, shown if the solver takes longer than 2 s.

    Parameters
    ----------
    clock : callable
        The time in seconds.
    is_waiting : callable
        Whether the solver waits for its kernels: until then no time left can be told.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, is_waiting: Callable[[], bool] = lambda: False
    ) -> None:
        super().__init__(toolTip=tr("Estimated from how fast the shape converges"))
        self._clock, self._waits = clock, is_waiting
        self._forecast: TimeLeftEstimate | None = None
        self._frame: Frame | None = None
        self._iteration = 0
        self.bar = ThinBar()
        self.bar.setFixedWidth(_WIDTH)
        self.time_left = QLabel()
        bar = self.bar, 0, Qt.AlignmentFlag.AlignVCenter
        row_layout(bar, self.time_left, spacing=0, margins=(8, 0, 0, 0), parent=self)
        self._timer = QTimer(self, interval=_TICK, timeout=self._show)
        self.hide()

    def follow(self, frame: Frame | None, solving: bool) -> None:
        """Update from a solver's frame; ``solving`` is True while it works."""
        if not solving or frame is None:
            self._forecast = self._frame = None
            self._timer.stop()
            self.hide()
            return
        now = self._clock()
        if self._forecast is None or (frame is not self._frame and frame.iteration <= self._iteration):
            # Until the first iteration, the shape on screen belongs to the previous motion.
            self._forecast, self._iteration = TimeLeftEstimate(now), 0
            self._timer.start()
        elif frame is not self._frame:
            self._forecast.add_gap(now, frame.gap, frame.seconds_left)
            self._iteration = frame.iteration
        self._frame = frame
        self._show()

    def _show(self) -> None:
        forecast, now = self._forecast, self._clock()
        assert forecast is not None
        assert self._frame is not None
        gap, left = self._frame.gap, forecast.seconds_left(now)
        rests = self._iteration > 0 and gap is not None and gap <= 1.0
        self.bar.show_fraction(1.0 if rests else forecast.elapsed_fraction(now))
        self.time_left.setText(_SEARCHING if rests else _UNKNOWN if left is None else time_left_text(left))
        self.setVisible(now - forecast.start_moment >= _PATIENCE and not self._waits())
