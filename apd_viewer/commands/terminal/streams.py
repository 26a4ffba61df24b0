"""Standard streams and termination signals of a command."""

import io
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, BinaryIO

if sys.platform == "linux":
    import fcntl

from apd_viewer.errors import InputError
from apd_viewer.language import tr

# Bytes of the pipe of messages, the most that Linux allows by default: the solver need not wait for the other
# program to take a shape of 40,000 vertices.
_PIPE = 1 << 20
_ENDING = "SIGTERM", "SIGHUP", "SIGBREAK"  # termination signals, not all of which exist on every system


def prepare_streams() -> None:
    """Make the standard streams safe for any text.

    Unencodable characters are written as question marks. A closed stream is replaced by one that discards its
    output: otherwise the next opened file would get its descriptor.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


@contextmanager
def message_streams() -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Standard input and output for messages alone; raises InputError on a terminal."""
    if sys.stdin.isatty():
        raise InputError(tr("Another program has to start this command: it takes messages from a pipe."))
    # Whatever a library prints must not come between the messages.
    with os.fdopen(os.dup(1), "wb") as sink:
        os.dup2(2, 1)
        if sys.platform == "linux":
            with suppress(OSError):  # not a pipe, or this user's pipes have all the memory that they may have
                fcntl.fcntl(sink, fcntl.F_SETPIPE_SZ, _PIPE)
        yield sys.stdin.buffer, sink


def discard_output() -> None:
    """Discard all further standard output."""
    with suppress(OSError):  # a stream of an embedding program may have no descriptor
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def print_error(sentence: str) -> None:
    """Write a sentence to the standard error, if possible."""
    with suppress(OSError):
        print(sentence, file=sys.stderr)


@contextmanager
def exit_on_signals() -> Iterator[None]:
    """Let SIGTERM and similar signals raise SystemExit, so that clean-up code runs.

    Signals with another handler, or ignored as by nohup, are left unchanged.
    """
    numbers = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        numbers = []
    numbers = [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]

    def end(number: int, _: Any) -> None:
        for each in numbers:
            signal.signal(each, signal.SIG_IGN)
        raise SystemExit(128 + number)

    for number in numbers:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_DFL)
