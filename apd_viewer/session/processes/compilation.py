"""Compilation of the kernels at the first start on a computer.

Numba compiles one kernel at a time per process. At its start, the window thus has other processes compile
the kernels of a first drag into the shared cache.
"""

import contextlib
from collections.abc import Callable
from typing import BinaryIO

from apd_viewer.geometry.warmup import SECTIONS, report_compilations, warm_up
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run_service
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess
from apd_viewer.session.processes.request_and_reply import CompilationProgress

# The window and the solver have priority: on two cores the window would otherwise be ready twice as late.
_NICENESS = 10
# Largest fraction reported before the end, since uncounted kernels take time, too.
_NEARLY_ALL = 0.99
_START = START_SCRIPT.format(module="processes.compilation")


class Compilation:
    """Kernel compilation in the solver process.

    Parameters
    ----------
    send : callable
        Called with messages on how far it is.
    """

    def __init__(self, send: Callable[[CompilationProgress], object]) -> None:
        self._tell = send
        self._stop = report_compilations(lambda fraction: self._report(min(fraction, _NEARLY_ALL)))

    def run(self, is_interrupted: Callable[[], bool]) -> None:
        """Compile until ``is_interrupted()``; errors appear in later requests."""
        with contextlib.suppress(Exception):
            warm_up(is_cancelled=is_interrupted)
        if not is_interrupted():
            self._stop()
            self._report(1.0)

    def _report(self, fraction: float) -> None:
        self._tell(CompilationProgress(fraction))


class CompilerProcesses:
    """Processes compiling the ``SECTIONS`` of kernels in parallel.

    On Linux they end with the thread that starts them.
    """

    def __init__(self) -> None:
        self._processes: list[ChildProcess] = []

    def start(self) -> None:
        """Start the processes once; on failure the solver compiles by itself."""
        if not self._processes:
            self._processes = [ChildProcess("compiler", _START) for _ in SECTIONS]
            for process, part in zip(self._processes, SECTIONS, strict=True):
                with contextlib.suppress(OSError):
                    process.start()
                    process.send_messages(part.encode())

    def end(self) -> None:
        """Kill the processes."""
        for process in self._processes:
            process.kill()
            process.end()


def main(reply_descriptor: int) -> None:
    """Answer the parent process; ``reply_descriptor`` is the descriptor for replies."""
    run_service(reply_descriptor, serve, _NICENESS)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Compile the section of kernels named by ``source``, and confirm it."""
    name = array_pipe.read_message(source)
    if name is not None:
        warm_up(name.decode())
        array_pipe.write_message(sink, b"")
