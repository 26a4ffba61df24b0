"""Autosave writer: the latest step in a file, written on its own thread.

It is safe from the end of this program as soon as the file is in its place, and from that of the power once
it has been flushed.
"""

from __future__ import annotations

import logging
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from apd_viewer.files.storage.atomic_file import flush_to_disk
from apd_viewer.files.storage.lock import FileLock
from apd_viewer.language import tr
from apd_viewer.session.jobs.mailbox import Mailbox
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.recovery_file import RecoveryFile, claim_path, make_private, remove_with_lock
from apd_viewer.session.storage.session_file import save_session

_LOGGER = logging.getLogger(__name__)
_PATIENCE = 10.0  # s, for the disk, when the program ends
_FAILED = tr("Autosave failed ({why}); save the session regularly.")


@dataclass(frozen=True, eq=False)
class AutosaveCopy:
    """Content of the file, and the leftovers it replaces."""

    state: State
    view: View
    superseded_files: tuple[RecoveryFile, ...] = ()


class AutosaveWriter:
    """Writes the newest Copy whenever it can; None and the end remove the file.

    Parameters
    ----------
    folder : Path
        Made when it is needed.
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

        Returns once that is done, but after ``patience`` seconds at the latest, and at once where the one
        before took longer than that.
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
        """Write at most once in so many seconds; removing does not wait."""
        self._interval = seconds
        self._hurry.set()

    def take_failure(self) -> str | None:
        """Sentence about a write failure, once; None if all is well."""
        return self._failures.take()

    def close(self) -> None:
        """Remove the file."""
        self._mailbox.close()
        self._removes = True
        self._hurry.set()
        self._thread.join(_PATIENCE)

    # The thread "backup"

    def _run(self) -> None:
        while (put := self._mailbox.wait()) is not None:
            number, copy = put
            if copy is None:
                self._remove()
                self._tell_done(number, self._pace)
            else:
                self._try(number, copy)
                self._rest()
        self._remove()

    def _rest(self) -> None:
        """Wait until the next copy is due; what comes meanwhile replaces it."""
        since = time.monotonic()
        while not self._removes and (left := since + self._interval - time.monotonic()) > 0.0:
            self._hurry.wait(left)
            self._hurry.clear()

    def _try(self, number: int, copy: AutosaveCopy) -> None:
        since = time.monotonic()
        try:
            try:
                path = self._write(copy)
            finally:
                self._tell_done(number, time.monotonic() - since)
            flush_to_disk(path)
            for left in copy.superseded_files:
                left.discard()
            self._failing = False
        except Exception as error:  # the next step is tried again, whatever the error
            reason = error if isinstance(error, OSError) else error.__cause__
            if not isinstance(reason, OSError):
                traceback.print_exc()
                _LOGGER.exception("The copy for the case of a crash could not be written")
            if not self._failing:
                self._failing = True
                why = getattr(reason, "strerror", None) or str(error) or type(error).__name__
                self._failures.put(_FAILED.format(why=why))
                self._wake()

    def _tell_done(self, number: int, pace: float) -> None:
        with self._doing:
            self._done, self._pace = number, pace
            self._doing.notify_all()

    def _remove(self) -> None:
        if self._mine is not None:
            remove_with_lock(*self._mine)
            self._mine = None

    def _write(self, copy: AutosaveCopy) -> Path:
        if self._mine is not None and not self._mine[1].is_in_place:  # the folder has been cleared
            self._mine[1].release()
            self._mine = None
        if self._mine is None:
            self._mine = claim_path(self._folder)
        save_session(self._mine[0], copy.state, copy.view, is_urgent=True, finish=make_private)
        return self._mine[0]
