"""Detection of unresponsive worker processes."""

import threading
from collections.abc import Callable

TICK = 1.0  # seconds between checks


class SilenceWatch:
    """Thread detecting a lack of messages while an answer is pending.

    It counts seconds in which it ran itself, so that a computer that slept has missed nothing. While nothing
    is awaited it rests.

    Parameters
    ----------
    silence_changed : callable
        ``silence_changed(seconds)``, called on a thread of the watch or of who hears: the seconds of silence
        so far when it is noticed, and 0 when it is over; must only pass it on.
    first_patience : int
        Seconds that are allowed until the first word, at least.
    """

    def __init__(self, silence_changed: Callable[[int], object], first_patience: int) -> None:
        self._changed, self._at_start = silence_changed, first_patience
        self._patience = 0
        self._condition = threading.Condition()
        self._awaited = self._answered = 0
        self._quiet = 0
        self._silent = self._closed = False
        self._thread = threading.Thread(target=self._run, name="silence", daemon=True)
        self._thread.start()

    def expect_answer(self, number: int, patience: int) -> None:
        """Start waiting for answer ``number``; any message counts as a sign of life."""
        with self._condition:
            if not self._awaits:
                self._quiet = 0
                self._condition.notify()
            self._awaited, self._patience = number, patience

    def note_message(self, answer: int = 0) -> None:
        """Register a message, and the number of an answer completed by it."""
        with self._condition:
            self._at_start = self._quiet = 0
            self._answered = max(answer, self._answered)
            self._break_silence()

    def close(self) -> None:
        """Stop the watch thread."""
        with self._condition:
            self._closed = True
            self._break_silence()
            self._condition.notify()
        self._thread.join()

    @property
    def _awaits(self) -> bool:
        return self._answered < self._awaited

    def _break_silence(self) -> None:
        if self._silent:
            self._silent = False
            self._condition.notify()
            self._changed(0)

    def _run(self) -> None:
        with self._condition:
            while not self._closed:
                if self._silent or not self._awaits:
                    self._condition.wait()
                elif not self._condition.wait(TICK):
                    self._quiet += 1
                    if self._quiet >= max(self._patience, self._at_start) and self._awaits:
                        self._silent = True
                        self._changed(self._quiet)
