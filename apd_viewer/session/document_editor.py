"""Base of the classes that change the document of a session."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from apd_viewer.session.gestures import Gestures
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.state import State
from apd_viewer.session.state_store import StateStore


class DocumentEditor:
    """Changes of the document, each a step of undo or part of a gesture.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    listener : Listener
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener

    def _recorded(self, gesture: str) -> State:
        """Record the state, without a gesture under way, as that before a step; return it."""
        state = self._gestures.state_without_gesture()
        self._gestures.record(gesture, state)
        return state

    def _replace(self, gesture: str, **changes: Any) -> None:
        """Replace fields of the document in one step; the shape stays as it is."""
        self._store.set_document(replace(self._recorded(gesture).document, **changes))
