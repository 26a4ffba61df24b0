"""Deferred signal handlers, so that no state is left half-changed.

Python runs signal handlers in the main thread, between any two lines, and their exceptions interrupt the
current operation. A computation in another thread would not be interrupted, but takes two thread switches
per iteration, and loses settings of the caller's thread: number of cores, profiler, NumPy's warnings.
"""

from __future__ import annotations

import threading

# The functions behind the module signal, without its enum look-ups: 0.5 us a call instead of 8.
from _signal import getsignal, signal
from contextlib import ExitStack
from signal import valid_signals
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

_SIGNALS = sorted(valid_signals())


class DeferredSignals:
    """Context to defer signal handlers until its end; nestable.

    Each handler is called once, in the main thread, after 3 us of overhead. Other threads run no handlers.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._handlers: dict[int, Callable[..., Any]] = {}
        self._came: dict[int, FrameType | None] = {}
        self._later = self._note  # a single bound method, to be recognised by identity

    def __enter__(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return
        # If a handler raises before the last line, the only effect is that some signals pass through _note.
        if not self._depth:
            for number in _SIGNALS:
                handler = getsignal(number)
                if callable(handler) and handler is not self._later:
                    self._handlers[number] = handler
                    signal(number, self._later)
        self._depth += 1

    def __exit__(self, *_: object) -> None:
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth -= 1
        if self._depth:
            return
        if not self._came:
            self._restore()
            return
        with ExitStack() as last:  # calls all handlers, even if one of them raises
            last.callback(self._restore)
            for number in list(self._came):
                last.callback(self._handle, number)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._came[number] = frame
        if not self._depth:
            self._handle(number)

    def _handle(self, number: int) -> None:
        if number in self._came:
            self._handlers[number](number, self._came.pop(number))

    def _restore(self) -> None:
        for number, handler in self._handlers.items():
            if getsignal(number) is self._later:
                signal(number, handler)


DEFERRED_SIGNALS = DeferredSignals()
