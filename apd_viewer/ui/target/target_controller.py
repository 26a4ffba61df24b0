"""Controller of the target shape: loading, and measuring the distance to it."""

from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from apd_viewer.geometry.analysis.target_shape import TargetDistance, TargetShape
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.deviation_overlay import DeviationOverlay
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.target.target_section import TargetSection
from apd_viewer.ui.widgets.background_task import BackgroundTask


class _TargetComparison(NamedTuple):
    """A shape and its distance from a target shape, None if cancelled."""

    target: TargetShape
    U: np.ndarray
    distance: TargetDistance | None


class TargetController(QObject):
    """Loads and clears the target shape, and measures the distance from it.

    Parameters
    ----------
    window : QWidget
        Over which to ask.
    overlay : DeviationOverlay
        Shows the distance of a target shape once it is loaded.
    """

    def __init__(
        self,
        window: QWidget,
        section: TargetSection,
        preferences: Preferences,
        overlay: DeviationOverlay,
        session: Session,
    ) -> None:
        super().__init__(window)
        self._window, self._section, self._memory = window, section, preferences
        self._heat, self._session = overlay, session
        self._task = BackgroundTask(self)
        self._task.done.connect(self._receive_result)
        self._wanted: tuple[TargetShape, np.ndarray] | None = None
        section.clear.clicked.connect(lambda: self.clear_target_shape())

    def ask_for_target_shape(self) -> None:
        """Ask for a mesh as target shape, and colour the shape by distance."""
        if self._session.store.state is None:
            return
        path = file_dialogs.ask_for_target_shape(self._window, self._memory.last_folder)
        if path is not None:
            self._session.shapes.load_target(path, lambda: self._heat.choose_measure(Measure.TARGET_DISTANCE))

    def clear_target_shape(self) -> None:
        """Remove the target shape."""
        if self._session.store.state is not None:
            self._session.shapes.clear_target()

    def refresh(self) -> None:
        """Measure the distance once the shape has converged; cancel outdated work."""
        session, state = self._session, self._session.store.state
        target = None if state is None else state.document.target_shape
        rests = session.gestures.state_before is None and session.store.activity is not Activity.REFINING
        wanted = (target, state.frame.U) if state and target and rests else None
        self._request_distance(wanted)

    def _request_distance(self, wanted: tuple[TargetShape, np.ndarray] | None) -> None:
        before, self._wanted = self._wanted, wanted
        if wanted is None:
            self._task.cancel()
            self._section.show_distance(None)
        elif before is None or any(x is not y for x, y in zip(before, wanted, strict=True)):
            self._section.show_distance(None)
            target, U = wanted
            mesh = self._session.store.required_state().document.mesh
            self._task.begin(
                lambda enough: _TargetComparison(target, U, target.target_distance(mesh, U, enough))
            )

    def _receive_result(self, result: object) -> None:
        """Show the thread's result, which is None if memory ran out."""
        if isinstance(result, _TargetComparison):
            self._section.show_distance(result.distance)

    def close(self) -> None:
        """Cancel the measurement in progress and wait for its thread."""
        self._task.close()
