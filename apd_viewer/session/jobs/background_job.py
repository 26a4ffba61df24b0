"""Work on a thread of its own, one piece at a time: opening or writing a file."""

from __future__ import annotations

import queue
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.language import tr


@dataclass(frozen=True, eq=False)
class Outcome:
    """How an errand ended: ``value`` is what it returned, or ``failure`` says why it did not."""

    errand: Errand
    value: Any = None
    failure: str | None = None


class Errand:
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
        deliver: Callable[[Outcome], None],
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
            outcome = Outcome(self, value=self._work())
        except InputError as error:
            outcome = Outcome(self, failure=str(error))
        except Exception as error:
            traceback.print_exc()
            outcome = Outcome(
                self,
                failure=tr("{title} failed ({reason}).").format(
                    title=self.title, reason=str(error) or type(error).__name__
                ),
            )
        self._deliver(outcome)


class Errands:
    """The errand under way, if there is one, and how those that have ended did.

    Parameters
    ----------
    wake : callable
        Called on the errand's thread when there is something to receive.
    failed : callable
        ``failed(sentence)``, called on the owner's thread.
    """

    def __init__(self, wake: Callable[[], object], failed: Callable[[str], object]) -> None:
        self.current: Errand | None = None
        self._wake = wake
        self._failed = failed
        self._outcomes: queue.SimpleQueue[Outcome] = queue.SimpleQueue()
        self._closed = False

    def send(
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
            self.current = Errand(title, work, done, self._deliver, can_be_cancelled)

    def cancel(self) -> Errand | None:
        """Forget the errand under way and return it; one that cannot be cancelled goes on."""
        if self.current is None or not self.current.can_be_cancelled:
            return None
        cancelled, self.current = self.current, None
        return cancelled

    def receive(self) -> bool:
        """Do what is to be done with a value that has come; False if nothing has."""
        if self._outcomes.empty():
            return False
        outcome = self._outcomes.get()
        if outcome.errand is self.current:  # otherwise it was cancelled
            self.current = None
            if outcome.failure:
                self._failed(outcome.failure)
            else:
                outcome.errand.done(outcome.value)
        return True

    def close(self) -> None:
        """Wake nobody any more, and wait for what must not be left half done."""
        self._closed = True
        if self.current is not None and not self.current.can_be_cancelled:
            self.current.join(timeout=10.0)

    def _deliver(self, outcome: Outcome) -> None:
        self._outcomes.put(outcome)
        if not self._closed:
            self._wake()
