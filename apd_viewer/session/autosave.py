"""Autosave of unsaved work after every finished step, for recovery after a crash.

It survives the end of this program as soon as the file is in its place, and a power failure once it has been
flushed.
"""

import logging
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from apd_viewer.files.storage.atomic_file import flush_to_disk
from apd_viewer.files.storage.lock import FileLock
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr
from apd_viewer.session.file_jobs import FileJobs
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.history import HistoryEntry
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import RegionImage, View
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.saved_work import SavedWork
from apd_viewer.session.state_store import Activity, Listener, StateStore
from apd_viewer.session.storage.recovery_file import RecoveryFile, claim_path, make_private, remove_and_unlock
from apd_viewer.session.storage.session_file import save_session

# A step waits until its copy is written: 5 ms, or 0.1 s for a million vertices. A slow disk may take longer
# than this, and the step does not wait for it; nor does a held key.
_MOMENT = 0.25  # maximum wait in seconds


class Autosave:
    """Autosave of each finished step and its converged shape; inactive until started.

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
        self._image: RegionImage | None = None
        self.interval: float | None = 0.0

    def start(self, folder: Path, view: Callable[[], View] = View) -> None:
        """Start saving to a file in ``folder``; ``view()`` gives the current view."""
        self._view = view
        self._writer = AutosaveWriter(folder, self._listener.wake)
        self._writer.set_interval(self.interval or 0.0)

    def set_interval(self, seconds: float | None) -> None:
        """Save at most once every ``seconds``; None turns saving off, removes the file."""
        self.interval = seconds
        if self._writer is not None and seconds is not None:
            self._writer.set_interval(seconds)
        self.follow_state()

    def restore(self, recovery_file: RecoveryFile) -> None:
        """Open a recovery file of a crashed program in the background, as unsaved work."""
        if recovery_file not in self._restored:
            self._restored.append(recovery_file)
        self._files.open_result(recovery_file.name, recovery_file.read, is_saved=False)

    def follow_state(self) -> None:
        """Save the state if it is new and not yet saved in a session file."""
        state = self._store.state
        if self._writer is None or state is None or self._gestures.state_before is not None:
            return
        shown = tuple(left for left in self._restored if left.mesh is state.document.mesh)
        for left in shown:
            left.is_restored = True
        work, view = self._saved_work, self._view()
        is_saved = not work.is_unsaved and work.is_saved_with(view.image)
        if self.interval is None or is_saved:
            self._discard_copy()
        elif self._is_new(state) or view.image is not self._image:
            step = self._gestures.history.last_entry
            is_step = state.document is not self._document and step is not self._step
            self._document, self._frame, self._step = state.document, state.frame, step
            self._image = view.image
            waits = is_step and not self.interval
            self._writer.put(AutosaveCopy(state, view, shown), _MOMENT if waits else 0.0)

    def report_failures(self) -> None:
        """Report failures of the writing thread."""
        if self._writer is not None and (failure := self._writer.take_failure()):
            self._listener.message_sent(failure)

    def _is_new(self, state: State) -> bool:
        settled = self._store.activity is not Activity.REFINING
        return state.document is not self._document or (settled and state.frame is not self._frame)

    def _discard_copy(self) -> None:
        if self._writer is not None and self._document is not None:
            self._writer.put(None)
        self._document = self._frame = self._step = self._image = None

    def close(self) -> None:
        """Remove the autosave file and restored recovery files on a regular exit."""
        if self._writer is not None:
            self._writer.close()
        for left in self._restored:
            if left.is_restored:
                left.discard()
        self._restored.clear()
        self._writer = None
        self._discard_copy()


_LOGGER = logging.getLogger(__name__)
_PATIENCE = 10.0  # maximum wait in seconds for the disk at exit
_FAILED = tr("Autosave failed ({why}); save the session regularly.")


@dataclass(frozen=True, eq=False)
class AutosaveCopy:
    """Content of an autosave file, and the recovery files superseded by it."""

    state: State
    view: View
    superseded_files: tuple[RecoveryFile, ...] = ()


class AutosaveWriter:
    """Thread writing the newest copy of the session to the autosave file.

    Parameters
    ----------
    folder : Path
        Folder of the file, created if missing.
    wake : callable
        Called on the thread when there is a failure to take.
    """

    def __init__(self, folder: Path, wake: Callable[[], object]) -> None:
        self._folder = folder
        self._wake = wake
        self._mailbox: Mailbox[tuple[int, AutosaveCopy | None]] = Mailbox()
        self._asked = self._done = 0
        self._pace = 0.0
        self._doing = threading.Condition()
        self._failures: Mailbox[str] = Mailbox()
        self._interval = 0.0
        self._removes = False
        self._hurry = threading.Event()
        self._failing = False
        self._mine: tuple[Path, FileLock] | None = None
        self._thread = threading.Thread(target=self._run, name="backup", daemon=True)
        self._thread.start()

    def put(self, copy: AutosaveCopy | None, patience: float = 0.0) -> None:
        """Queue ``copy``, replacing any other in the queue; None removes the file.

        Returns when it is written, after ``patience`` seconds at the latest, and at once if the previous
        write took longer than that.
        """
        with self._doing:
            self._asked += 1
            self._mailbox.put((self._asked, copy))
            self._removes = copy is None
            self._hurry.set()
            if self._pace < patience:
                done = self._doing.wait_for(lambda: self._done == self._asked, patience)
                self._pace = self._pace if done else patience

    def set_interval(self, seconds: float) -> None:
        """Write at most once in ``seconds``; removal is immediate."""
        self._interval = seconds
        self._hurry.set()

    def take_failure(self) -> str | None:
        """Sentence about a write failure, returned once; None if there is none."""
        return self._failures.take()

    def close(self) -> None:
        """Stop the thread and remove the file."""
        self._mailbox.close()
        self._removes = True
        self._hurry.set()
        self._thread.join(_PATIENCE)

    # Methods of the thread "backup"

    def _run(self) -> None:
        while (put := self._mailbox.wait()) is not None:
            number, copy = put
            if copy is None:
                self._remove()
                self._report_done(number, self._pace)
            else:
                self._try_write(number, copy)
                self._wait_until_due()
        self._remove()

    def _wait_until_due(self) -> None:
        """Wait until the next copy is due; newer copies replace the queued one."""
        since = time.monotonic()
        while not self._removes and (left := since + self._interval - time.monotonic()) > 0.0:
            self._hurry.wait(left)
            self._hurry.clear()

    def _try_write(self, number: int, copy: AutosaveCopy) -> None:
        since = time.monotonic()
        try:
            try:
                path = self._write(copy)
            finally:
                self._report_done(number, time.monotonic() - since)
            flush_to_disk(path)
            for left in copy.superseded_files:
                left.discard()
            self._failing = False
        except Exception as error:  # no retry: saving is tried again after the next step
            reason = error if isinstance(error, OSError) else error.__cause__
            if not isinstance(reason, OSError):
                traceback.print_exc()
                _LOGGER.exception("The copy for the case of a crash could not be written")
            if not self._failing:
                self._failing = True
                why = getattr(reason, "strerror", None) or str(error) or type(error).__name__
                self._failures.put(_FAILED.format(why=why))
                self._wake()

    def _report_done(self, number: int, pace: float) -> None:
        with self._doing:
            self._done, self._pace = number, pace
            self._doing.notify_all()

    def _remove(self) -> None:
        if self._mine is not None:
            remove_and_unlock(*self._mine)
            self._mine = None

    def _write(self, copy: AutosaveCopy) -> Path:
        if self._mine is not None and not self._mine[1].is_in_place:  # deleted by another program
            self._mine[1].release()
            self._mine = None
        if self._mine is None:
            self._mine = claim_path(self._folder)
        save_session(self._mine[0], copy.state, copy.view, is_urgent=True, finish=make_private)
        return self._mine[0]
