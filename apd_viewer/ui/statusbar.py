"""The line at the bottom: what the tool does, what is under way, how fast the solver is."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QProgressBar, QStatusBar, QToolButton

from apd_viewer.session.session import Session


class StatusBar(QStatusBar):
    """Hint at the left; errand, pace and size of the mesh at the right.

    Attributes
    ----------
    cancel_asked : Signal()
    """

    cancel_asked = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self._hint = QLabel()
        self._progress = QProgressBar(maximumWidth=120, textVisible=False)
        self._progress.setRange(0, 0)
        self._cancel = QToolButton(text="Cancel")
        self._cancel.clicked.connect(self.cancel_asked)
        self._errand, self._pace, self._size = QLabel(), QLabel(), QLabel()
        self.addWidget(self._hint, 1)
        for widget in (self._errand, self._progress, self._cancel, self._pace, self._size):
            self.addPermanentWidget(widget)

    def hint(self, text: str) -> None:
        """Say what the tool in hand does."""
        self._hint.setText(text)
        self._hint.setToolTip(text)

    def show_session(self, session: Session) -> None:
        """Show what is under way."""
        errand, state = session.errand, session.state
        self._errand.setText(errand.title if errand else "")
        self._errand.setVisible(errand is not None)
        self._progress.setVisible(errand is not None)
        self._cancel.setVisible(errand is not None and errand.can_be_cancelled)
        self._size.setText(f"{state.inspection.vertices:,} vertices" if state else "")
        iteration = state.frame.iteration if state else 0
        pace = f"iteration {iteration:,}, {1e3 * session.seconds_per_iteration:.1f} ms an iteration"
        self._pace.setText(pace if iteration else "")
