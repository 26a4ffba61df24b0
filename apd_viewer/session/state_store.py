"""The displayed state, and the solver's activity on its shape.

All methods are called on the session's thread. Every event results in one replacement of the state, reported
to the listener with the old and the new state; it compares by identity and displays the differences.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.trace import Trace
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.initial_positions import document_with_restarted_motions
from apd_viewer.session.processes.request_and_reply import Reply, Request, are_same_keys, factor_key
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.solution import Solution, Solutions


class Activity(Enum):
    """Activity of the solver on the displayed shape."""

    IDLE = "idle"
    REFINING = "refining"
    PAUSED = "paused"
    SETTLED = "settled"
    UNREACHED = "not reached"


def silence_text(seconds: int) -> str:
    """Sentence about a solver silent for ``seconds``; empty for 0."""
    words = tr("The solver has not answered for {n} s; wait, undo the last step, or restart the solver.")
    return words.format(n=seconds) if seconds else ""


class StateStore:
    """Displayed state, and activity of the solver.

    Attributes
    ----------
    state : State or None
        None until a mesh is open.
    trace : Trace
        Trace of readings up to the displayed shape.
    unit : Unit
        Of the lengths of the mesh.
    silence_text : str
        Sentence on a solver that does not answer; empty while it does.
    compiled_fraction : float or None
        Fraction of the kernels compiled for this computer; None if unknown.
    frame_pause : float
        Least seconds between two frames of one request; see :class:`Request`.
    """

    def __init__(self, listener: Listener, worker: SolverWorker) -> None:
        self.state: State | None = None
        self.trace = Trace()
        self.activity = Activity.IDLE
        self.seconds_per_iteration = 0.0
        self.unit = Unit.NONE
        self.silence_text = ""
        self.compiled_fraction: float | None = None
        self.frame_pause = 0.0
        self._listener = listener
        self._worker = worker
        self._generation = self._sent_generation = 0
        self._asked: Document | None = None
        self._factored: tuple[object, ...] = ()
        self._warned: str | None = None
        self._solutions = Solutions()

    @property
    def is_preparing(self) -> bool:
        """True until the document's matrix is factored, seconds for a large mesh."""
        if self._asked is None or self.activity is not Activity.REFINING:
            return False
        return not are_same_keys(factor_key(self._asked), self._factored)

    @property
    def is_previewing(self) -> bool:
        """True while the first shape waits for the compilation of kernels.

        Until then, only the targets of the handles are known.
        """
        return self.is_preparing and self.compiled_fraction is not None and self.compiled_fraction < 1.0

    def required_state(self) -> State:
        """Return the state; raises RuntimeError without an open mesh."""
        if self.state is None:
            raise RuntimeError("no mesh is open")
        return self.state

    @property
    def solution(self) -> Solution | None:
        """Solution of the document by the displayed shape; None if it is none."""
        return None if self.state is None else self._solutions.solution_of(self.state)

    @property
    def shown_activity(self) -> Activity:
        """Activity; for a restored shape the outcome of its solution."""
        state = self.state
        if self.activity is not Activity.IDLE or state is None or not self._solutions.is_finished(state):
            return self.activity
        return Activity.SETTLED if state.frame.converged else Activity.UNREACHED

    def set_state(self, state: State) -> None:
        """Replace the state without asking the solver."""
        old, self.state = self.state, state
        if self.activity in (Activity.SETTLED, Activity.UNREACHED):
            self._solutions.note_finished(state)
        self._listener.changed(old, state)

    def jump_to(self, state: State, from_initial_positions: bool = False) -> None:
        """Replace the state, and discard pending frames of the previous one.

        The next iterations start from its shape, or with ``from_initial_positions`` from those.
        """
        if self.state is None or state.document.mesh is not self.state.document.mesh:
            self._warned = None
        self._generation += 1
        if self.state is not None and state.frame.U is self.state.frame.U:
            self.begin_trace()
        else:
            self.trace.begin(state)
        self._ask_and_show(state, not state.frame.settled, from_initial_positions)

    def show_state(self, state: State) -> None:
        """Stop the solver, discard its pending frames, and display a state."""
        if self.activity is Activity.REFINING:
            self.pause_or_resume()
        self.activity = Activity.IDLE
        self._generation += 1
        self.set_state(state)

    def set_document(self, document: Document) -> None:
        """Replace the document; the shape is unchanged."""
        self.set_state(self.required_state().updated(document))

    def solve(self, document: Document) -> None:
        """Replace the document, and solve it unless its solution is the rest shape."""
        state = self.required_state().updated(document)
        moves = document.is_posed or document.settings.effective_settings.is_filled
        at_rest = state.frame.U is document.mesh.V and not moves and not state.has_unmet_target
        iterate = self.activity in (Activity.REFINING, Activity.PAUSED) or not at_rest
        self._ask_and_show(state.as_unsettled() if iterate else state, iterate)

    def solve_from_initial_positions(self, document: Document) -> None:
        """Replace the document; solve along the handle paths from their start."""
        self.jump_to(self.required_state().updated(document).as_unsettled(), from_initial_positions=True)

    def pause_or_resume(self) -> None:
        """Pause or resume the solver; the next change also resumes it."""
        paused = self.activity is Activity.PAUSED
        if self._asked is not None and (paused or self.activity is Activity.REFINING):
            self.activity = Activity.REFINING if paused else Activity.PAUSED
            frame = self.required_state().frame
            self._solutions.interrupt()
            self._put_request(frame.U, paused, frame.shifts)
            self._listener.status_changed()

    def restart_solver(self) -> None:
        """Restart the solver process from the displayed shape."""
        self._factored = ()
        self._solutions.interrupt()
        self._worker.restart_process()

    def revert_to(self, document: Document) -> None:
        """Restore a document, and solve it unless it was the last request."""
        (self.set_document if document is self._asked else self.solve)(document)

    def begin_trace(self) -> None:
        """Begin a new trace at the next change of the document."""
        self.trace.begin_with_next_frame(self._asked, self.required_state())

    def restart_motions(self, before: Document, document: Document) -> None:
        """Replace the document; handles then move from their displayed positions."""
        state = self.required_state()
        state = state.updated(document_with_restarted_motions(before, document, state.frame))
        lacks = state.has_unmet_target
        # Jumping discards pending frames, which can only be those of an unfinished motion.
        goes_on = lacks and (before.paint_problem is not None or not before.is_posed)
        unreached = state.frame.unreached if lacks else None
        frame = replace(
            state.frame, handle_drift=0.0, converged=not lacks, settled=not goes_on, unreached=unreached
        )
        self.jump_to(replace(state, frame=frame))

    def receive_reply(self) -> None:
        """Receive the newest reply, silence and compilation progress of the worker."""
        self._update_silence()
        if self.compiled_fraction != self._worker.compiled_fraction:
            self.compiled_fraction = self._worker.compiled_fraction
            self._listener.status_changed()
        reply = self._worker.take_reply()
        if reply is not None and reply.news:
            self._factored = ()
            self._solutions.interrupt()
            self._listener.message_sent(reply.news)
        if reply is not None and reply.request.generation == self._generation:
            self._accept(reply)

    def _update_silence(self) -> None:
        sentence = silence_text(self._worker.silent_seconds)
        if sentence != self.silence_text:
            self.silence_text = sentence
            if sentence:
                self._listener.message_sent(sentence)
            self._listener.status_changed()

    def _accept(self, reply: Reply) -> None:
        if reply.warning and reply.warning != self._warned:
            self._listener.message_sent(reply.warning)
        # A stale frame of this drag is worth showing, but says nothing about convergence.
        document = reply.request.document
        latest = document is self._asked
        if reply.finished and latest:
            settled = reply.frame is not None and reply.frame.converged
            self.activity = Activity.SETTLED if settled else Activity.UNREACHED
        if reply.failure:
            self._listener.failed(reply.failure)
        if reply.frame is None:
            self._listener.status_changed()
            return
        self._warned = reply.warning
        self._factored = factor_key(document)
        self.seconds_per_iteration = reply.seconds
        self.trace.add_frame(document, reply.frame)
        state = self._state_with_frame(document, reply.frame)
        if reply.finished and latest:
            self._solutions.add(document, state.frame, reply.cost)
        self.set_state(state if latest else state.as_unsettled())

    def _state_with_frame(self, asked: Document, frame: Frame) -> State:
        """State with the frame for a document; changed regions are remeasured."""
        state = self.required_state()
        if state.document.member is asked.member and state.document.regions is asked.regions:
            return replace(state, frame=frame)
        return state.updated(frame=frame)

    def _ask_and_show(self, state: State, iterate: bool, from_initial_positions: bool = False) -> None:
        """Send the request before notifying the listener, for parallel work."""
        old, self.state = self.state, state
        iterate = iterate and state.document.paint_problem is None
        is_busy = self.activity in (Activity.REFINING, Activity.PAUSED)
        is_jump = self._generation != self._sent_generation
        self._solutions.begin(state, is_jump, from_initial_positions, is_busy)
        self.activity = Activity.REFINING if iterate else Activity.IDLE
        self._asked = state.document
        U, shifts = state.frame.U, state.frame.shifts
        if from_initial_positions and not state.document.has_half_turn:  # a path starts there anyway
            U, shifts = state.document.initial_positions, np.zeros_like(shifts)
        self._put_request(U, iterate, shifts)
        self._listener.changed(old, state)

    def _put_request(self, U: np.ndarray, iterate: bool, shifts: np.ndarray) -> None:
        assert self._asked is not None
        self._sent_generation = self._generation
        asked = Request(
            self._asked, self._generation, U, iterate, shifts=shifts, frame_pause=self.frame_pause
        )
        self._worker.put_request(asked)


@dataclass(frozen=True)
class Listener:
    """Callbacks of a session: ``wake`` on any thread, others on the session's thread.

    Attributes
    ----------
    wake : callable
        Results are waiting: call :meth:`Session.receive_results` on the session's thread.
    changed : callable
        ``changed(old, new)``: the state was replaced, and activity, job or history may differ, too; old is
        None the first time.
    status_changed : callable
        Activity, job or history may differ, and the state does not.
    message_sent : callable
        ``message_sent(sentence)``: something the user should read.
    failed : callable
        ``failed(sentence)``: something the user asked for was not done, and why.
    view_opened : callable
        ``view_opened(view)``: a session was opened, and this is how it was looked at; after ``changed``.
    animation_opened : callable
        ``animation_opened(path)``: several shapes were opened, and the first is shown; after ``changed``. The
        path is None if the mesh is in another file.
    measurements_changed : callable
        More is known about the shape on screen, or less, because it is another one.
    file_written : callable
        ``file_written(path)``: the file that the sentence sent just before tells of.
    """

    wake: Callable[[], object]
    changed: Callable[[State | None, State], object]
    status_changed: Callable[[], object]
    message_sent: Callable[[str], object]
    failed: Callable[[str], object]
    view_opened: Callable[[View], object] = lambda _: None
    animation_opened: Callable[[Path | None], object] = lambda _: None
    measurements_changed: Callable[[], object] = lambda: None
    file_written: Callable[[Path], object] = lambda _: None


def with_followers(listener: Listener, followers: Sequence[Callable[[], object]]) -> Listener:
    """Listener calling each follower after a change of state or status."""

    def changed(old: State | None, new: State) -> None:
        listener.changed(old, new)
        for follow in followers:
            follow()

    def status_changed() -> None:
        listener.status_changed()
        for follow in followers:
            follow()

    return replace(listener, changed=changed, status_changed=status_changed)
