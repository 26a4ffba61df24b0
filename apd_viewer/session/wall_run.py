"""Run of the method Wall behind the steps of a timeline, in a process of its own."""

from collections.abc import Mapping
from typing import Any

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.request_and_reply import Request
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.session.state_store import Activity, Listener, StateStore
from apd_viewer.session.timeline_player import RETRIES, TimelinePlayer


class WallRun:
    """Run of the method Wall along the steps of a motion, one after another.

    Each goes on from the answer before it, as a press by the method Wall does. The solver that follows drags
    is another one, and the run waits while that one is at work.

    Attributes
    ----------
    done : int
        Steps that were solved since it began.
    settings : mapping of str to object
        Settings by name that make a document one of the wall.
    is_running : bool
    """

    def __init__(self, store: StateStore, player: TimelinePlayer, listener: Listener) -> None:
        self._store, self._player, self._listener = store, player, listener
        self.done, self.is_running = 0, False
        self.settings: Mapping[str, Any] = {}
        self._worker: SolverWorker | None = None
        self._step: State | None = None
        self._asked: Document | None = None
        self._wanted: Document | None = None
        self._start: State | None = None
        self._last: State | None = None
        self._iterates = False
        self._generation, self._retries = 0, RETRIES

    @property
    def count(self) -> int:
        """Number of steps that were solved and are to be."""
        return self.done + len(self._ahead)

    @property
    def _ahead(self) -> list[int]:
        """Numbers of the steps of the run that have no answer yet."""
        timeline = self._player.timeline
        k = None if self._step is None else timeline.number_of(self._step)
        return [] if k is None else timeline.unanswered(k, self.settings)

    def begin(self, k: int, settings: Mapping[str, Any]) -> None:
        """Solve the steps in the run of step ``k`` that lack an answer."""
        timeline, step = self._player.timeline, self._step
        is_same = step is not None and timeline.number_of(step) in timeline.run_of(k)
        if self.is_running and is_same and settings == self.settings:
            return
        self._end()
        self.settings, self.done, self.is_running = settings, 0, True
        self._step = self._player.timeline.steps[k].state
        self._go_on()

    def stop(self, why: str = "") -> None:
        """End the run, and tell why; the answers that have come stay."""
        if self.is_running:
            self._end()
            if why:
                self._listener.message_sent(why)
            self._listener.status_changed()

    def follow_state(self) -> None:
        """End the run with its mesh and steps; let it wait while the view is solved."""
        if not self.is_running or self._step is None:
            return
        state = self._store.state
        if state is None or not self._player.timeline.is_of(state.document):
            self.stop(tr("Another mesh is open: the wall is solved no further."))
        elif self._player.timeline.number_of(self._step) is None:
            self.stop()
        elif self._asked is not None and self._start is not None and self._iterates is self._waits:
            self._ask(self._asked, self._start)

    @property
    def _waits(self) -> bool:
        """True while the solver of the view needs the processor."""
        is_between_steps = self._player.is_playing and not self._player.is_paused
        return is_between_steps or self._store.activity is Activity.REFINING

    def receive(self) -> None:
        """Record an answer that has come to rest, and go on with the next step."""
        reply = None if self._worker is None else self._worker.take_reply()
        if reply is None or not reply.finished or reply.request.document is not self._asked:
            return
        if reply.failure:
            self.stop()
            self._listener.failed(reply.failure)
        elif reply.frame is not None:
            self._take(reply.request.document, reply.frame)

    def close(self) -> None:
        """End the process."""
        self._end()

    def _end(self) -> None:
        self.is_running, self._asked, self._start, self._last = False, None, None, None
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()

    # Steps

    def _go_on(self) -> None:
        """Ask for the next step, or end behind the last one."""
        ahead, timeline = self._ahead, self._player.timeline
        if not ahead:
            self._end()
            self._listener.status_changed()
            return
        step = timeline.steps[ahead[0]]
        self._step, self._retries = step.state, RETRIES
        self._wanted = document = step.state.document_as_come.with_settings(**self.settings)
        if step.state.frame.U is document.mesh.V and not document.is_posed:
            self._record(step.state.updated(document))  # it is at rest by any method
            return
        before = timeline.steps[ahead[0] - 1].wall if ahead[0] > timeline.run_of(ahead[0])[0] else None
        if before is None or before is not self._last:
            self._generation += 1
        self._ask(document, before or step.state)

    def _ask(self, document: Document, start: State) -> None:
        if self._worker is None:
            self._worker = SolverWorker(self._listener.wake)
        self._asked, self._start, self._iterates = document, start, not self._waits
        U, shifts = start.frame.U, start.obstacle_shifts
        self._worker.put_request(Request(document, self._generation, U, self._iterates, shifts=shifts))

    def _take(self, document: Document, frame: Frame) -> None:
        assert self._step is not None
        assert self._wanted is not None
        found = self._step.updated(document).updated(frame=frame)
        is_stopped = frame.settled and frame.share_reached < 1.0
        if document is not self._wanted:  # contact had stopped the obstacles there
            self._ask(self._wanted, found)
        elif is_stopped and self._retries:
            self._retries -= 1
            self._ask(found.document_as_come, found)
        else:
            self.done += 1
            self._record(found)
            if is_stopped and self.is_running:
                self.stop(tr("Contact lets the wall come no farther."))

    def _record(self, answer: State) -> None:
        assert self._step is not None
        k = self._player.timeline.number_of(self._step)
        if k is None:
            self.stop()
            return
        self._player.add_answer(k, answer)
        self._last = answer
        self._go_on()
        self._listener.status_changed()
