"""Gestures such as strokes, drags and slider moves, each one undo step."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from apd_viewer.session.model.history import History
from apd_viewer.session.model.state import State
from apd_viewer.session.state_store import Listener, StateStore

# Key presses within this many seconds are merged into one undo step.
_TOGETHER = 1.0


class Gestures:
    """Recorder of gestures that change the state, with undo and redo.

    Attributes
    ----------
    state_before : State or None
        State at the start of the current gesture.
    """

    def __init__(self, store: StateStore, listener: Listener) -> None:
        self._store = store
        self._listener = listener
        self._last = -_TOGETHER
        self.state_before: State | None = None
        self._accept: Callable[[], object] | None = None
        self.history = History()

    def begin(self, accept: Callable[[], object] | None = None) -> None:
        """Begin a gesture, one undo step; ``accept()`` ends one that merely shows a state."""
        self.accept_shown_state()
        self.state_before, self._accept = self._store.required_state(), accept
        self._store.begin_trace()

    @property
    def is_showing(self) -> bool:
        """True while the current gesture merely shows a state, as a replay does."""
        return self.state_before is not None and self._accept is not None

    def accept_shown_state(self) -> None:
        """End a gesture that merely shows a state, which another one then changes."""
        if self._accept is not None and self.is_showing:
            self._accept()

    def end(self, name: str | None) -> None:
        """End the gesture, and record it if the document changed and it has a name."""
        before, self.state_before = self.state_before, None
        if before is not None:
            self._store.trace.mark_release()
        changed = before is not None and before.document is not self._store.required_state().document
        if before is not None and changed and name is not None:
            self._remember(name, before)

    def cancel(self) -> None:
        """Cancel the gesture, and restore the state before it."""
        if self.state_before is not None:
            before, self.state_before = self.state_before, None
            self._store.jump_to(before)

    def state_without_gesture(self) -> State:
        """Cancel the current gesture, if any, and return the state."""
        self.cancel()
        return self._store.required_state()

    def record(self, name: str, before: State, is_repeat: bool = False) -> None:
        """Record the state before a step; repeats within a second are merged."""
        now = time.monotonic()
        follows = now - self._last < _TOGETHER and self.history.next_redo_name is None
        if is_repeat and follows and self.history.next_undo_name == name:
            self._listener.status_changed()
        else:
            self._store.begin_trace()
            self._remember(name, before)
        self._last = now if is_repeat else -_TOGETHER

    def _remember(self, name: str, before: State) -> None:
        self.history.record(name, before)
        self._last = -_TOGETHER
        self._listener.status_changed()

    def limit_memory(self, most_bytes: int) -> None:
        """Limit the memory of the undo history."""
        self.history.limit_memory(most_bytes)
        self._listener.status_changed()

    def undo(self) -> None:
        """Undo the last step, restoring the identical document and shape objects."""
        self._jump_in_history(self.history.undo)

    def redo(self) -> None:
        """Redo the last undone step."""
        self._jump_in_history(self.history.redo)

    def go_to_step(self, steps: int) -> None:
        """Undo or redo until ``steps`` steps are on the undo stack."""
        state = target = self.state_without_gesture()
        while len(self.history.undo_names) > steps and (earlier := self.history.undo(target)):
            target = earlier
        while len(self.history.undo_names) < steps and (later := self.history.redo(target)):
            target = later
        if target is not state:
            self._store.jump_to(target)

    def _jump_in_history(self, swap: Callable[[State], State | None]) -> None:
        target = swap(self.state_without_gesture())
        if target is not None:
            self._store.jump_to(target)


class DocumentEditor:
    """Base of editors changing the document in undo steps or within a gesture."""

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener

    def _record_state(self, gesture: str) -> State:
        """Cancel any gesture, record the state before a new step, and return it."""
        state = self._gestures.state_without_gesture()
        self._gestures.record(gesture, state)
        return state

    def _replace(self, gesture: str, **changes: Any) -> None:
        """Replace fields of the document in one undo step; the shape is unchanged."""
        self._store.set_document(replace(self._record_state(gesture).document, **changes))
