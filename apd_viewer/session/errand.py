"""One piece of work on a thread of its own: opening or writing a file."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from apd_viewer.errors import InputError


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
    """

    def __init__(
        self,
        title: str,
        work: Callable[[], Any],
        done: Callable[[Any], None],
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
            outcome = Outcome(self, failure=f"{self.title} failed ({str(error) or type(error).__name__}).")
        self._deliver(outcome)
