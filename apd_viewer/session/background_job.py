"""Background jobs such as opening or writing a file, one at a time."""

from __future__ import annotations

import logging
import queue
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from apd_viewer.errors import InputError, is_cancelled
from apd_viewer.language import tr

_LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class JobOutcome:
    """Result of a job: its ``value``, or the ``failure`` message."""

    job: Job
    value: Any = None
    failure: str | None = None


class Job:
    """Thread running ``work()`` and calling ``deliver`` with its outcome.

    Parameters
    ----------
    title : str
        Title for the user: "Opening bunny.obj".
    on_done : callable
        Called with the value on the session's thread.
    can_be_cancelled : bool
        False for a write, which must be completed.
    """

    def __init__(
        self,
        title: str,
        work: Callable[[], Any],
        on_done: Callable[[Any], object],
        deliver: Callable[[JobOutcome], None],
        can_be_cancelled: bool = True,
    ) -> None:
        self.title = title
        self.can_be_cancelled = can_be_cancelled
        self.on_done = on_done
        self._work = work
        self._deliver = deliver
        self._cancelled = threading.Event()
        self._thread = threading.Thread(target=self._run, name=title, daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        """Ask the work to end early; its outcome is nobody's."""
        self._cancelled.set()

    def join(self, timeout: float | None = None) -> None:
        """Wait until the outcome has been delivered."""
        self._thread.join(timeout)

    def _run(self) -> None:
        is_cancelled.set(self._cancelled.is_set)  # a thread has a context of its own
        try:
            outcome = JobOutcome(self, value=self._work())
        except InputError as error:
            outcome = JobOutcome(self, failure=str(error))
        except Exception as error:
            traceback.print_exc()
            _LOGGER.exception("%s failed", self.title)
            outcome = JobOutcome(
                self,
                failure=tr("{title} failed ({reason}).").format(
                    title=self.title, reason=str(error) or type(error).__name__
                ),
            )
        self._deliver(outcome)


class Jobs:
    """Current job, if any, and outcomes of finished jobs.

    Parameters
    ----------
    wake : callable
        Called on the job's thread when an outcome waits for :meth:`receive_outcomes`.
    failed : callable
        ``failed(sentence)``, called on the session's thread.
    message_sent : callable
        ``message_sent(sentence)``, called on the session's thread when a job was cancelled.
    changed : callable
        Called on the session's thread when a job may have begun or ended.
    """

    def __init__(
        self,
        wake: Callable[[], object],
        failed: Callable[[str], object],
        message_sent: Callable[[str], object],
        changed: Callable[[], object],
    ) -> None:
        self.current: Job | None = None
        self._wake = wake
        self._failed = failed
        self._message_sent = message_sent
        self._changed = changed
        self._outcomes: queue.SimpleQueue[JobOutcome] = queue.SimpleQueue()
        self._closed = False

    def run(
        self,
        title: str,
        work: Callable[[], object],
        on_done: Callable[..., object],
        can_be_cancelled: bool = True,
    ) -> None:
        """Run ``work()`` on a thread, then ``on_done(result)`` on the session's thread."""
        if self.current is not None:
            self._failed(
                tr("{title} is not finished; wait for it or cancel it.").format(title=self.current.title)
            )
        else:
            self.current = Job(title, work, on_done, self._deliver, can_be_cancelled)
        self._changed()

    def cancel(self) -> None:
        """Discard the running job with a message; a write is completed."""
        cancelled = self.current
        if cancelled is not None and cancelled.can_be_cancelled:
            self.current = None
            cancelled.cancel()
            self._message_sent(tr("{title}: cancelled.").format(title=cancelled.title))
            self._changed()

    def receive_outcomes(self) -> None:
        """Process the outcomes of finished jobs."""
        while not self._outcomes.empty():
            outcome = self._outcomes.get()
            if outcome.job is self.current:  # other jobs were cancelled
                self.current = None
                if outcome.failure:
                    self._failed(outcome.failure)
                else:
                    outcome.job.on_done(outcome.value)
            self._changed()

    def close(self) -> None:
        """Stop waking the session's thread; wait for a pending write."""
        self._closed = True
        if self.current is not None and self.current.can_be_cancelled:
            self.current.cancel()
        elif self.current is not None:
            self.current.join(timeout=10.0)

    def _deliver(self, outcome: JobOutcome) -> None:
        self._outcomes.put(outcome)
        if not self._closed:
            self._wake()
