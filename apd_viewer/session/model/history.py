"""Undo and redo: two stacks of states, one entry per gesture."""

import sys
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from apd_viewer.session.model.state import State

_MANY = 1000  # longest list measured item by item; longer ones are estimated from the first item


@dataclass(frozen=True, eq=False)
class HistoryEntry:
    """Gesture with the state before it for undo, or after it for redo."""

    gesture: str
    state: State

    @cached_property
    def array_bytes(self) -> dict[int, int]:
        """Memory held by the entry in bytes; see :func:`array_bytes`."""
        return array_bytes(self.state)


class History:
    """Undo and redo stacks within a memory budget.

    Parameters
    ----------
    most_bytes : int
        The oldest entries go when the states together pass this. At least one always stays.

    Attributes
    ----------
    undo_bytes : int
        Memory of the states that can be undone.
    entries_dropped : callable
        Called after entries were dropped.
    """

    def __init__(self, most_bytes: int = 512 * 2**20) -> None:
        self.most_bytes = most_bytes
        self._undo: list[HistoryEntry] = []
        self._redo: list[HistoryEntry] = []
        self._keepers = Counter[int]()  # number of undo entries holding each object in memory
        self.undo_bytes = 0
        self.entries_dropped: Callable[[], object] = lambda: None

    @property
    def last_entry(self) -> HistoryEntry | None:
        """Next entry to undo; stays identical while repeated keys are merged into it."""
        return self._undo[-1] if self._undo else None

    @property
    def next_undo_name(self) -> str | None:
        """Name of the next gesture to undo."""
        return self._undo[-1].gesture if self._undo else None

    @property
    def next_redo_name(self) -> str | None:
        """Name of the next gesture to redo."""
        return self._redo[-1].gesture if self._redo else None

    @property
    def undo_names(self) -> list[str]:
        """Names of the gestures on the undo stack, oldest first."""
        return [entry.gesture for entry in self._undo]

    @property
    def redo_names(self) -> list[str]:
        """Names of the gestures on the redo stack, next first."""
        return [entry.gesture for entry in reversed(self._redo)]

    @property
    def undo_states(self) -> list[State]:
        """States on the undo stack, oldest first."""
        return [entry.state for entry in self._undo]

    @property
    def reachable_states(self) -> list[State]:
        """States within reach of undo and redo."""
        return [entry.state for entry in (*self._undo, *self._redo)]

    def record(self, gesture: str, before: State) -> None:
        """Push the state before a finished gesture."""
        undone, self._redo = self._redo, []
        self._push(HistoryEntry(gesture, before))
        self._drop_oldest(undone)

    def limit_memory(self, most_bytes: int) -> None:
        """Set the memory budget, and drop entries beyond it."""
        self.most_bytes = most_bytes
        self._drop_oldest([])

    def _drop_oldest(self, dropped: list[HistoryEntry]) -> None:
        while len(self._undo) > 1 and self.undo_bytes > self.most_bytes:
            dropped.append(self._pop(0))
        if dropped:
            dropped.clear()  # release the states' memory before the callback
            self.entries_dropped()

    def undo(self, state: State) -> State | None:
        """State before the last gesture; None if there is none."""
        if not self._undo:
            return None
        entry = self._pop(-1)
        self._redo.append(HistoryEntry(entry.gesture, state))
        return entry.state

    def redo(self, state: State) -> State | None:
        """State after the last undone gesture; None if there is none."""
        if not self._redo:
            return None
        entry = self._redo.pop()
        self._push(HistoryEntry(entry.gesture, state))
        return entry.state

    def _push(self, entry: HistoryEntry) -> None:
        self._undo.append(entry)
        for key, size in entry.array_bytes.items():
            self.undo_bytes += 0 if self._keepers[key] else size
            self._keepers[key] += 1

    def _pop(self, k: int) -> HistoryEntry:
        entry = self._undo.pop(k)
        for key, size in entry.array_bytes.items():
            self._keepers[key] -= 1
            if not self._keepers[key]:
                del self._keepers[key]
                self.undo_bytes -= size
        return entry


def array_bytes(value: object) -> dict[int, int]:
    """Sizes in bytes of the arrays and file contents within a value, by identity.

    Searches all objects of this package, and tuples, lists and dictionaries.
    """
    found: dict[int, int] = {}
    seen, left = set[int](), [value]
    while left:
        each = left.pop()
        if id(each) in seen:
            continue
        seen.add(id(each))
        if isinstance(each, np.ndarray | bytes):
            owner, size = _owner(each)
            found[id(owner)] = size
        elif isinstance(each, list | tuple) and len(each) > _MANY:
            found[id(each)] = len(each) * sum(map(sys.getsizeof, (each[0], *_items(each[0]))))
        else:
            left += _items(each)
    return found


def _owner(array: np.ndarray | bytes) -> tuple[np.ndarray | bytes, int]:
    """Owner of the memory of an array, and its size in bytes."""
    if isinstance(array, bytes):
        return array, len(array)
    while isinstance(array.base, np.ndarray):
        array = array.base
    base = array.base.obj if isinstance(array.base, memoryview) else array.base
    return (base, len(base)) if isinstance(base, bytes) else (array, array.nbytes)


def _items(value: object) -> Iterable[object]:
    if isinstance(value, list | tuple):
        return value
    if isinstance(value, dict):
        return value.values()
    return getattr(value, "__dict__", {}).values() if type(value).__module__.startswith("apd_viewer.") else ()
