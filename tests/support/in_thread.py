"""The solver's process as a thread of the tests: the same pipes and messages, and nothing to wait for.

Most tests are about what is said and answered. A process takes half a second to start, and what a test
changes in the solver would not reach it; those that are about the process have a real one.
"""

import contextlib
import os
import queue
import socket
import threading
from collections.abc import Callable
from typing import Any, BinaryIO

from apd_viewer.session.processes.child_process import ChildProcess
from apd_viewer.session.processes.request_and_reply import CompilationProgress, Request
from apd_viewer.session.processes.request_solver import RequestSolver
from apd_viewer.session.processes.solver_main import SolverMessageSender, serve

NAME = "process"


class Compiler:
    """Tells the shares that a test puts into it, and keeps the solver from all else until the last one, 1."""

    def __init__(self) -> None:
        self._shares: queue.Queue[float] = queue.Queue()
        self.tell = self._shares.put

    def __call__(self, tell: SolverMessageSender) -> None:
        """Compile, as the solver would at leisure."""
        share = 0.0
        while share < 1.0:
            share = self._shares.get()
            tell(CompilationProgress(share))
        self._shares.put(share)  # for a solver that was started anew meanwhile


class LateSolver(RequestSolver):
    """Prepares for a mesh only once it is to move: most tests of a window move none.

    Then it answers first what it has left, so that it goes on as any other.
    """

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._left: Request | None = None

    def answer(self, request: Request) -> None:
        self.discard_other_mesh(request.document.mesh)
        if not (request.iterate or request.is_timed):
            self._left = request
            return
        left, self._left = self._left, None
        if left is not None and left.document.mesh is request.document.mesh:
            super().answer(left)
        super().answer(request)


class InThread(ChildProcess):
    """Serves like a process; once killed it ends after the iteration that it is in.

    It compiles nothing at leisure, unless that is done by a ``compiler``.
    """

    def __init__(self, compiler: Callable[[SolverMessageSender], object] = lambda _: None) -> None:
        super().__init__("solver", "")
        self._compiler = compiler
        self.start()

    def _spawn(self) -> "ServingThread":
        return ServingThread(self._serve_orders)

    def _serve_orders(self, source: BinaryIO, sink: BinaryIO) -> None:
        tell = SolverMessageSender(sink)
        serve(source, tell, when_idle=lambda _: self._compiler(tell))


class ServedInThread(ChildProcess):
    """Serves as the process of a ``serve`` would; once killed it ends after the answer that it is at."""

    def __init__(self, serve: Callable[[BinaryIO, BinaryIO], object], title: str, script: str) -> None:
        super().__init__(title, script)
        self._serve = serve

    def _spawn(self) -> "ServingThread":
        return ServingThread(self._serve)


class ServingThread:
    """What a ChildProcess needs of a process, done by a thread."""

    stderr = None

    def __init__(self, serve: Callable[[BinaryIO, BinaryIO], object]) -> None:
        self.pid = os.getpid()
        self._serve = serve
        ours, theirs = socket.socketpair()
        self._socket = ours
        self.stdin, self.stdout = ours.makefile("wb"), ours.makefile("rb")
        self._thread = threading.Thread(target=self._run, args=(theirs,), name=NAME)
        self._thread.start()

    def _run(self, connection: socket.socket) -> None:
        with (
            contextlib.suppress(OSError),  # an answer that nobody hears stays in the file
            connection,
            connection.makefile("rb") as source,
            connection.makefile("wb") as sink,
        ):
            self._serve(source, sink)
            connection.shutdown(socket.SHUT_RDWR)

    def kill(self) -> None:
        """Hang up, on both sides."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)

    def wait(self, _: float | None = None) -> int:
        self._thread.join()
        self._socket.close()
        return 0
