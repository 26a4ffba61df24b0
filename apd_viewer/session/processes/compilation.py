"""Compilation of the kernels at the first start on a computer.

Numba compiles one kernel at a time in a process, whatever its threads. So other processes compile some of
them beside the solver, into the cache of all.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import BinaryIO

from apd_viewer.geometry.warmup import PARTS, tell_of_compiling, warm_up
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run
from apd_viewer.session.processes.child_process import START, ChildProcess
from apd_viewer.session.processes.messages import Compiling, Message

_START = START.format(module="processes.compilation")


class Compilation:
    """Compilation in the solver's process.

    Parameters
    ----------
    tell : callable
        Called with messages on how far it is.
    """

    def __init__(self, tell: Callable[[Message], object]) -> None:
        self._tell = tell
        self._beside: list[ChildProcess] = []
        tell_of_compiling(self._go_on)

    def run(self, called: Callable[[], bool]) -> None:
        """Compile until ``called()``; errors are left to the requests."""
        with contextlib.suppress(Exception):
            warm_up(called)
        if not called():
            self._end()

    def _go_on(self, share: float) -> None:
        # Nothing is cached, and a drag may come: other processes compile other parts meanwhile.
        if not self._beside:
            self._beside = [ChildProcess("compiler", _START) for _ in PARTS]
            for process, part in zip(self._beside, PARTS, strict=True):
                with contextlib.suppress(OSError):
                    process.start()
                    process.send(part.encode())
        self._tell(Message(0, Compiling(share)))

    def _end(self) -> None:
        for process in self._beside:
            process.end()
        self._tell(Message(0, Compiling(1.0)))


def main(replies: int) -> None:
    """Serve the solver's process; ``replies`` is the file descriptor for the answer."""
    run(replies, serve)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Compile the part named by ``source``, and say so."""
    name = array_pipe.read(source)
    if name is not None:
        PARTS[name.decode()]()
        array_pipe.write(sink, b"")
