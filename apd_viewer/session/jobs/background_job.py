"""Work on a thread of its own, one piece at a time: opening or writing a file."""

from __future__ import annotations

import logging
import queue
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.language import tr

_LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class JobOutcome:
    """How an job ended: ``value`` is what it returned, or ``failure`` says why it did not."""

    job: Job
    value: Any = None
    failure: str | None = None


class Job:
    """Runs ``work()`` on a thread and hands its Outcome to ``deliver``, called on that thread.

    Parameters
    ----------
    title : str
        What is being done, for people: "Opening bunny.obj".
    work : callable
    done : callable
        What the owner does with the value, on the owner's thread. Not called from here.
    deliver : callable
    can_be_cancelled : bool
        Whether the owner may forget it: what writes is to be whole.
    """

    def __init__(
        self,
        title: str,
        work: Callable[[], Any],
        done: Callable[[Any], object],
        deliver: Callable[[JobOutcome], None],
        can_be_cancelled: bool = True,
    ) -> None:
        self.title = title
        self.can_be_cancelled = can_be_cancelled
        self.done = done
        self._work = work
        self._deliver = deliver
        self._thread = threading.Thread(target=self._run, name=title, daemon=True)
        self._thread.start()

    def join(self, timeout: float | None = None) -> None:
        """Wait until the outcome has been delivered."""
        self._thread.join(timeout)

    def _run(self) -> None:
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
    """The job under way, if there is one, and how those that have ended did.

    Parameters
    ----------
    wake : callable
        Called on the job's thread when there is something to receive.
    failed : callable
        ``failed(sentence)``, called on the owner's thread.
    told : callable
        ``told(sentence)``, called on the owner's thread when a job was cancelled.
    changed : callable
        Called on the owner's thread when a job may have begun or ended.
    """

    def __init__(
        self,
        wake: Callable[[], object],
        failed: Callable[[str], object],
        told: Callable[[str], object],
        changed: Callable[[], object],
    ) -> None:
        self.current: Job | None = None
        self._wake = wake
        self._failed = failed
        self._told = told
        self._changed = changed
        self._outcomes: queue.SimpleQueue[JobOutcome] = queue.SimpleQueue()
        self._closed = False

    def run(
        self,
        title: str,
        work: Callable[[], object],
        done: Callable[..., object],
        can_be_cancelled: bool = True,
    ) -> None:
        """Begin to ``work()``, and call ``done`` with its value when that is received; one at a time."""
        if self.current is not None:
            self._failed(
                tr("{title} is not finished; wait for it or cancel it.").format(title=self.current.title)
            )
        else:
            self.current = Job(title, work, done, self._deliver, can_be_cancelled)
        self._changed()

    def cancel(self) -> None:
        """Forget the job under way, and say so; one that writes is left to finish, whole."""
        cancelled = self.current
        if cancelled is not None and cancelled.can_be_cancelled:
            self.current = None
            self._told(tr("{title}: cancelled.").format(title=cancelled.title))
            self._changed()

    def receive(self) -> None:
        """Pass on the results that have come."""
        while not self._outcomes.empty():
            outcome = self._outcomes.get()
            if outcome.job is self.current:  # otherwise it was cancelled
                self.current = None
                if outcome.failure:
                    self._failed(outcome.failure)
                else:
                    outcome.job.done(outcome.value)
            self._changed()

    def close(self) -> None:
        """Wake nobody any more, and wait for what must not be left half done."""
        self._closed = True
        if self.current is not None and not self.current.can_be_cancelled:
            self.current.join(timeout=10.0)

    def _deliver(self, outcome: JobOutcome) -> None:
        self._outcomes.put(outcome)
        if not self._closed:
            self._wake()
