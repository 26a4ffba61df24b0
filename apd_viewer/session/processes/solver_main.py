"""Main function of the solver process.

A thread reads, so that the solver finds the newest order between two iterations. Nothing here is worth
saving: the process ends at once when its owner has gone, whatever it is doing.
"""

from __future__ import annotations

import contextlib
import logging
import os
import threading
import time
from collections.abc import Callable
from functools import partial
from logging.handlers import QueueHandler
from typing import BinaryIO

from apd_viewer.session.jobs.mailbox import Mailbox
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run
from apd_viewer.session.processes.compilation import Compilation
from apd_viewer.session.processes.messages import Message, Order, OrderStage, packed
from apd_viewer.session.processes.shared_memory import leave_blocks_to_their_owner
from apd_viewer.session.processes.solver import Solver

_BEAT = 1.0  # s
_LEAST_SPENT = 0.001  # s of the processor in a beat; a loop that waits for a flag spends 20 times as much


def main(replies: int) -> None:
    """Serve the owner; ``replies`` is the file descriptor for messages."""
    leave_blocks_to_their_owner()
    run(replies, _serve_at_leisure)


def _serve_at_leisure(source: BinaryIO, sink: BinaryIO) -> None:
    tell = Teller(sink)
    logging.getLogger().addHandler(_Forwarder(tell))
    compilation = Compilation(tell)
    serve(source, tell, lambda: os._exit(0), compilation.run)


class Teller:
    """Thread-safe sending of messages to the owner."""

    def __init__(self, sink: BinaryIO) -> None:
        self._sink = sink
        self._one_at_a_time = threading.Lock()

    def __call__(self, message: Message | logging.LogRecord) -> None:
        """Send a message."""
        # An owner that stopped listening is gone: the source of requests ends as well.
        with self._one_at_a_time, contextlib.suppress(OSError, ValueError):
            array_pipe.write(self._sink, packed(message))


class _Pulse:
    """Tells the owner every second of an order under way, or of work at leisure.

    A process that waits for what never comes spends no time of the processor.
    """

    def __init__(self, tell: Teller, factoring: Callable[[], bool]) -> None:
        self._tell, self._factoring = tell, factoring
        self._beats, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="pulse", daemon=True)
        self._thread.start()

    def tell(self, message: Message) -> None:
        """Send a message of the solver, beating from an order to its answer."""
        self._tell(message)
        if message.content is OrderStage.TURNED_TO:
            self._beats.set()
        elif message.content is OrderStage.ANSWERED:
            self._beats.clear()

    def during(self, work: Callable[[Callable[[], bool]], object], called: Callable[[], bool]) -> None:
        """Do some work, beating meanwhile: an order may wait for it."""
        self._beats.set()
        work(called)
        self._beats.clear()

    def end(self) -> None:
        """Beat no more."""
        self._ended.set()
        self._beats.set()
        self._thread.join()

    def _run(self) -> None:
        before = 0.0
        while self._beats.wait() and not self._ended.wait(_BEAT):
            spent = time.process_time() - time.thread_time()
            if spent - before > _LEAST_SPENT or self._factoring():
                self._tell(Message(0, OrderStage.UNDER_WAY))
            before = spent


class _Forwarder(QueueHandler):
    """Log handler forwarding records to the owner."""

    def __init__(self, tell: Teller) -> None:
        super().__init__(queue=None)  # type: ignore[arg-type]
        self._tell = tell

    def enqueue(self, record: logging.LogRecord) -> None:
        """Send a record, prepared for pickling."""
        self._tell(record)


def serve(
    source: BinaryIO,
    tell: Teller,
    abandoned: Callable[[], object] = lambda: None,
    at_leisure: Callable[[Callable[[], bool]], object] = lambda _: None,
) -> None:
    """Answer the orders from ``source`` on this thread until it ends.

    Parameters
    ----------
    source : binary file
    tell : Teller
    abandoned : callable
        Called on another thread as soon as ``source`` has ended.
    at_leisure : callable
        Called when there is nothing to do: see :meth:`Solver.run`.
    """
    orders: Mailbox[Order] = Mailbox()

    def receive() -> None:
        unpacker = array_pipe.Unpacker()
        try:
            while (message := array_pipe.read(source)) is not None:
                order: Order = unpacker.unpacked(message)
                tell(Message(order.number, OrderStage.RECEIVED))
                orders.put(order)
        finally:  # without an owner there is nothing to log to
            orders.close()
            abandoned()

    reader = threading.Thread(target=receive, name="orders", daemon=True)
    reader.start()
    solver: Solver
    pulse = _Pulse(tell, lambda: solver.factoring)
    solver = Solver(orders, pulse.tell)
    solver.run(partial(pulse.during, at_leisure))
    pulse.end()
    reader.join()
