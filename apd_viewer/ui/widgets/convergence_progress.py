"""Progress of the solver: a thin bar and the time left."""

import time
from collections.abc import Callable

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QLabel, QWidget

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr
from apd_viewer.presentation.time_left import TimeLeftEstimate, duration_text, time_left_text
from apd_viewer.ui.widgets.box_layouts import row_layout
from apd_viewer.ui.widgets.thin_bar import ThinBar

PROGRESS_WIDTH = 88  # px: width of the bar
# Faster convergence needs no progress bar; during a drag of a handle the solver restarts constantly.
_PATIENCE = 2.0  # s
_SOON = 0.5  # s; the same while nothing moves yet, as matrices are factored first
_ESTIMATION = 8.0  # s; without an estimate by then, the iterations done are shown instead
_TICK = 500  # ms; updates the time left even without new frames
_UNKNOWN, _SEARCHING = tr("estimating the time left…"), tr("looking for a lower energy…")


class ConvergenceProgress(QWidget):
    """Thin bar with the time left, shown if the solver takes longer than 2 s.

    Parameters
    ----------
    clock : callable
        The time in seconds.
    is_waiting : callable
        Whether the solver waits for its kernels, when no time left can be estimated.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, is_waiting: Callable[[], bool] = lambda: False
    ) -> None:
        super().__init__(toolTip=tr("Estimated from how fast the shape converges"))
        self._clock, self._waits = clock, is_waiting
        self._forecast: TimeLeftEstimate | None = None
        self._frame: Frame | None = None
        self._iteration, self._prepared = 0, ""
        self.bar = ThinBar()
        self.bar.setFixedWidth(PROGRESS_WIDTH)
        self.time_left = QLabel()
        bar = self.bar, 0, Qt.AlignmentFlag.AlignVCenter
        row_layout(bar, self.time_left, spacing=0, margins=(8, 0, 0, 0), parent=self)
        self._timer = QTimer(self, interval=_TICK, timeout=self._show)
        self.hide()

    def set_frame(self, frame: Frame | None, solving: bool, prepared: str = "") -> None:
        """Update from a solver's frame; ``solving`` is True while it works.

        ``prepared`` is the title of the method until its matrix is factored, empty afterwards.
        """
        self._prepared = prepared
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
            self._forecast.add_sample(now, frame.gap, frame.seconds_left)
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
        passed = now - forecast.start_moment
        unknown = _UNKNOWN if passed < _ESTIMATION else self._elapsed_text(passed)
        self.time_left.setText(_SEARCHING if rests else unknown if left is None else time_left_text(left))
        if self._prepared:
            said = tr("preparing the method {method}, {duration} so far")
            self.time_left.setText(said.format(method=self._prepared, duration=duration_text(passed)))
        self.setVisible(passed >= (_SOON if self._prepared else _PATIENCE) and not self._waits())

    def _elapsed_text(self, seconds: float) -> str:
        """Text of the iterations and the time so far."""
        said = (
            tr("iteration {n}, {duration} so far")
            if self._iteration
            else tr("first iteration, {duration} so far")
        )
        return said.format(n=self._iteration, duration=duration_text(seconds))
