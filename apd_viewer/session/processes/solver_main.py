"""The solver's process, seen from inside: orders come by one pipe, answers go by another.

A thread reads, so that the solver finds the newest order between two iterations. Nothing here is worth
saving: the process ends at once when its owner has gone, whatever it is doing.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import sys
import threading
from collections.abc import Callable
from typing import BinaryIO

from apd_viewer.geometry.warmup import warm_up
from apd_viewer.session.jobs.mailbox import Mailbox
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_process import leave_interrupts_to_the_owner
from apd_viewer.session.processes.messages import Message, Order, Progress, Step
from apd_viewer.session.processes.shared_memory import leave_blocks_to_their_owner
from apd_viewer.session.processes.solver import Solver


def main(replies: int) -> None:
    """Serve until the standard input ends; answers go to the file descriptor ``replies``."""
    leave_interrupts_to_the_owner()
    sys.stdout = sys.stderr
    leave_blocks_to_their_owner()
    with os.fdopen(replies, "wb") as sink:
        serve(sys.stdin.buffer, sink, lambda: os._exit(0), _compile)


def serve(
    source: BinaryIO,
    sink: BinaryIO,
    abandoned: Callable[[], object] = lambda: None,
    at_leisure: Callable[[Callable[[], bool]], object] = lambda _: None,
) -> None:
    """Answer the orders that come from ``source`` until it ends, on this thread.

    Parameters
    ----------
    source, sink : binary files
    abandoned : callable
        Called on another thread as soon as ``source`` has ended.
    at_leisure : callable
        Called when there is nothing to do: see :meth:`Solver.run`.
    """
    orders: Mailbox[Order] = Mailbox()
    one_at_a_time = threading.Lock()

    def tell(message: Message) -> None:
        # Who has stopped listening has gone: the source will end as well.
        with one_at_a_time, contextlib.suppress(OSError, ValueError):
            array_pipe.write(sink, pickle.dumps(message))

    def receive() -> None:
        unpacker = array_pipe.Unpacker()
        try:
            while (message := array_pipe.read(source)) is not None:
                order: Order = unpacker.unpacked(message)
                tell(Progress(order.number, Step.RECEIVED))
                orders.put(order)
        finally:  # who cannot hear any more is of no use either
            orders.close()
            abandoned()

    reader = threading.Thread(target=receive, name="orders", daemon=True)
    reader.start()
    Solver(orders, tell).run(at_leisure)
    reader.join()


def _compile(called: Callable[[], bool]) -> None:
    """Have the kernels ready before the first drag; if they are not, the request that needs them says so."""
    with contextlib.suppress(Exception):
        warm_up(called)
