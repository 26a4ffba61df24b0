"""Session: one open mesh and its workers, without a window.

All methods, including those of the parts, are called on one thread.
"""

import time
from collections.abc import Callable

from apd_viewer.session.autosave import Autosave
from apd_viewer.session.background_job import Jobs
from apd_viewer.session.file_jobs import FileJobs
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.handle_editor import HandleEditor, PoseEditor
from apd_viewer.session.measurement_readings import MeasurementEditor, MeasurementReadings
from apd_viewer.session.obstacle_editor import ObstacleEditor
from apd_viewer.session.part_editor import PaintEditor, PartEditor
from apd_viewer.session.processes.freed_memory import release_freed_memory
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.session.saved_work import SavedWork
from apd_viewer.session.settings_editor import SettingsEditor
from apd_viewer.session.shape_checks import ShapeChecks
from apd_viewer.session.shape_editor import ShapeEditor
from apd_viewer.session.state_store import Activity, Listener, StateStore, with_followers
from apd_viewer.session.timeline_player import TimelinePlayer
from apd_viewer.session.typed_values import TypedValues
from apd_viewer.session.wall_run import WallRun


class Session:
    """Open mesh with its editors and workers, created and closed together.

    Attributes
    ----------
    store : StateStore
        The state on screen and the activity of the solver.
    gestures : Gestures
        Steps of undo.
    """

    def __init__(self, listener: Listener) -> None:
        followers: list[Callable[[], object]] = []
        listener = with_followers(listener, followers)
        self._worker = SolverWorker(listener.wake)
        self.store = store = StateStore(listener, self._worker)
        self.gestures = gestures = Gestures(store, listener)
        self.painting = PaintEditor(store, gestures, listener)
        self.handles = HandleEditor(store, gestures, listener)
        self.obstacles = ObstacleEditor(store, gestures, listener)
        self.poses = PoseEditor(store, gestures, self.handles, listener)
        self.parts = PartEditor(store, gestures, listener)
        self.settings = SettingsEditor(store, gestures, listener)
        self.measurements = MeasurementEditor(store, gestures, listener)
        self.measurement_readings = MeasurementReadings(store, gestures, listener)
        self.jobs = Jobs(listener.wake, listener.failed, listener.message_sent, listener.status_changed)
        self.typed_values = TypedValues(store)
        self.player = TimelinePlayer(store, gestures, listener)
        self.wall_run = WallRun(store, self.player, listener)
        self.shapes = ShapeEditor(store, gestures, self.jobs, listener)
        self.saved_work = SavedWork(store, gestures, listener)
        self.files = FileJobs(store, gestures, self.player, self.saved_work, self.jobs, listener)
        self.autosave = Autosave(store, gestures, self.saved_work, self.files, listener)
        self.shape_checks = ShapeChecks(store, gestures, listener)
        followers += [
            self.measurement_readings.follow_state,
            self.shape_checks.follow_state,
            self.autosave.follow_state,
            self.player.follow_state,
            self.wall_run.follow_state,
        ]
        gestures.history.entries_dropped = self._release_dropped_states

    def receive_results(self) -> None:
        """Receive results of the worker and of background jobs; call it when woken."""
        self.jobs.receive_outcomes()
        self.store.receive_reply()
        self.player.receive_shape()
        self.wall_run.receive_result()
        self.autosave.report_failures()
        if self.jobs.current is None:  # writes by this program are no external changes
            self.saved_work.receive_check()
        self.measurement_readings.receive_geodesic()
        self.shape_checks.receive_check()

    def _release_dropped_states(self) -> None:
        """Release data of states dropped from the undo history."""
        self.saved_work.forget_unreachable()
        release_freed_memory()

    def wait_idle(self, timeout: float) -> bool:
        """Receive results until idle; return False after ``timeout`` seconds."""
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            self.receive_results()
            if self.jobs.current is None and self.store.activity is not Activity.REFINING:
                return True
            time.sleep(0.002)
        return False

    def close(self) -> None:
        """Stop the workers after finishing a pending write."""
        self.jobs.close()
        self.saved_work.close()
        self.autosave.close()
        self.shape_checks.close()
        self.measurement_readings.close()
        self.wall_run.close()
        self._worker.close()
