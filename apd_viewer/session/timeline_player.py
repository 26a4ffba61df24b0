"""Player of motions in steps, with each shape on a timeline."""

import time
from collections.abc import Sequence

from apd_viewer.language import tr
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.state_store import Activity, Listener, StateStore

# Attempts to move on once contact has stopped the obstacles.
RETRIES = 5


class TimelinePlayer:
    """Player of documents one after another, each until its shape is at rest.

    The solver of a drag also solves these documents; any other change of the document ends the motion.
    Handles and obstacles moved by hand are added to an existing timeline as well.

    Attributes
    ----------
    timeline : Timeline
        Steps recorded so far.
    done, count : int
        Steps that are done, and all steps, of the motion under way or the last one.
    began : float
        Start of the motion, in seconds of :func:`time.monotonic`.
    shows_wall : bool
        The answers of the wall are looked at, where they are known.
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store, self._gestures, self._listener = store, gestures, listener
        self.timeline = Timeline()
        self.done = self.count = 0
        self.began = 0.0
        self._ahead: tuple[Document, ...] = ()
        self._detour: Document | None = None
        self._retries = RETRIES
        self.shows_wall = False

    @property
    def is_playing(self) -> bool:
        """True while a motion is under way, or paused."""
        return bool(self._ahead)

    @property
    def is_paused(self) -> bool:
        """True while the motion under way is paused."""
        return self.is_playing and self._store.activity is Activity.PAUSED

    # Motions

    def begin(self) -> None:
        """Begin a run at the current state, for motions by hand."""
        self.timeline = self.timeline.begun_at(self._gestures.state_without_gesture())
        self._listener.status_changed()

    def play(self, title: str, documents: Sequence[Document], start: State | None = None) -> None:
        """Go through documents in one undo step, and record the shape at each.

        ``start`` is where they begin, if not at the shape on screen.
        """
        self._gestures.record(title, self._gestures.state_without_gesture())
        if start is not None:
            self._store.jump_to(start)
        self.timeline = self.timeline.begun_at(self._store.required_state())
        self._ahead, self.done, self.count = tuple(documents), 0, len(documents)
        self._retries, self.began = RETRIES, time.monotonic()
        self._store.solve(self._ahead[0])

    def stop(self) -> None:
        """End the motion under way once its current step has come to rest."""
        if self._ahead:
            self._ahead = self._ahead[: 2 if self._ahead[0] is self._detour else 1]
            self.count = self.done + 1
            if self.is_paused:
                self._store.pause_or_resume()
            self._listener.status_changed()

    def open(self, timeline: Timeline) -> None:
        """Take the steps of a file that is being opened, instead of those before."""
        self._ahead, self.timeline = (), timeline

    def clear(self) -> None:
        """Forget all steps; the current shape stays."""
        self._ahead, self.timeline = (), Timeline()
        self._listener.status_changed()

    def follow_state(self) -> None:
        """End the motion if something else has changed the document.

        Which shapes are shown follows a step that undo returns to.
        """
        if self._ahead and self._store.required_state().document is not self._ahead[0]:
            self._ahead = ()
            self._listener.status_changed()
        state = self._store.state
        if state is not None and state.document.settings.traits.is_wall is not self.shows_wall:
            k = self.shown
            if k is not None and self.timeline.steps[k].answer is not None:
                self.shows_wall = not self.shows_wall

    def receive(self) -> None:
        """Record a shape that has come to rest, and go on with the next."""
        if self._store.state is None or self._store.activity not in (Activity.SETTLED, Activity.UNREACHED):
            return
        state = self._store.state
        if self._ahead:
            self._record_step(state)
        elif self._gestures.state_before is None and self._is_moved_by_hand(state):
            before = self._gestures.history.last_entry
            kept = self.timeline if before is None else self.timeline.begun_at(before.state)
            self.timeline = kept.followed_by(state)
            self._listener.status_changed()

    def _record_step(self, state: State) -> None:
        is_stopped = state.frame.settled and state.frame.share_reached < 1.0
        if state.document is self._detour:
            self._go_on()
        elif is_stopped and self._retries and state.document.obstacles:
            self._retry(state)
        else:
            self.timeline, self.done = self.timeline.followed_by(state), self.done + 1
            self._retries = RETRIES
            if is_stopped and len(self._ahead) > 1:
                self._ahead = self._ahead[:1]
                self._listener.message_sent(tr("Contact lets nothing come any farther."))
            self._go_on()

    def _retry(self, state: State) -> None:
        """Come to rest where contact stopped the obstacles, and go on from there.

        Walls in the way of the obstacles may give way once they have come to rest.
        """
        self._retries -= 1
        self._detour = state.document_as_come
        self._ahead = (self._detour, *self._ahead)
        self._store.solve(self._detour)

    def _go_on(self) -> None:
        self._ahead = self._ahead[1:]
        if self._ahead:
            self._store.solve(self._ahead[0])
        else:
            self._listener.status_changed()

    def _is_moved_by_hand(self, state: State) -> bool:
        """True if handles or obstacles came to rest at a position not on the timeline."""
        if not self.timeline.is_of(state.document) or self.timeline.index_of(state) is not None:
            return False
        return _has_moved(self.timeline.steps[-1].state.document, state.document)

    def add_answer(self, k: int, answer: State) -> None:
        """Add the answer of the wall at step ``k``; what is shown stays."""
        self.timeline = self.timeline.with_answer(k, answer)
        self._listener.status_changed()

    # Looking at steps

    def show(self, k: int) -> None:
        """Show step ``k``; :meth:`end_show` makes it the current shape."""
        state = self.timeline.state_at(k, self._store.required_state().document, self.shows_wall)
        if self._gestures.state_before is None:
            self._gestures.begin()
        self._store.show(state)

    def end_show(self) -> None:
        """Make the step shown current; undo returns to a shape not on the timeline."""
        before = self._gestures.state_before
        if before is not None:
            known = self.timeline.index_of(before) is not None
            self._gestures.end(None if known else tr("Go to another step"))
            self._store.jump_to(self._store.required_state())

    def choose_wall(self, shows_wall: bool) -> None:
        """Look at the answers of the wall, or at what the motions came to; shown at once."""
        k, is_other, self.shows_wall = self.shown, shows_wall is not self.shows_wall, shows_wall
        if is_other and k is not None and self.timeline.steps[k].answer is not None:
            self.show(k)
            self.end_show()
        self._listener.status_changed()

    @property
    def shown(self) -> int | None:
        """Number of the displayed step; None for any other shape."""
        state = self._store.state
        return None if state is None else self.timeline.index_of(state)


def _has_moved(before: Document, after: Document) -> bool:
    """True if handles or obstacles have moved and are otherwise the same ones."""
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
