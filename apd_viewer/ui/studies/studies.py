"""Dialogs for work on many shapes: sweeps, presses, and the paper's tables."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QDialog, QWidget

from apd_viewer.ui.studies.paper_dialog import PaperDialog
from apd_viewer.ui.studies.press_dialog import PressDialog
from apd_viewer.ui.studies.sweep_dialog import SweepDialog

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View
    from apd_viewer.ui.preferences.preferences import Preferences


class Studies(QObject):
    """Opens the dialogs, each once at most.

    Parameters
    ----------
    window : QWidget
    memory : Preferences
    opened : callable
        What is open, which handle is in the hand, and how the mesh is looked at; None before there is a mesh.
    failed : callable
        Says a sentence.
    """

    def __init__(
        self,
        window: QWidget,
        memory: Preferences,
        opened: Callable[[], tuple[State, int, View] | None],
        failed: Callable[[str], object],
    ) -> None:
        super().__init__(window)
        self._window, self._memory = window, memory
        self._opened, self._failed = opened, failed
        self.dialogs: dict[str, QDialog] = {}

    def sweep(self) -> None:
        """Sweep the motion of the handles that are open."""
        found = self._opened()
        if found is None:
            return
        state, handle, view = found
        if state.document.problem:
            self._failed(state.document.problem)
            return
        self._show("sweep", lambda: SweepDialog(self._window, state, handle, view, self._memory))

    def press(self) -> None:
        """Press the mesh that is open between two plates; nothing need be painted."""
        found = self._opened()
        if found is not None:
            state, _, view = found
            self._show("press", lambda: PressDialog(self._window, state, view, self._memory))

    def paper(self) -> None:
        """Re-run the paper's tables."""
        self._show("paper", lambda: PaperDialog(self._window, self._memory))

    def close_all(self) -> None:
        """Close the dialogs, and end their runs."""
        for dialog in list(self.dialogs.values()):
            dialog.close()

    def _show(self, name: str, make: Callable[[], QDialog]) -> None:
        dialog = self.dialogs.get(name)
        if dialog is None:
            dialog = self.dialogs[name] = make()
            dialog.destroyed.connect(lambda: self.dialogs.pop(name, None))
            dialog.finished.connect(lambda: self.dialogs.pop(name, None))
        dialog.show()
        dialog.raise_()
        dialog.activateWindow()
