"""Set-up of every child process, including its end with the parent process."""

import contextlib
import ctypes
import faulthandler
import os
import signal
import sys
from collections.abc import Callable
from typing import BinaryIO

_DEATH_OF_THE_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def set_up_process(parent_pid: int) -> None:
    """Prepare this process to serve its parent process, before large imports.

    Parameters
    ----------
    parent_pid : int
        Number of the process that started this one.
    """
    faulthandler.enable()
    # Ctrl+C ends the parent process, and this process only with it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.stdout = sys.stderr
    # A killed parent closes our input, but native code may run for seconds before reading it. On Linux a
    # signal ends this process with the thread that started it, so that thread must live as long.
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_DEATH_OF_THE_PARENT, signal.SIGKILL)
        # Linux sends no signal if the parent was killed while this interpreter was starting.
        if os.getppid() != parent_pid:
            os._exit(0)


def run_service(
    reply_descriptor: int, serve: Callable[[BinaryIO, BinaryIO], object], niceness: int = 0
) -> None:
    """Call ``serve(source, sink)`` until the parent process closes ``source``.

    Parameters
    ----------
    reply_descriptor : int
        File descriptor of the sink.
    serve : callable
        Reads messages from ``source`` and writes messages to ``sink``; see :mod:`array_pipe`.
    niceness : int
        Greater than 0 to give other processes priority.
    """
    if hasattr(os, "nice"):
        os.nice(niceness)
    # If the parent process has died, unread messages are lost when the sink is closed.
    with contextlib.suppress(OSError), os.fdopen(reply_descriptor, "wb") as sink:
        serve(sys.stdin.buffer, sink)
