"""The state on screen, and the solver's work on its shape.

All methods are called on the owner's thread. Whatever happens ends in one replacement of the state, which
tells the one listener what was and what is; it compares by identity and shows what differs.
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum

import numpy as np

from apd_viewer.language import tr
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.trace import Trace
from apd_viewer.session.posing.regripping import regripped
from apd_viewer.session.processes.requests import Reply, Request, alike, factored_for
from apd_viewer.session.processes.worker import Worker
from apd_viewer.session.quantities.units import Unit


class Activity(Enum):
    """State of the solver's work on the shape on screen."""

    IDLE = "idle"
    REFINING = "refining"
    PAUSED = "paused"
    SETTLED = "settled"
    UNREACHED = "not reached"


def silence_words(seconds: int) -> str:
    """Sentence on a solver that has not answered for so long; empty for 0."""
    words = tr("The solver has not answered for {n} s; wait, undo the last step, or restart the solver.")
    return words.format(n=seconds) if seconds else ""


class Store:
    """The state on screen, and the activity of the solver.

    Parameters
    ----------
    listener : Listener
    worker : Worker

    Attributes
    ----------
    state : State or None
        None until a mesh is open.
    activity : Activity
    seconds_per_iteration : float
    trace : Trace
        The readings on the way to the shape on screen.
    unit : Unit
        Of the lengths of the mesh.
    silence : str
        Sentence on a solver that does not answer; empty while it does.
    compiled : float or None
        Share of the kernels compiled for this computer; None if not yet known.
    """

    def __init__(self, listener: Listener, worker: Worker) -> None:
        self.state: State | None = None
        self.trace = Trace()
        self.activity = Activity.IDLE
        self.seconds_per_iteration = 0.0
        self.unit = Unit.NONE
        self.silence = ""
        self.compiled: float | None = None
        self._listener = listener
        self._worker = worker
        self._generation = 0
        self._asked: Document | None = None
        self._factored: tuple[object, ...] = ()
        self._warned: str | None = None

    @property
    def preparing(self) -> bool:
        """True until the solver has factored for the document; seconds on a large mesh."""
        if self._asked is None or self.activity is not Activity.REFINING:
            return False
        return not alike(factored_for(self._asked), self._factored)

    @property
    def previews(self) -> bool:
        """True while a first shape waits for kernels.

        So far it is known only where the handles are to be.
        """
        return self.preparing and self.compiled is not None and self.compiled < 1.0

    def required(self) -> State:
        """The state; there must be one."""
        if self.state is None:
            raise RuntimeError("no mesh is open")
        return self.state

    def show(self, state: State) -> None:
        """Replace the state, and nothing else."""
        old, self.state = self.state, state
        self._listener.changed(old, state)

    def jump(self, state: State, anew: bool = False) -> None:
        """Go to ``state``; frames of the time before are no longer wanted.

        What is left to iterate begins with its shape, or ``anew`` with that at the grip.
        """
        if self.state is None or state.document.mesh is not self.state.document.mesh:
            self._warned = None
        self._generation += 1
        if self.state is not None and state.frame.U is self.state.frame.U:
            self.begin_trace()
        else:
            self.trace.begin(state)
        self._ask_and_show(state, not state.frame.settled, anew)

    def set_document(self, document: Document) -> None:
        """Replace the document by one with the same shape."""
        self.show(self.required().at(document))

    def solve(self, document: Document) -> None:
        """Replace the document and ask the solver, unless all is at rest."""
        state = self.required().at(document)
        at_rest = state.frame.U is document.mesh.V and not document.posed and not state.lacks
        iterate = self.activity in (Activity.REFINING, Activity.PAUSED) or not at_rest
        self._ask_and_show(state.unsettled() if iterate else state, iterate)

    def walk(self, document: Document) -> None:
        """Replace the document and solve it from the grip, along the paths of its handles."""
        self.jump(self.required().at(document).unsettled(), anew=True)

    def pause_or_resume(self) -> None:
        """Stop the solver where it is, or let it go on; so does the next change."""
        paused = self.activity is Activity.PAUSED
        if self._asked is not None and (paused or self.activity is Activity.REFINING):
            self.activity = Activity.REFINING if paused else Activity.PAUSED
            frame = self.required().frame
            asked = Request(self._asked, self._generation, frame.U, iterate=paused, shifts=frame.shifts)
            self._worker.ask(asked)
            self._listener.status_changed()

    def restart_solver(self) -> None:
        """End the process of the solver, and go on from the shape on screen in another."""
        self._factored = ()
        self._worker.restart()

    def revert(self, document: Document) -> None:
        """Go back to a document; the solver is asked unless it was its last request."""
        (self.set_document if document is self._asked else self.solve)(document)

    def begin_trace(self) -> None:
        """Begin another trace from here with the next change of the document."""
        self.trace.expect(self._asked, self.required())

    def regrip(self, before: Document, document: Document) -> None:
        """Replace the document, with base and handles gripped at the shape on screen."""
        state = self.required()
        state = state.at(regripped(before, document, state.frame))
        lacks = state.lacks
        # An unfinished pose is given up with the jump; nothing else is pending.
        goes_on = lacks and (before.problem is not None or not before.posed)
        unreached = state.frame.unreached if lacks else None
        frame = replace(
            state.frame, handle_drift=0.0, converged=not lacks, settled=not goes_on, unreached=unreached
        )
        self.jump(replace(state, frame=frame))

    def receive(self) -> None:
        """Receive the newest reply of the worker, and whether it is silent or compiles."""
        self._hear_silence()
        if self.compiled != self._worker.compiled:
            self.compiled = self._worker.compiled
            self._listener.status_changed()
        reply = self._worker.take()
        if reply is not None and reply.news:
            self._factored = ()
            self._listener.told(reply.news)
        if reply is not None and reply.generation == self._generation:
            self._accept(reply)

    def _hear_silence(self) -> None:
        sentence = silence_words(self._worker.silent)
        if sentence != self.silence:
            self.silence = sentence
            if sentence:
                self._listener.told(sentence)
            self._listener.status_changed()

    def _accept(self, reply: Reply) -> None:
        if reply.warning and reply.warning != self._warned:
            self._listener.told(reply.warning)
        if reply.frame is not None:
            self._warned = reply.warning
            self._factored = factored_for(reply.document)
        # A slightly stale frame of this drag is worth showing, but does not tell whether it has converged.
        latest = reply.document is self._asked
        if reply.frame is not None:
            self.seconds_per_iteration = reply.seconds
            state = self._showing(reply)
            self.trace.add(reply.document, reply.frame)
            self.show(state if latest else state.unsettled())
        if reply.finished and latest:
            settled = reply.frame is not None and reply.frame.converged
            self.activity = Activity.SETTLED if settled else Activity.UNREACHED
        if reply.failure:
            self._listener.failed(reply.failure)
        self._listener.status_changed()

    def _showing(self, reply: Reply) -> State:
        """The state with the frame of a reply; changed regions are measured anew."""
        state, asked = self.required(), reply.document
        if state.document.member is asked.member and state.document.regions is asked.regions:
            assert reply.frame is not None
            return replace(state, frame=reply.frame)
        return state.at(frame=reply.frame)

    def _ask_and_show(self, state: State, iterate: bool, anew: bool = False) -> None:
        """Ask the solver first: it works while the listener repaints."""
        old, self.state = self.state, state
        iterate = iterate and state.document.problem is None
        self.activity = Activity.REFINING if iterate else Activity.IDLE
        self._asked = state.document
        U, shifts = state.frame.U, state.frame.shifts
        if anew and not state.document.winds:  # a path is walked from the grip in any case
            U, shifts = state.document.grip, np.zeros_like(shifts)
        self._worker.ask(Request(state.document, self._generation, U, iterate, shifts=shifts))
        self._listener.changed(old, state)
        self._listener.status_changed()
