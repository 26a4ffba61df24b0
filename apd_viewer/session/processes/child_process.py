"""Processes of our own: how one is started, and what memory it keeps."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
from typing import BinaryIO, Protocol, cast

# Not multiprocessing and not -m: neither the user's script nor what lies in the current folder is imported.
# What libraries print goes to the standard error where there is one, and never between the answers.
START = """
import os, sys
replies = os.dup(1)
try:
    os.dup2(2, 1)
except OSError:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
sys.path[:] = sys.argv[1:]
from apd_viewer.session.{module} import main
main(replies)
"""
# Large arrays come and go here. glibc would give their memory back each time, and have it cleared anew.
_KEEP_MEMORY = {"MALLOC_MMAP_THRESHOLD_": str(1 << 30), "MALLOC_TRIM_THRESHOLD_": str(1 << 31)}
# The same of a process that shall not keep more than this when something large has gone; names are numbers.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = (-1, 1 << 28), (-3, 1 << 25)
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # on Windows, and there only


class Process(Protocol):
    """What is needed of a process: two pipes, and an end."""

    stdin: BinaryIO
    stdout: BinaryIO

    def kill(self) -> None:
        """End it at once."""

    def wait(self) -> int:
        """Wait until it has ended."""


def started(script: str) -> Process:
    """Start a process that runs ``script``; raises OSError if it cannot be started."""
    command = [sys.executable, "-c", script, *sys.path]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        creationflags=_FLAGS,
        env={**os.environ, **_KEEP_MEMORY},
    )
    return cast("Process", process)


def keep_freed_memory() -> None:
    """Have this process keep what it frees for the next frame, where the C library is glibc.

    By default it depends on the order of what came before whether all that a frame needs is given back and
    fetched anew: for 164,000 vertices 16,000 pages, and a third of the time of the frame.
    """
    if sys.platform.startswith("linux") and (mallopt := getattr(ctypes.CDLL(None), "mallopt", None)):
        for option in (_TRIM_THRESHOLD, _MMAP_THRESHOLD):
            mallopt(*option)


def leave_interrupts_to_the_owner() -> None:
    """Have Ctrl+C end the owner, and this process only with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
