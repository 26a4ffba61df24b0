"""Main function of the solver process.

A thread reads, so that the solver finds the newest request between two iterations. The process has nothing to
save: it ends at once with its parent process.
"""

import contextlib
import logging
import os
import threading
import time
from collections.abc import Callable
from functools import partial
from logging.handlers import QueueHandler
from typing import BinaryIO

from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run_service
from apd_viewer.session.processes.compilation import Compilation
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.processes.request_and_reply import (
    Request,
    RequestProgress,
    RequestStage,
    SolverMessage,
)
from apd_viewer.session.processes.request_solver import RequestSolver
from apd_viewer.session.processes.shared_memory import untrack_shared_memory

BEAT = 1.0  # seconds between activity reports
_LEAST_SPENT = 0.001  # CPU seconds per report that count as work; even a polling loop uses 20 times as much


def main(reply_descriptor: int) -> None:
    """Answer the parent process; ``reply_descriptor`` is the descriptor for replies."""
    untrack_shared_memory()
    run_service(reply_descriptor, _serve_when_idle)


def _serve_when_idle(source: BinaryIO, sink: BinaryIO) -> None:
    tell = SolverMessageSender(sink)
    logging.getLogger().addHandler(_Forwarder(tell))
    compilation = Compilation(tell)
    serve(source, tell, lambda: os._exit(0), compilation.run)


class SolverMessageSender:
    """Thread-safe sender of messages to the parent process."""

    def __init__(self, sink: BinaryIO) -> None:
        self._sink = sink
        self._one_at_a_time = threading.Lock()

    def __call__(self, message: SolverMessage) -> None:
        """Send a message, with requests named by their numbers."""
        # A write error means that the parent process is gone; the source of requests ends as well.
        with self._one_at_a_time, contextlib.suppress(OSError, ValueError):
            array_pipe.write_message(self._sink, array_pipe.pickled_value(message, _request_number))


def _request_number(thing: object) -> int | None:
    return thing.number if isinstance(thing, Request) else None


class _Heartbeat:
    """Thread that reports every second that the process is working.

    A process waiting in vain uses no processor time.
    """

    def __init__(self, tell: SolverMessageSender, factoring: Callable[[], bool]) -> None:
        self._tell, self._factoring = tell, factoring
        self._beats, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="heartbeat", daemon=True)
        self._thread.start()

    def send_message(self, message: SolverMessage) -> None:
        """Send a message, and report activity from a request until its answer."""
        self._tell(message)
        stage = message.stage if isinstance(message, RequestProgress) else None
        if stage is RequestStage.TURNED_TO:
            self._beats.set()
        elif stage is RequestStage.ANSWERED:
            self._beats.clear()

    def run_idle_work(self, work: Callable[[Callable[[], bool]], object], called: Callable[[], bool]) -> None:
        """Run idle work while reporting activity, since a request may be waiting."""
        self._beats.set()
        work(called)
        self._beats.clear()

    def end(self) -> None:
        """Stop the thread."""
        self._ended.set()
        self._beats.set()
        self._thread.join()

    def _run(self) -> None:
        before = 0.0
        while self._beats.wait() and not self._ended.wait(BEAT):
            spent = time.process_time() - time.thread_time()
            if spent - before > _LEAST_SPENT or self._factoring():
                self._tell(RequestProgress(RequestStage.UNDER_WAY))
            before = spent


class _Forwarder(QueueHandler):
    """Log handler forwarding records to the parent process."""

    def __init__(self, tell: SolverMessageSender) -> None:
        super().__init__(queue=None)  # type: ignore[arg-type]
        self._tell = tell

    def enqueue(self, record: logging.LogRecord) -> None:
        """Send a record, prepared for pickling."""
        self._tell(record)


def serve(
    source: BinaryIO,
    send: SolverMessageSender,
    on_source_end: Callable[[], object] = lambda: None,
    when_idle: Callable[[Callable[[], bool]], object] = lambda _: None,
) -> None:
    """Answer the requests from ``source`` on this thread until it ends.

    Parameters
    ----------
    source : binary file
    on_source_end : callable
        Called on another thread as soon as ``source`` has ended.
    when_idle : callable
        Called when there is nothing to do: see :meth:`RequestSolver.run`.
    """
    requests: Mailbox[Request] = Mailbox()

    def receive() -> None:
        unpacker = array_pipe.ArrayUnpacker()
        try:
            while (message := array_pipe.read_message(source)) is not None:
                request: Request = unpacker.unpacked_value(message)
                send(RequestProgress(RequestStage.RECEIVED, request))
                requests.put(request)
        finally:  # the parent process, and with it the log, is gone
            requests.close()
            on_source_end()

    reader = threading.Thread(target=receive, name="requests", daemon=True)
    reader.start()
    solver: RequestSolver
    heartbeat = _Heartbeat(send, lambda: solver.is_factoring)
    solver = RequestSolver(requests, heartbeat.send_message)
    solver.run(partial(heartbeat.run_idle_work, when_idle))
    heartbeat.end()
    reader.join()
