"""Child processes: start, messages, end, restart, and a log of the final output."""

import contextlib
import logging
import os
import subprocess
import sys
import threading
from collections import deque
from typing import BinaryIO, Protocol, cast

import numpy as np

from apd_viewer.session.processes import array_pipe

_log = logging.getLogger(__name__)

# Not multiprocessing and not -m: neither the user's script nor modules in the current folder are imported.
# Output printed by libraries goes to standard error, never between the replies.
START_SCRIPT = """
import os, sys
replies = os.dup(1)
os.dup2(2, 1)
sys.path[:] = sys.argv[2:]
from apd_viewer.session.processes.child_boot import set_up_process
set_up_process(parent_pid=int(sys.argv[1]))
from apd_viewer.session.{module} import main
main(replies)
"""
# By default glibc returns the memory of every large array to the system and fetches it again.
_KEEP_MEMORY = {"MALLOC_MMAP_THRESHOLD_": str(1 << 30), "MALLOC_TRIM_THRESHOLD_": str(1 << 31)}
_LINES, _LINE_LENGTH = 40, 300  # maximum number of lines of final output kept, and characters per line
_GRACE = 1.0  # seconds for a process to exit by itself
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # exists only on Windows


class Process(Protocol):
    """Subset of Popen used here; ``stderr`` may be None."""

    pid: int
    stdin: BinaryIO
    stdout: BinaryIO
    stderr: BinaryIO | None

    def kill(self) -> None:
        """Kill the process."""

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the process to end and return its exit code; raises TimeoutExpired."""


class ChildProcess:
    """Child process exchanging messages with this process.

    The exit code and the last lines of the standard error of one that fails are logged.

    One thread at a time may call each method; :meth:`kill` may be called by any thread at any time.

    Parameters
    ----------
    title : str
        For the log.
    script : str
        Script of the process, made of START_SCRIPT.
    """

    def __init__(self, title: str, script: str) -> None:
        self.title = title
        self._script = script
        self._process: Process | None = None
        self._killed = self._failed = False
        self._last_words: deque[str] = deque(maxlen=_LINES)
        self._error_reader: threading.Thread | None = None

    @property
    def pid(self) -> int | None:
        """Process number; None before :meth:`start` and after :meth:`end`."""
        return self._process.pid if self._process else None

    @property
    def is_killed(self) -> bool:
        """True once :meth:`kill` has been called, until the next :meth:`start`."""
        return self._killed

    def start(self) -> None:
        """Start the process; raises OSError on failure."""
        self._killed = self._failed = False
        self._last_words.clear()
        try:
            self._process = process = self._spawn()
        except OSError as error:
            _log.error("The %s process cannot be started: %s", self.title, error)
            raise
        if process.stderr is not None:
            self._error_reader = threading.Thread(
                target=self._read_errors, args=(process.stderr,), name=f"{self.title} errors", daemon=True
            )
            self._error_reader.start()

    def send_messages(self, *messages: bytes | np.ndarray) -> bool:
        """Send messages; False if the process has ended."""
        with contextlib.suppress(OSError, ValueError):
            if self._process is not None:
                for message in messages:
                    array_pipe.write_message(self._process.stdin, message)
                return True
        self._failed = not self._killed
        return False

    def receive_message(self) -> bytes | None:
        """Wait for a message; None if the process has ended."""
        with contextlib.suppress(OSError, ValueError):
            if self._process is not None:
                message = array_pipe.read_message(self._process.stdout)
                if message is not None:
                    return message
        self._failed = not self._killed
        return None

    def kill(self) -> None:
        """Kill the process without waiting for it."""
        self._killed = True
        if (process := self._process) is not None:
            process.kill()

    def end(self) -> None:
        """End the process and wait for it; log a failure."""
        if (process := self._process) is None:
            return
        code = _exit_code(process) if self._failed else None
        process.kill()
        process.wait()
        self._process = None
        with contextlib.suppress(OSError):  # unsent messages are lost
            process.stdin.close()
        process.stdout.close()
        if self._error_reader is not None:
            self._error_reader.join(_GRACE)
        if self._failed:
            words = "\n".join(self._last_words)
            _log.error("The %s process ended with exit code %s. Its last words:\n%s", self.title, code, words)

    def restart(self) -> None:
        """End the process, if there is one, and start another; raises OSError."""
        self.end()
        self.start()

    def _spawn(self) -> Process:
        process = subprocess.Popen(
            [sys.executable, "-c", self._script, str(os.getpid()), *sys.path],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            creationflags=_FLAGS,
            env={**os.environ, **_KEEP_MEMORY},
        )
        return cast("Process", process)

    def _read_errors(self, errors: BinaryIO) -> None:
        """Copy standard error to the log and that of this process; keep its last lines."""
        with errors:
            for line in errors:
                words = line.decode(errors="replace").rstrip()[:_LINE_LENGTH]
                self._last_words.append(words)
                _log.info("The %s process says: %s", self.title, words)
                if sys.__stderr__ is not None:  # None in a program without a console
                    with contextlib.suppress(OSError, ValueError):
                        os.write(sys.__stderr__.fileno(), line)


def _exit_code(process: Process) -> int | None:
    """Exit code of a process about to exit by itself; None if it does not."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        return process.wait(_GRACE)
    return None
