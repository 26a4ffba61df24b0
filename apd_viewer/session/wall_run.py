"""Run of the Wall method over the steps of a timeline, in a separate process."""

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
    """Run solving the steps of a motion by the Wall method, one after another.

    Each step starts from the result of the previous one, as in a press by the Wall method. The displayed
    shape has another solver; the run waits while that is working.

    Attributes
    ----------
    done : int
        Number of steps solved since the start of the run.
    settings : mapping of str to object
        Changes of settings, by name, to solve a document by the Wall method.
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
        """Number of steps solved and still to be solved."""
        return self.done + len(self._remaining_steps)

    @property
    def _remaining_steps(self) -> list[int]:
        """Numbers of the steps of the run that are not solved yet."""
        timeline = self._player.timeline
        k = None if self._step is None else timeline.index_of_recorded(self._step)
        return [] if k is None else timeline.steps_without_wall_result(k, self.settings)

    def begin(self, k: int, settings: Mapping[str, Any]) -> None:
        """Solve the steps in the run of step ``k`` not solved with these settings yet."""
        timeline, step = self._player.timeline, self._step
        is_same = step is not None and timeline.index_of_recorded(step) in timeline.run_of(k)
        if self.is_running and is_same and settings == self.settings:
            return
        self._end()
        self.settings, self.done, self.is_running = settings, 0, True
        self._step = self._player.timeline.steps[k].state
        self._solve_next_step()

    def stop(self, why: str = "") -> None:
        """End the run with a message on the reason; the results so far are kept."""
        if self.is_running:
            self._end()
            if why:
                self._listener.message_sent(why)
            self._listener.status_changed()

    def follow_state(self) -> None:
        """End the run if its mesh or steps are gone; pause it while the view is solved."""
        if not self.is_running or self._step is None:
            return
        state = self._store.state
        if state is None or not self._player.timeline.belongs_to(state.document):
            self.stop(tr("Another mesh is open: the wall is solved no further."))
        elif self._player.timeline.index_of_recorded(self._step) is None:
            self.stop()
        elif self._asked is not None and self._start is not None and self._iterates is self._is_waiting:
            self._ask(self._asked, self._start)

    @property
    def _is_waiting(self) -> bool:
        """True while the solver of the view needs the processor."""
        is_between_steps = self._player.is_playing and not self._player.is_paused
        return is_between_steps or self._store.activity is Activity.REFINING

    def receive_result(self) -> None:
        """Record a converged result, and solve the next step."""
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

    def _solve_next_step(self) -> None:
        """Request the next step, or end the run after the last one."""
        ahead, timeline = self._remaining_steps, self._player.timeline
        if not ahead:
            self._end()
            self._listener.status_changed()
            return
        step = timeline.steps[ahead[0]]
        self._step, self._retries = step.state, RETRIES
        self._wanted = document = step.state.document_with_reached_obstacles.with_settings(**self.settings)
        if step.state.frame.U is document.mesh.V and not document.is_posed:
            self._record(step.state.updated(document))  # the rest shape solves every method
            return
        before = timeline.steps[ahead[0] - 1].wall_state if ahead[0] > timeline.run_of(ahead[0])[0] else None
        if before is None or before is not self._last:
            self._generation += 1
        self._ask(document, before or step.state)

    def _ask(self, document: Document, start: State) -> None:
        if self._worker is None:
            self._worker = SolverWorker(self._listener.wake)
        self._asked, self._start, self._iterates = document, start, not self._is_waiting
        U, shifts = start.frame.U, start.obstacle_shifts
        self._worker.put_request(Request(document, self._generation, U, self._iterates, shifts=shifts))

    def _take(self, document: Document, frame: Frame) -> None:
        assert self._step is not None
        assert self._wanted is not None
        found = self._step.updated(document).updated(frame=frame)
        is_stopped = frame.settled and frame.share_reached < 1.0
        if document is not self._wanted:  # an intermediate document: contact had stopped the obstacles
            self._ask(self._wanted, found)
        elif is_stopped and self._retries:
            self._retries -= 1
            self._ask(found.document_with_reached_obstacles, found)
        else:
            self.done += 1
            self._record(found)
            if is_stopped and self.is_running:
                self.stop(tr("Contact lets the wall come no farther."))

    def _record(self, result: State) -> None:
        assert self._step is not None
        k = self._player.timeline.index_of_recorded(self._step)
        if k is None:
            self.stop()
            return
        self._player.add_wall_result(k, result)
        self._last = result
        self._solve_next_step()
        self._listener.status_changed()
