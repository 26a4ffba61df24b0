"""Client of the ``serve`` command in another process."""

import subprocess
import sys

import numpy as np

from apd_viewer.commands.message_stream import read_message, write_message


class SolverClient:
    """Process of ``apd-viewer serve``, and the messages to and from it.

    Attributes
    ----------
    process : subprocess.Popen
    told : list of Message
        All that the process has sent so far.
    """

    def __init__(self):
        words = [sys.executable, "-m", "apd_viewer", "serve"]
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        self.process = subprocess.Popen(words, **pipes)
        self.told = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.stdin.close()
            self.process.wait(60)
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            pipe.close()

    def send(self, op, arrays=None, **words):
        """Send a message."""
        write_message(self.process.stdin, {"op": op, **words}, arrays or {})

    def received(self, *ops):
        """The next message of one of these ops."""
        while (message := read_message(self.process.stdout)) is not None:
            self.told.append(message)
            if message.head["op"] in ops:
                return message
        raise EOFError(self.process.stderr.read().decode())

    def answer(self, op, arrays=None, **words):
        """The answer to a message: of the same op, or an error."""
        self.send(op, arrays, **words)
        return self.received(op, "error")

    def last_frame(self):
        """The last frame of a motion, asking for one after the other."""
        while True:
            message = self.answer("frame")
            if message.head["op"] == "error" or message.head["finished"]:
                return message


def opening_arrays(mesh, base, *handles):
    """Arrays of the op ``open`` from those of a mesh, its base and its handles."""
    fixed = np.concatenate([base, *handles])
    numbers = np.repeat(np.arange(len(handles) + 1), [len(base), *map(len, handles)])
    V, F = (np.ascontiguousarray(array) for array in (mesh.V, mesh.F))
    return {"V": V, "F": F, "fixed": fixed.astype(np.int64), "handle": numbers.astype(np.int64)}
