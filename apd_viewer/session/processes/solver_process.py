"""Client of the solver process, with a watch for its silence."""

from __future__ import annotations

import itertools
import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess
from apd_viewer.session.processes.request_and_reply import (
    CompilationProgress,
    Reply,
    Request,
    RequestStage,
    SolverMessage,
    are_same_keys,
    factor_key,
)
from apd_viewer.session.processes.shared_memory import SharedShapeBuffer

_PATIENCE = 5  # seconds of silence allowed
_AT_START = 30  # seconds allowed for loading the libraries from a slow disk
_START = START_SCRIPT.format(module="processes.solver_main")


def start_solver_process() -> ChildProcess:
    """Start the solver process; raises OSError on failure."""
    process = ChildProcess("solver", _START)
    process.start()
    return process


class SolverProcess:
    """Solver process receiving requests one at a time and publishing replies.

    Parameters
    ----------
    on_reply : callable
        ``on_reply(reply, looked)``, called with every reply, on a thread of the child. ``looked()`` tells the
        solver that it is displayed, and that it may send another.
    on_decimations : callable
        Called on that thread with a mesh and its decimations, once the process has computed them.
    on_compilation : callable
        Called on that thread with the fraction of the kernels compiled so far.
    on_silence : callable
        Called with the seconds in which the process has said nothing though it should, 0 once it does again;
        see :class:`SilenceWatch`.
    on_end : callable
        Called on that thread, last, when the process has come to its end, for whatever reason.

    Attributes
    ----------
    is_dismissed : bool
        True after an intended end.

    Raises
    ------
    OSError
        If there can be no process.
    """

    def __init__(
        self,
        on_reply: Callable[[Reply, Callable[[], object]], object],
        on_decimations: Callable[[Mesh, tuple[Decimation, ...]], object],
        on_compilation: Callable[[float], object],
        on_silence: Callable[[int], object],
        on_end: Callable[[SolverProcess], object],
    ) -> None:
        self.is_alive = True
        self.is_dismissed = False
        self._publish, self._learned, self._compiling, self._ended = (
            on_reply,
            on_decimations,
            on_compilation,
            on_end,
        )
        self._process = start_solver_process()
        self._packer = array_pipe.ArrayPacker()
        self._numbers = itertools.count(1)
        self._requests: dict[int, Request] = {}
        self._trays: dict[int, SharedShapeBuffer | None] = {}
        self._tray: tuple[int, SharedShapeBuffer | None] | None = None
        self._start: Request | None = None
        self._finder_of: Mesh | None = None
        self._received = threading.Event()
        self._received.set()
        self._watch = SilenceWatch(on_silence, _AT_START)
        self._thread = threading.Thread(target=self._listen, name="answers", daemon=True)
        self._thread.start()

    def wait_until_received(self) -> None:
        """Wait until the process has received the last request, or has ended."""
        self._received.wait()

    def send_request(self, request: Request, decimations: tuple[Decimation, ...]) -> bool:
        """Send a request once the last one is received; False if the process has ended.

        The ``decimations`` of its mesh, if known, need not be computed again.
        """
        self._received.clear()
        number, tray = next(self._numbers), self._shape_buffer_for(request)
        self._watch.expect_answer(number, _allowed_silence(len(request.document.mesh.F)))
        # Sent with every request, as the process may skip earlier ones; it knows those it computed itself.
        known = () if request.document.mesh is self._finder_of else decimations
        name = tray.name if tray else None
        request = replace(request, number=number, shape_buffer=name, decimations=known)
        self._requests[number], self._trays[number] = request, tray
        message = self._packer.packed_message(_without_target(self._with_first_start(request)))
        if self.is_alive:  # if the process has just ended, the listening thread reports it
            self._process.send_messages(message)
        if not self.is_alive:
            self.join()  # it may be reading the shared memory until it has ended
            self._discard_shared_arrays()
        return self.is_alive

    def dismiss(self) -> None:
        """Kill the process without waiting for it."""
        self.is_dismissed = True
        self._process.kill()

    def join(self) -> None:
        """Wait until the process and its thread have ended."""
        self._thread.join()

    def _shape_buffer_for(self, request: Request) -> SharedShapeBuffer | None:
        n = len(request.U)
        if self._tray is None or self._tray[0] != n:
            try:
                self._tray = n, SharedShapeBuffer(n)
            except OSError:  # no shared memory: the shapes come with the replies
                self._tray = n, None
        return self._tray[1]

    def _with_first_start(self, request: Request) -> Request:
        """Request with the start shape of the first request that has the same factors.

        The process continues from its current shape, and needs the start shape only for the first of them:
        an equal array is sent only once.
        """
        start = self._start
        if (
            start is None
            or start.generation != request.generation
            or not are_same_keys(factor_key(start.document), factor_key(request.document))
        ):
            self._start = start = request
        return replace(request, U=start.U)

    # Methods of the thread "answers"

    def _listen(self) -> None:
        try:
            while (message := self._process.receive_message()) is not None:
                self._handle_message(array_pipe.unpickled_value(message, self._requests))
        finally:
            self.is_alive = False
            self._watch.close()
            self._process.end()
            self._discard_shared_arrays()
            self._received.set()
            self._ended(self)

    def _handle_message(self, message: SolverMessage) -> None:
        self._watch.note_message()
        if isinstance(message, logging.LogRecord):
            logging.getLogger(message.name).handle(message)
        elif isinstance(message, CompilationProgress):
            self._compiling(message.fraction)
        elif isinstance(message, Reply):
            self._handle_reply(message)
        elif message.request is not None:
            self._handle_stage(message.stage, message.request.number)

    def _handle_stage(self, stage: RequestStage, number: int) -> None:
        if stage is RequestStage.RECEIVED:
            self._discard_shared_arrays()
            self._received.set()
        elif stage is RequestStage.TURNED_TO:
            for earlier in [n for n in list(self._requests) if n < number]:
                del self._requests[earlier], self._trays[earlier]
        elif stage is RequestStage.ANSWERED:
            self._watch.note_message(answer=number)

    def _handle_reply(self, reply: Reply) -> None:
        if reply.decimations is not None:
            self._finder_of = reply.request.document.mesh
            self._learned(self._finder_of, reply.decimations)
            return
        if reply.failure:
            # The process has lost its state: the next request starts from the displayed shape.
            self._start = None
        looked: Callable[[], object] = _do_nothing
        if (frame := reply.frame) is not None:
            U, shape_buffer = frame.U, self._trays[reply.request.number]
            if shape_buffer is not None and (number := reply.shape_number) is not None:
                U, looked = shape_buffer.take_shape(number), partial(shape_buffer.mark_displayed, number)
            reply = replace(reply, frame=replace(frame, U=frozen(U)))
        self._publish(reply, looked)

    def _discard_shared_arrays(self) -> None:
        envelope, self._packer.shared_arrays = self._packer.shared_arrays, None
        if envelope is not None:
            envelope.discard()


def _allowed_silence(faces: int) -> int:
    """Seconds of silence allowed before a report.

    Native code holds the interpreter lock, and thus delays the reports, by at most 2.4 s for a million
    triangles on two busy cores.
    """
    return max(_PATIENCE, round(1e-5 * faces))


def _do_nothing() -> None:
    """Do nothing when a reply is displayed."""


def _without_target(request: Request) -> Request:
    """Request without the target shape, irrelevant for the solver."""
    document = request.document
    if document.target_shape is None:
        return request
    return replace(request, document=replace(document, target_shape=None))


TICK = 1.0  # seconds between checks


class SilenceWatch:
    """Thread detecting a lack of messages while an answer is pending.

    Only seconds in which the thread itself ran are counted, so that sleep of the computer has no effect. The
    thread sleeps while no answer is pending.

    Parameters
    ----------
    silence_changed : callable
        ``silence_changed(seconds)``, called on a thread of the watch or of who hears: the seconds of silence
        so far when it is noticed, and 0 when it is over; must only pass it on.
    first_patience : int
        Seconds that are allowed until the first word, at least.
    """

    def __init__(self, silence_changed: Callable[[int], object], first_patience: int) -> None:
        self._changed, self._at_start = silence_changed, first_patience
        self._allowed_silence = 0
        self._condition = threading.Condition()
        self._awaited = self._answered = 0
        self._quiet = 0
        self._silent = self._closed = False
        self._thread = threading.Thread(target=self._run, name="silence", daemon=True)
        self._thread.start()

    def expect_answer(self, number: int, patience: int) -> None:
        """Start waiting for answer ``number``; any message counts as a sign of life."""
        with self._condition:
            if not self._awaits:
                self._quiet = 0
                self._condition.notify()
            self._awaited, self._allowed_silence = number, patience

    def note_message(self, answer: int = 0) -> None:
        """Register a message, and the number of an answer completed by it."""
        with self._condition:
            self._at_start = self._quiet = 0
            self._answered = max(answer, self._answered)
            self._break_silence()

    def close(self) -> None:
        """Stop the watch thread."""
        with self._condition:
            self._closed = True
            self._break_silence()
            self._condition.notify()
        self._thread.join()

    @property
    def _awaits(self) -> bool:
        return self._answered < self._awaited

    def _break_silence(self) -> None:
        if self._silent:
            self._silent = False
            self._condition.notify()
            self._changed(0)

    def _run(self) -> None:
        with self._condition:
            while not self._closed:
                if self._silent or not self._awaits:
                    self._condition.wait()
                elif not self._condition.wait(TICK):
                    self._quiet += 1
                    if self._quiet >= max(self._allowed_silence, self._at_start) and self._awaits:
                        self._silent = True
                        self._changed(self._quiet)
