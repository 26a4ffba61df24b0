"""Mailbox of one value between two threads; the newest wins."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Mailbox of one complete value; a newer one replaces it without loss."""

    def __init__(self) -> None:
        self._filled = threading.Condition()
        self._value: T | None = None
        self._closed = False

    def put(self, value: T) -> bool:
        """Leave ``value``; True if the mailbox was empty and the taker must be woken."""
        with self._filled:
            was_empty = self._value is None
            self._value = value
            self._filled.notify()
        return was_empty

    def offer(self, value: T) -> bool:
        """Put ``value`` if the mailbox is empty; True if so."""
        with self._filled:
            if self._value is not None:
                return False
            self._value = value
            self._filled.notify()
        return True

    def take(self) -> T | None:
        """Take the value; None if there is none."""
        with self._filled:
            value, self._value = self._value, None
        return value

    def wait(self) -> T | None:
        """Take the value as soon as there is one; None once the mailbox is closed."""
        with self._filled:
            self._filled.wait_for(lambda: self.is_ready)
            value, self._value = self._value, None
        return None if self._closed else value

    def wait_for_value(self, seconds: float) -> bool:
        """Wait at most so many seconds for a value or the end; True if one came."""
        with self._filled:
            return self._filled.wait_for(lambda: self.is_ready, seconds)

    @property
    def is_ready(self) -> bool:
        """True if there is a value, or the mailbox is closed."""
        return self._value is not None or self._closed

    def close(self) -> None:
        """Wake the taker for the last time."""
        with self._filled:
            self._closed = True
            self._filled.notify()
