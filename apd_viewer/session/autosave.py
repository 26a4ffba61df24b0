"""Autosave of unsaved work after every finished step, for recovery after a crash."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.session.file_jobs import FileJobs
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.history import HistoryEntry
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.saved_work import SavedWork
from apd_viewer.session.state_store import Activity, StateStore
from apd_viewer.session.storage.autosave_writer import AutosaveCopy, AutosaveWriter
from apd_viewer.session.storage.recovery_file import RecoveryFile

# A step counts as done once it is safe: that takes 5 ms, or 0.1 s for a million vertices. Where it takes more
# than this the disk is slow, and the step does not wait for it; nor does a held key.
_MOMENT = 0.25  # s


class Autosave:
    """Saves each finished step, and later its settled shape; off without a folder.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    saved_work : SavedWork
    file_jobs : FileJobs
    listener : Listener

    Attributes
    ----------
    interval : float or None
        Seconds between two saves at least; None saves nothing.
    """

    def __init__(
        self,
        store: StateStore,
        gestures: Gestures,
        saved_work: SavedWork,
        file_jobs: FileJobs,
        listener: Listener,
    ) -> None:
        self._store = store
        self._gestures = gestures
        self._saved_work = saved_work
        self._listener = listener
        self._files = file_jobs
        self._view: Callable[[], View] = View
        self._writer: AutosaveWriter | None = None
        self._restored: list[RecoveryFile] = []
        self._document: Document | None = None
        self._step: HistoryEntry | None = None
        self._frame: Frame | None = None
        self.interval: float | None = 0.0

    def start(self, folder: Path, view: Callable[[], View] = View) -> None:
        """Start saving to a file in ``folder``; ``view()`` gives the current view."""
        self._view = view
        self._writer = AutosaveWriter(folder, self._listener.wake)
        self._writer.set_interval(self.interval or 0.0)

    def set_interval(self, seconds: float | None) -> None:
        """Save at most once in so many seconds; None saves nothing and removes the file."""
        self.interval = seconds
        if self._writer is not None and seconds is not None:
            self._writer.set_interval(seconds)
        self.follow_state()

    def restore(self, recovery_file: RecoveryFile) -> None:
        """Open the leftover of a killed program, in the background; it counts as unsaved."""
        if recovery_file not in self._restored:
            self._restored.append(recovery_file)
        self._files.open_result(recovery_file.name, recovery_file.read, is_saved=False)

    def follow_state(self) -> None:
        """Save the state if it is new; work that is safe in a file needs no copy."""
        state = self._store.state
        if self._writer is None or state is None or self._gestures.state_before is not None:
            return
        shown = tuple(left for left in self._restored if left.mesh is state.document.mesh)
        for left in shown:
            left.is_restored = True
        if self.interval is None or not self._saved_work.is_unsaved:
            self._forget()
        elif self._is_new(state):
            step = self._gestures.history.last_entry
            is_step = state.document is not self._document and step is not self._step
            self._document, self._frame, self._step = state.document, state.frame, step
            waits = is_step and not self.interval
            self._writer.put(AutosaveCopy(state, self._view(), shown), _MOMENT if waits else 0.0)

    def receive(self) -> None:
        """Report failures of the writing thread."""
        if self._writer is not None and (failure := self._writer.take_failure()):
            self._listener.message_sent(failure)

    def _is_new(self, state: State) -> bool:
        settled = self._store.activity is not Activity.REFINING
        return state.document is not self._document or (settled and state.frame is not self._frame)

    def _forget(self) -> None:
        if self._writer is not None and self._document is not None:
            self._writer.put(None)
        self._document = self._frame = self._step = None

    def close(self) -> None:
        """Remove the file and the restored leftovers: this is no crash."""
        if self._writer is not None:
            self._writer.close()
        for left in self._restored:
            if left.is_restored:
                left.discard()
        self._restored.clear()
        self._writer = None
        self._forget()
