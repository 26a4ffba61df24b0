"""The keys of the actions: what they are, what they were made to be, and whose a key is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence

from apd_viewer.language import tr, trc

if TYPE_CHECKING:
    from apd_viewer.ui.preferences.preferences import Memory

_PORTABLE, _NATIVE = QKeySequence.SequenceFormat.PortableText, QKeySequence.SequenceFormat.NativeText
_SEVERAL = "; "  # between the keys of an action that has several
# By these one ends what has been begun, and gets about in the window.
_ENDS = "Return", "Enter", "Esc", "Tab", "Backtab", "Space"
_WALKS = "Left", "Right", "Up", "Down", "Home", "End", "PgUp", "PgDown"


def split(keys: str) -> list[str]:
    """The single keys of an action."""
    return [key for key in keys.split(_SEVERAL) if key]


def native(keys: str) -> str:
    """Keys as the platform writes them."""
    return trc("keys", " or ").join(QKeySequence(key, _PORTABLE).toString(_NATIVE) for key in split(keys))


@dataclass(eq=False)
class Entry:
    """An action with all that is said of it.

    Parameters
    ----------
    name : str
        Under which its keys are remembered.
    action : QAction
    title, image, tip : str
        The image is the name of an icon.
    standard : str
        The keys that it is made with, as all keys here: as Qt writes them on every platform.
    """

    name: str
    action: QAction
    title: str
    image: str
    tip: str
    standard: str

    @classmethod
    def of(cls, action: QAction, name: str, title: str, image: str, tip: str) -> Entry:
        """An entry whose standard keys are those that the action has now."""
        entry = cls(name, action, title, image, tip, keys_of(action))
        entry.keys = entry.standard
        return entry

    @property
    def keys(self) -> str:
        """The keys that it has; empty where it has none."""
        return keys_of(self.action)

    @keys.setter
    def keys(self, keys: str) -> None:
        self.action.setShortcuts([QKeySequence(key, _PORTABLE) for key in split(keys)])
        said = f" ({native(keys)})" if keys else ""
        self.action.setToolTip(f"<b>{self.title}</b>{said}<br>{self.tip}")

    @property
    def is_changed(self) -> bool:
        """Whether its keys are not the standard ones."""
        return self.keys != self.standard


def keys_of(action: QAction) -> str:
    """The keys of an action; empty where it has none."""
    return _SEVERAL.join(key.toString(_PORTABLE) for key in action.shortcuts())


class Shortcuts:
    """All actions, with the keys that were chosen for them.

    Parameters
    ----------
    entries : iterable of Entry
    mnemonics : dict of str to str
        Keys that open a menu, and its title.
    memory : Memory
    """

    def __init__(self, entries: Iterable[Entry], mnemonics: dict[str, str], memory: Memory) -> None:
        self.entries = list(entries)
        self._mnemonics = mnemonics
        self._memory = memory
        self._recall()

    @property
    def are_changed(self) -> bool:
        """Whether any action has other keys than the standard ones."""
        return any(entry.is_changed for entry in self.entries)

    def refusal(self, entry: Entry, keys: str) -> str:
        """Why an action cannot have these keys; empty where it can."""
        # What the keys do on the canvas alone takes nothing from the rest of the window.
        everywhere = entry.action.shortcutContext() != Qt.ShortcutContext.WidgetShortcut
        kept = _ENDS + _WALKS if everywhere else _ENDS
        for key in split("" if keys == entry.standard else keys):
            if key.removeprefix("Shift+") in kept:
                return tr("{keys} is reserved for navigation in the window; choose other keys.").format(
                    keys=native(key)
                )
            if key in self._mnemonics:
                return tr("{keys} opens the menu “{menu}”; choose other keys.").format(
                    keys=native(key), menu=self._mnemonics[key]
                )
        return ""

    def holder(self, keys: str, besides: Entry) -> Entry | None:
        """Who else has one of the keys."""
        wanted = set(split(keys))
        others = (entry for entry in self.entries if entry is not besides)
        return next((entry for entry in others if wanted & set(split(entry.keys))), None)

    def give(self, entry: Entry, keys: str) -> None:
        """Give keys to an action; whoever loses all of its own by that gets those that become free."""
        free = _SEVERAL.join(key for key in split(entry.keys) if key not in split(keys))
        entry.keys = ""
        while other := self.holder(keys, entry):
            left = [key for key in split(other.keys) if key not in split(keys)]
            passed = "" if left or self.refusal(other, free) else free
            other.keys = _SEVERAL.join(left) or passed
            free = "" if passed else free
        entry.keys = keys
        self._remember()

    def reset_all(self) -> None:
        """Give all actions their standard keys."""
        for entry in self.entries:
            entry.keys = entry.standard
        self._remember()

    def _remember(self) -> None:
        self._memory.shortcuts = {entry.name: entry.keys for entry in self.entries if entry.is_changed}

    def _recall(self) -> None:
        """Apply what was chosen; what another action has by then as its standard gives way to it."""
        chosen = self._memory.shortcuts
        changed = [entry for entry in self.entries if _can_be_read(chosen.get(entry.name))]
        for entry in changed:
            entry.keys = ""
        for entry in changed:
            keys = chosen[entry.name]
            while other := self.holder(keys, entry):
                other.keys = _SEVERAL.join(key for key in split(other.keys) if key not in split(keys))
            entry.keys = keys


def _can_be_read(keys: str | None) -> bool:
    """Whether keys from the settings are keys: anybody may have edited them."""
    return keys is not None and all(QKeySequence(key, _PORTABLE).toString() == key for key in split(keys))
