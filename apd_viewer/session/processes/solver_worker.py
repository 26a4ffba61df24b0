"""Access to the solver process: complete requests in, coalesced replies out.

The process does all work that would block the window, and its death loses nothing:

    ask ──> mailbox ──> thread "solver" ──> child: envelope, pipe ──> process
    take <── mailbox <── thread "answers" of the child: pipe, tray <──

Only the thread "solver" starts processes and sends. It waits at the mailbox for the newest request or for the
end of the process, and then makes sure that a process has the latest request. A crashed process is replaced,
and the new one continues from the last shape received; after a few crashes without a shape the request is
given up, with a sentence. Results about a mesh that take long to compute are kept here. A second process kept
ready for a crash would save its start: 0.8 s of 2.1 s at 655,712 vertices, for 220 MiB of memory.

A reply may be overwritten by the next one, except for its news: they are added to the reply taken next.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from enum import Enum

import numpy as np

from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.processes.request_and_reply import Reply, Request
from apd_viewer.session.processes.solver_process import SolverProcess

_log = logging.getLogger(__name__)
MOST_CRASHES = 3  # consecutive crashes without a shape before a request is given up
_CALM = 20.0  # seconds without a crash after which the count restarts

_DIED = tr("The solver stopped unexpectedly and was restarted; nothing was lost.")
_GIVEN_UP = tr(
    "The solver stopped {times} times without an error message; memory may be low. Undo the"
    " last step, or close other programs and try again."
)
_NOT_SENT = tr("The solver does not respond ({why}); undo the last step.")
_NOT_STARTED = tr("The solver cannot be started ({why}); close other programs and try again.")


class _Call(Enum):
    """Entries of the mailbox other than requests."""

    CHILD_ENDED = 1


class SolverWorker:
    """Access to a solver process, started with the first request.

    Parameters
    ----------
    wake : callable
        Called on a thread of the worker when a reply lies in the empty mailbox; must only pass it on.

    Attributes
    ----------
    compiled_fraction : float or None
        Share of the kernels compiled for this computer so far; None before that is known. ``wake`` is called
        when it changes.
    silent_seconds : int
        Seconds after which it was found that the process does not answer; 0 while it does. ``wake`` is called
        when it changes.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        self.compiled_fraction: float | None = None
        self.silent_seconds = 0
        self._wake = wake
        self._requests: Mailbox[Request | _Call] = Mailbox()
        self._replies: Mailbox[tuple[Reply, Callable[[], object]]] = Mailbox()
        self._turned_to: Request | None = None
        self._finished: tuple[Document, int] | None = None
        self._shape: tuple[int, Frame] | None = None
        self._known: tuple[Mesh | None, tuple[Decimation, ...]] = None, ()
        self._news: Mailbox[str] = Mailbox()
        self._deaths = 0
        self._last_death = -np.inf
        self._child: SolverProcess | None = None
        self._closed = False
        self._changing_child = threading.Lock()
        self._thread = threading.Thread(target=self._run, name="solver", daemon=True)
        self._thread.start()

    def put_request(self, request: Request) -> None:
        """Queue ``request``, replacing any queued one; never blocks."""
        self._requests.put(request)

    def take_reply(self) -> Reply | None:
        """Take the newest reply; None if there is none."""
        taken = self._replies.take()
        if taken is None:
            return None
        reply, looked = taken
        looked()
        news = self._news.take()
        return replace(reply, news=news) if news else reply

    def restart_process(self) -> None:
        """Kill the process; a new one continues from the last shape."""
        if (child := self._child) is not None:
            child.dismiss()

    def close(self) -> None:
        """Kill the process and end the threads."""
        with self._changing_child:
            self._closed = True
        self._requests.close()
        if (child := self._child) is not None:
            child.dismiss()
            child.join()
        self._thread.join()
        self._child = self._shape = self._turned_to = None
        self._known = None, ()
        self._replies.take()

    # Methods of the thread "solver"

    def _run(self) -> None:
        while (called := self._next_call()) is not None:
            if isinstance(called, Request):
                self._turned_to = called
            try:
                if called is self._turned_to or (self._child is not None and not self._child.is_alive):
                    while self._turned_to and not self._closed and not self._send(self._turned_to):
                        pass
            except Exception as error:
                self._give_up(error)

    def _next_call(self) -> Request | _Call | None:
        """Wait for the process, then for the next call; None once closed."""
        if self._child is not None:
            self._child.wait_until_received()
        return self._requests.wait()

    def _give_up(self, error: Exception) -> None:
        """Drop an unsendable request, and end the process."""
        _log.exception("A request cannot be sent to the solver")
        request, self._turned_to = self._turned_to, None
        if self._child is not None:
            self._child.dismiss()
        if request is not None:
            self._fail(request, _NOT_SENT.format(why=str(error) or type(error).__name__))

    def _send(self, request: Request) -> bool:
        """Send a request or give it up; return False if the process has died."""
        child = self._child
        if child is not None and not child.is_alive:
            self._child = None
            if not child.is_dismissed and self._count_crash(request):
                return True
            child = None
        if child is None:
            child = self._start(request)
            if child is None:
                return True
            request = self._resumed_request(request)
        mesh, thinnings = self._known
        return child.send_request(request, thinnings if mesh is request.document.mesh else ())

    def _start(self, request: Request) -> SolverProcess | None:
        with self._changing_child:
            if self._closed:
                return None
            try:
                self._child = SolverProcess(
                    self._publish, self._store, self._show_progress, self._silence, self._end
                )
            except OSError as error:
                self._fail(request, _NOT_STARTED.format(why=error.strerror or error))
            return self._child

    def _resumed_request(self, request: Request) -> Request:
        """Request for a new process, starting from the last shape."""
        shape, finished = self._shape, self._finished == (request.document, request.generation)
        request = replace(request, iterate=request.iterate and not finished)
        if shape is None or shape[0] != request.generation:
            return request
        return replace(request, U=shape[1].U, shifts=shape[1].shifts)

    def _count_crash(self, request: Request) -> bool:
        """Count a crash; return True if the request is given up."""
        now = time.monotonic()
        calm, self._last_death = now - self._last_death > _CALM, now
        self._deaths = 1 if calm else self._deaths + 1
        if self._deaths >= MOST_CRASHES:
            self._fail(request, _GIVEN_UP.format(times=self._deaths))
            return True
        if calm:
            self._news.put(_DIED)
            if self._replies.offer((Reply(request), lambda: None)):
                self._wake()
        return False

    def _fail(self, request: Request, sentence: str) -> None:
        self._put(Reply(request, finished=True, failure=sentence), lambda: None)

    def _put(self, reply: Reply, on_displayed: Callable[[], object]) -> None:
        if self._replies.put((reply, on_displayed)):
            self._wake()

    # Methods of the thread "answers"

    def _publish(self, reply: Reply, on_displayed: Callable[[], object]) -> None:
        if reply.frame is not None:
            self._deaths = 0
            self._shape = reply.request.generation, reply.frame
        if reply.finished:
            self._finished = reply.request.document, reply.request.generation
        self._put(reply, on_displayed)

    def _store(self, mesh: Mesh, decimations: tuple[Decimation, ...]) -> None:
        self._known = mesh, decimations

    def _show_progress(self, fraction: float) -> None:
        self.compiled_fraction = fraction
        self._wake()

    def _silence(self, seconds: int) -> None:
        self.silent_seconds = seconds
        self._wake()

    def _end(self, _: SolverProcess) -> None:
        if not self._closed:
            self._requests.offer(_Call.CHILD_ENDED)
