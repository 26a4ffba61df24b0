"""Player of motions in steps, with each shape on a timeline."""

import time
from collections.abc import Sequence

from apd_viewer.language import tr
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.state_store import Activity, Listener, StateStore

# Largest number of further attempts at a step in which contact has stopped the obstacles.
RETRIES = 5


class TimelinePlayer:
    """Player solving documents one after another, each until its shape has converged.

    The solver of a drag also solves these documents; any other change of the document ends the motion.
    Handles and obstacles moved by hand are added to an existing timeline as well.

    Attributes
    ----------
    timeline : Timeline
        Steps recorded so far.
    done, count : int
        Number of finished steps, and of all steps, of the current or last motion.
    began : float
        Start of the motion, in seconds of :func:`time.monotonic`.
    shows_wall : bool
        True to display the states solved by the Wall method, if there are any.
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store, self._gestures, self._listener = store, gestures, listener
        self.timeline = Timeline()
        self.done = self.count = 0
        self.began = 0.0
        self._ahead: tuple[Document, ...] = ()
        self._detour: Document | None = None
        self._last_shown: int | None = None
        self._retries = RETRIES
        self.shows_wall = False
        self._followed: State | None = None

    @property
    def is_playing(self) -> bool:
        """True while a motion is running or paused."""
        return bool(self._ahead)

    @property
    def is_paused(self) -> bool:
        """True while the current motion is paused."""
        return self.is_playing and self._store.activity is Activity.PAUSED

    # Motions

    def begin_run(self) -> None:
        """Begin a run at the current state, for motions by hand."""
        self._begin_run_from(self._gestures.state_without_gesture())
        self._listener.status_changed()

    def play(self, title: str, documents: Sequence[Document], start: State | None = None) -> None:
        """Solve documents in turn as one undo step, and record the shape of each.

        They start from the state ``start``; by default from the displayed one.
        """
        self._gestures.record(title, self._gestures.state_without_gesture())
        if start is not None:
            self._store.jump_to(start)
        self._begin_run_from(self._store.required_state())
        self._ahead, self.done, self.count = tuple(documents), 0, len(documents)
        self._retries, self.began = RETRIES, time.monotonic()
        self._store.solve(self._ahead[0])

    def _begin_run_from(self, state: State) -> None:
        if not self.timeline.belongs_to(state.document):
            self.shows_wall = False
        self.timeline = self.timeline.with_run_from(state)

    def stop(self) -> None:
        """End the current motion once its current step has converged."""
        if self._ahead:
            self._ahead = self._ahead[: 2 if self._ahead[0] is self._detour else 1]
            self.count = self.done + 1
            if self.is_paused:
                self._store.pause_or_resume()
            self._listener.status_changed()

    def set_timeline(self, timeline: Timeline) -> None:
        """Replace the timeline by that of an opened file."""
        self._ahead, self.timeline, self.shows_wall = (), timeline, False

    def clear(self) -> None:
        """Remove all steps; the current shape is kept."""
        self._ahead, self.timeline, self.shows_wall = (), Timeline(), False
        self._listener.status_changed()

    def follow_state(self) -> None:
        """End the motion if something else has changed the document.

        ``shows_wall`` is adapted to the displayed step after undo or redo, and after opening a session.
        """
        if self._ahead and self._store.required_state().document is not self._ahead[0]:
            self._ahead = ()
            self._listener.status_changed()
        state, is_new = self._store.state, self._store.state is not self._followed
        self._followed = state
        if is_new and state is not None and state.document.settings.traits.is_wall is not self.shows_wall:
            k = self.shown_step
            if k is not None and self.timeline.steps[k].wall_result is not None:
                self.shows_wall = not self.shows_wall

    def receive_shape(self) -> None:
        """Record a converged shape, and solve the next document."""
        if self._store.state is None or self._store.activity not in (Activity.SETTLED, Activity.UNREACHED):
            return
        state = self._store.state
        if self._ahead:
            self._record_step(state)
        elif self._gestures.state_before is None and self._is_moved_by_hand(state):
            before = self._gestures.history.last_entry
            kept = self.timeline if before is None else self.timeline.with_run_from(before.state)
            self.timeline = kept.with_state(state)
            self._listener.status_changed()

    def _record_step(self, state: State) -> None:
        is_stopped = state.frame.settled and state.frame.share_reached < 1.0
        if state.document is self._detour:
            self._solve_next_document()
        elif is_stopped and self._retries and state.document.obstacles:
            self._retry(state)
        else:
            self.timeline, self.done = self.timeline.with_state(state), self.done + 1
            self._retries = RETRIES
            if is_stopped and len(self._ahead) > 1:
                self._ahead = self._ahead[:1]
                self._listener.message_sent(tr("Contact lets nothing come any farther."))
            self._solve_next_document()

    def _retry(self, state: State) -> None:
        """Solve with the obstacles where contact stopped them, then try the step again.

        Walls that blocked the obstacles may yield once their shape has converged.
        """
        self._retries -= 1
        self._detour = state.document_with_reached_obstacles
        self._ahead = (self._detour, *self._ahead)
        self._store.solve(self._detour)

    def _solve_next_document(self) -> None:
        self._ahead = self._ahead[1:]
        if self._ahead:
            self._store.solve(self._ahead[0])
        else:
            self._listener.status_changed()

    def _is_moved_by_hand(self, state: State) -> bool:
        """True if handles or obstacles have converged at positions not on the timeline."""
        if not self.timeline.belongs_to(state.document) or self.timeline.index_of(state) is not None:
            return False
        return _has_moved(self.timeline.steps[-1].state.document, state.document)

    def add_wall_result(self, k: int, result: State) -> None:
        """Add a state solved by the Wall method at step ``k``.

        It is displayed if the step is, and ``shows_wall`` asks for it; unsettled ones are not, because
        displaying them would solve them further.
        """
        is_shown, dropped = self.shows_wall and self.shown_step == k, self.timeline.dropped
        self.timeline = self.timeline.with_wall_result(k, result)
        k -= self.timeline.dropped - dropped
        if is_shown and k >= 0 and result.frame.settled and self._gestures.state_before is None:
            self.show_step(k)
            self.accept_shown_step()
        self._listener.status_changed()

    # Display of steps

    def show_step(self, k: int) -> None:
        """Display step ``k``; :meth:`accept_shown_step` makes it the current state."""
        self._last_shown = k
        state = self.timeline.state_at(k, self._store.required_state().document, self.shows_wall)
        if self._gestures.state_before is None:
            self._gestures.begin(self.accept_shown_step)
        self._store.show_state(state)

    def accept_shown_step(self) -> None:
        """Make the displayed step current; undoable unless the previous shape is a step."""
        before = self._gestures.state_before
        if before is not None and self._gestures.is_showing:
            if (k := self.shown_step) is not None:
                self.show_step(k)  # its Wall result may have come meanwhile
            known = self.timeline.index_of(before) is not None
            self._gestures.end(None if known else tr("Go to another step"))
            self._store.jump_to(self._store.required_state())

    def choose_wall_results(self, shows_wall: bool) -> None:
        """Display the steps as solved by the Wall method or by that of the motion."""
        k, is_other, self.shows_wall = self.shown_step, shows_wall is not self.shows_wall, shows_wall
        if is_other and k is not None and self.timeline.steps[k].wall_result is not None:
            self.show_step(k)
            self.accept_shown_step()
        self._listener.status_changed()

    @property
    def shown_step(self) -> int | None:
        """Number of the displayed step; None for any other shape."""
        state, steps, k = self._store.state, self.timeline.steps, self._last_shown
        if state is None:
            return None
        # A run that begins at an earlier step has its shape twice.
        is_there = k is not None and k < len(steps) and steps[k].has_shape_of(state)
        return k if is_there else self.timeline.index_of(state)


def _has_moved(before: Document, after: Document) -> bool:
    """True if handles or obstacles have moved, and none was added or removed."""
    obstacles = before.obstacles, after.obstacles
    shifted = len(obstacles[0]) == len(obstacles[1]) and any(
        old.shift is not new.shift for old, new in zip(*obstacles, strict=True)
    )
    handles = before.handles, after.handles
    return shifted or (
        after.is_posed
        and len(handles[0]) == len(handles[1])
        and any(old.pose is not new.pose for old, new in zip(*handles, strict=True))
    )
