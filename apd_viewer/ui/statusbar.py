"""The line at the bottom: what the tool does, what is under way, how fast the solver is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QStatusBar, QToolButton

if TYPE_CHECKING:
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
        self._cancel = QToolButton(text="Cancel")
        self._cancel.clicked.connect(self.cancel_asked)
        self._errand, self._pace, self._size = QLabel(), QLabel(), QLabel()
        self.addWidget(self._hint, 1)
        for widget in (self._errand, self._cancel, self._pace, self._size):
            self.addPermanentWidget(widget)
        # In words: a bar that runs to and fro would have the whole window composed 60 times a second.
        self._errand.setText("Starting…")
        self._cancel.hide()

    def hint(self, text: str) -> None:
        """Say what the tool in hand does."""
        self._hint.setText(text)
        self._hint.setToolTip(text)

    def show_session(self, session: Session) -> None:
        """Show what is under way."""
        errand, state = session.errand, session.state
        self._errand.setText(f"{errand.title}…" if errand else "")
        self._errand.setVisible(errand is not None)
        self._cancel.setVisible(errand is not None and errand.can_be_cancelled)
        self._size.setText(f"{state.inspection.vertices:,} vertices" if state else "")
        iteration = state.frame.iteration if state else 0
        pace = f"iteration {iteration:,}, {1e3 * session.seconds_per_iteration:.1f} ms an iteration"
        self._pace.setText(pace if iteration else "")
