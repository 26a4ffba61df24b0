"""One-value mailbox between two threads; a new value replaces the old one."""

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Mailbox for one value; a newer value replaces an unread one."""

    def __init__(self) -> None:
        self._filled = threading.Condition()
        self._value: T | None = None
        self._closed = False

    def put(self, value: T) -> bool:
        """Store ``value``; return True if the mailbox was empty before."""
        with self._filled:
            was_empty = self._value is None
            self._value = value
            self._filled.notify()
        return was_empty

    def offer(self, value: T) -> bool:
        """Store ``value`` if the mailbox is empty; return True on success."""
        with self._filled:
            if self._value is not None:
                return False
            self._value = value
            self._filled.notify()
        return True

    def take(self) -> T | None:
        """Remove and return the value; None if empty."""
        with self._filled:
            value, self._value = self._value, None
        return value

    def wait(self) -> T | None:
        """Wait for a value and take it; None once the mailbox is closed."""
        with self._filled:
            self._filled.wait_for(lambda: self.is_ready)
            value, self._value = self._value, None
        return None if self._closed else value

    def wait_for_value(self, seconds: float) -> bool:
        """Wait up to ``seconds`` for a value or closing; return True on either."""
        with self._filled:
            return self._filled.wait_for(lambda: self.is_ready, seconds)

    @property
    def is_ready(self) -> bool:
        """True if there is a value or the mailbox is closed."""
        return self._value is not None or self._closed

    def close(self) -> None:
        """Close the mailbox and wake the waiting thread."""
        with self._filled:
            self._closed = True
            self._filled.notify()
