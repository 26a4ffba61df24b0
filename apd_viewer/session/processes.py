"""Processes of our own, and how one is started."""

from __future__ import annotations

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


def leave_interrupts_to_the_owner() -> None:
    """Have Ctrl+C end the owner, and this process only with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
