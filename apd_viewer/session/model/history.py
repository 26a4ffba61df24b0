"""Undo and redo: two stacks of states, one entry a gesture."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.session.model.state import State


class HistoryEntry(NamedTuple):
    """A gesture and the state on the other side of it."""

    gesture: str
    state: State


class History:
    """Undo and redo stacks within a budget of memory.

    Parameters
    ----------
    most_bytes : int
        The oldest entries go when the states together pass this. At least one always stays.
    """

    def __init__(self, most_bytes: int = 512 * 2**20) -> None:
        self._most_bytes = most_bytes
        self._undo: list[HistoryEntry] = []
        self._redo: list[HistoryEntry] = []

    @property
    def latest(self) -> HistoryEntry | None:
        """The next gesture to undo; the same while repeated keys are joined to it."""
        return self._undo[-1] if self._undo else None

    @property
    def next_undo(self) -> str | None:
        """Name of the next gesture to undo."""
        return self._undo[-1].gesture if self._undo else None

    @property
    def next_redo(self) -> str | None:
        """Name of the next gesture to redo."""
        return self._redo[-1].gesture if self._redo else None

    @property
    def done(self) -> list[str]:
        """Names of the gestures on the undo stack, oldest first."""
        return [entry.gesture for entry in self._undo]

    @property
    def undone(self) -> list[str]:
        """Names of the gestures on the redo stack, next first."""
        return [entry.gesture for entry in reversed(self._redo)]

    @property
    def past(self) -> list[State]:
        """States on the undo stack, oldest first."""
        return [entry.state for entry in self._undo]

    @property
    def states(self) -> list[State]:
        """States within reach of undo and redo."""
        return [entry.state for entry in (*self._undo, *self._redo)]

    def record(self, gesture: str, before: State) -> None:
        """Push the state before a finished gesture."""
        self._redo.clear()
        self._undo.append(HistoryEntry(gesture, before))
        self._drop_oldest()

    def limit(self, most_bytes: int) -> None:
        """Set the budget, and drop what is beyond it."""
        self._most_bytes = most_bytes
        self._drop_oldest()

    def _drop_oldest(self) -> None:
        while len(self._undo) > 1 and _bytes(self._undo) > self._most_bytes:
            del self._undo[0]

    def undo(self, now: State) -> State | None:
        """The state before the last gesture; None if there is none."""
        return self._swap(self._undo, self._redo, now)

    def redo(self, now: State) -> State | None:
        """The state after the gesture undone last; None if there is none."""
        return self._swap(self._redo, self._undo, now)

    @staticmethod
    def _swap(source: list[HistoryEntry], target: list[HistoryEntry], now: State) -> State | None:
        if not source:
            return None
        gesture, state = source.pop()
        target.append(HistoryEntry(gesture, now))
        return state


def _bytes(entries: list[HistoryEntry]) -> int:
    """Bytes of all arrays of the entries, each counted once."""
    return sum({id(array): array.nbytes for entry in entries for array in entry.state.arrays}.values())
