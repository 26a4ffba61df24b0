"""Progress towards convergence, and the time left, in the status bar."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.time_left import TimeLeftEstimate, time_left_text
from apd_viewer.ui.widgets.thin_bar import ThinBar

if TYPE_CHECKING:
    from collections.abc import Callable

    from apd_viewer.geometry.pose.frame import Frame

# What converges sooner needs no progress; and while a handle is dragged the solver begins anew all the time.
_PATIENCE = 2.0  # s
_TICK = 500  # ms; the time goes on while no frame comes
_WIDTH = 88
_UNKNOWN, _SEARCHING = tr("estimating the time left…"), tr("looking for a lower energy…")


class ConvergenceProgress(QWidget):
    """A thin bar with the time left, shown when the solver works for longer.

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
        self.words = QLabel()
        row = QHBoxLayout(self, spacing=0)
        row.setContentsMargins(8, 0, 0, 0)
        row.addWidget(self.bar, 0, Qt.AlignmentFlag.AlignVCenter)
        row.addWidget(self.words)
        self._timer = QTimer(self, interval=_TICK)
        self._timer.timeout.connect(self._show)
        self.hide()

    def follow(self, frame: Frame | None, solving: bool) -> None:
        """Follow the frames of a solver; ``solving`` says whether it works."""
        if not solving or frame is None:
            self._forecast = self._frame = None
            self._timer.stop()
            self.hide()
            return
        now = self._clock()
        if self._forecast is None or (frame is not self._frame and frame.iteration <= self._iteration):
            # The shape on screen is that of an earlier motion until the first iteration.
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
        self.bar.show_share(1.0 if rests else forecast.share_passed(now))
        self.words.setText(_SEARCHING if rests else _UNKNOWN if left is None else time_left_text(left))
        self.setVisible(now - forecast.start_moment >= _PATIENCE and not self._waits())
