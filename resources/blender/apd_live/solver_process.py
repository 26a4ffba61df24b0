# SPDX-License-Identifier: GPL-3.0-or-later
"""Process of the solver: the newest message to it, and the newest one from it."""

import os
import shutil
import subprocess
import sys
import threading
import time
from contextlib import suppress
from importlib import metadata

import numpy as np

from .message_stream import MessageError, read_message, write_message

PROTOCOL = 1
# Of Blender's own Python, which the program's must not meet.
_FOREIGN = ("PYTHONHOME", "PYTHONPATH", "PYTHONNOUSERSITE", "LD_LIBRARY_PATH")


class SolverError(Exception):
    """Sentence of the solver, or about it."""


def solver_command(named=""):
    """Words that start the solver: a named program, this Python's own, or one that is found.

    Raises SolverError with a sentence if there is none.
    """
    if named:
        return [named, "serve"]
    if any(metadata.distributions(name="apd-viewer")):  # in the wheels of this extension
        return [sys.executable, "-m", "apd_viewer", "serve"]
    for program, words in (("apd-viewer", ["serve"]), ("uvx", ["apd-viewer", "serve"])):
        if path := shutil.which(program):
            return [path, *words]
    raise SolverError(
        "The program apd-viewer was not found. Install it with “pip install apd-viewer”, or name it in the "
        "preferences of this add-on."
    )


class SolverProcess:
    """Solver in another process; no method waits for it but ``wait_for``.

    A thread reads its answers. It touches nothing of Blender: the thread of the window takes them.

    Parameters
    ----------
    command : sequence of str

    Attributes
    ----------
    process : subprocess.Popen
    version : str
        Of the program, once it has been greeted.
    """

    def __init__(self, command):
        own_python = command[0] == sys.executable
        kept = {name: text for name, text in os.environ.items() if own_python or name not in _FOREIGN}
        if own_python:
            kept["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))
        hidden = {"creationflags": subprocess.CREATE_NO_WINDOW} if sys.platform == "win32" else {}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        try:
            self.process = subprocess.Popen(command, env=kept, **pipes, **hidden)
        except OSError as error:
            raise SolverError(f"{command[0]} cannot be started: {error.strerror or error}.") from error
        self._arrived = threading.Condition()
        self._answers = []
        self._number = 0
        self.version = ""
        self._thread = threading.Thread(target=self._read, name="solver", daemon=True)
        self._thread.start()

    @property
    def is_alive(self):
        """True while the process runs."""
        return self.process.poll() is None

    def send(self, op, arrays=None, **words):
        """Send a message, and return its number. Raises SolverError if the process has ended."""
        self._number += 1
        try:
            write_message(self.process.stdin, {"op": op, "id": self._number, **words}, arrays or {})
        except (OSError, ValueError) as error:
            raise SolverError("The solver has ended; start again.") from error
        return self._number

    def taken_answers(self, since=0):
        """Answers that have arrived since the last call, to messages from number ``since`` on.

        Raises SolverError after the last one.
        """
        with self._arrived:
            answers, self._answers = self._answers, []
        if not answers and not self._thread.is_alive():
            raise SolverError("The solver has ended; start again.")
        return [answer for answer in answers if (answer.head["id"] or since) >= since]

    def wait_for(self, op, since=0, seconds=600.0):
        """The next answer of an op to a message from number ``since`` on, waited for.

        Raises SolverError for an error, or if there is none.
        """
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            with self._arrived:
                self._arrived.wait_for(lambda: self._answers or not self._thread.is_alive(), 1.0)
            for answer in self.taken_answers(since):
                if answer.head["op"] == "error":
                    raise SolverError(answer.head["message"])
                if answer.head["op"] == op:
                    return answer
        raise SolverError("The solver does not answer; start again.")

    def greet(self):
        """Learn the version; raises SolverError with a sentence if it does not fit."""
        self.send("hello", protocol=PROTOCOL)
        self.version = self.wait_for("hello").head["version"]

    def close(self):
        """End the process, which has nothing to save."""
        with suppress(OSError):  # it has ended in the middle of a message
            self.process.stdin.close()
        try:
            self.process.wait(5.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._thread.join()
        self.process.stdout.close()

    def _read(self):
        try:
            while (answer := read_message(self.process.stdout)) is not None:
                with self._arrived:
                    # Progress and shapes that nobody has taken are old news.
                    if answer.head["op"] in ("progress", "frame"):
                        self._answers = [
                            each for each in self._answers if each.head["op"] != answer.head["op"]
                        ]
                    self._answers.append(answer)
                    self._arrived.notify()
        except (MessageError, OSError, ValueError):
            pass
        finally:
            with self._arrived:
                self._arrived.notify()


def opening_arrays(V, F, base, handles):
    """Arrays of the message that opens a mesh; ``handles`` is a sequence of vertex arrays."""
    fixed = np.concatenate([base, *handles]).astype(np.int64)
    numbers = np.repeat(np.arange(len(handles) + 1), [len(base), *map(len, handles)]).astype(np.int64)
    return {"V": V, "F": F, "fixed": fixed, "handle": numbers}
