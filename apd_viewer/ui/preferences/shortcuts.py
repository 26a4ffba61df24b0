"""Shortcuts of the actions: defaults, changes, conflicts and tips."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QWidget

from apd_viewer.language import tr, trc
from apd_viewer.ui.preferences.preferences import Preferences

_PORTABLE, _NATIVE = QKeySequence.SequenceFormat.PortableText, QKeySequence.SequenceFormat.NativeText
_SEVERAL = "; "  # separates alternative keys of an action
# Reserved: they cancel, accept and navigate in the window.
_ENDS = "Return", "Enter", "Esc", "Tab", "Backtab", "Space"
_WALKS = "Left", "Right", "Up", "Down", "Home", "End", "PgUp", "PgDown"


def split_keys(keys: str) -> list[str]:
    """Key sequences of an action, split at the separator."""
    return [key for key in keys.split(_SEVERAL) if key]


def native_keys(keys: str) -> str:
    """Keys in the notation of the platform."""
    return trc("keys", " or ").join(
        QKeySequence(key, _PORTABLE).toString(_NATIVE) for key in split_keys(keys)
    )


@dataclass(eq=False)
class ShortcutEntry:
    """Action with its texts and default keys.

    Parameters
    ----------
    name : str
        Under which its keys are remembered.
    title, image, tip : str
        The image is the name of an icon.
    default_keys : str
        The keys that it is made with, as all keys here: as Qt writes them on every platform.
    """

    name: str
    action: QAction
    title: str
    image: str
    tip: str
    default_keys: str

    @classmethod
    def from_action(cls, action: QAction, name: str, title: str, image: str, tip: str) -> ShortcutEntry:
        """Entry with the action's current keys as its defaults."""
        entry = cls(name, action, title, image, tip, keys_of(action))
        entry.keys = entry.default_keys
        return entry

    @property
    def keys(self) -> str:
        """Current keys; empty if none."""
        return keys_of(self.action)

    @keys.setter
    def keys(self, keys: str) -> None:
        self.action.setShortcuts([QKeySequence(key, _PORTABLE) for key in split_keys(keys)])
        self.action.setToolTip(self.full_tip)

    @property
    def full_tip(self) -> str:
        """Tooltip of title, current keys and description."""
        said = f" ({native_keys(self.keys)})" if self.keys else ""
        return f"{self.title}{said}\n{self.tip}"

    @property
    def is_changed(self) -> bool:
        """True if the keys differ from the defaults."""
        return self.keys != self.default_keys


def keys_of(action: QAction) -> str:
    """Current keys of an action; empty if none."""
    return _SEVERAL.join(key.toString(_PORTABLE) for key in action.shortcuts())


class Shortcuts:
    """Actions with their default and user-defined keys.

    Parameters
    ----------
    mnemonics : dict of str to str
        Keys that open a menu, and its title.
    """

    def __init__(
        self, entries: Iterable[ShortcutEntry], mnemonics: dict[str, str], preferences: Preferences
    ) -> None:
        self.entries = list(entries)
        self._mnemonics = mnemonics
        self._memory = preferences
        self._recall()

    @property
    def has_changes(self) -> bool:
        """True if the keys of any action differ from the defaults."""
        return any(entry.is_changed for entry in self.entries)

    def refusal(self, entry: ShortcutEntry, keys: str) -> str:
        """Reason to refuse these keys for an action; empty if allowed."""
        # Keys handled by the canvas alone do not conflict with the rest of the window.
        everywhere = entry.action.shortcutContext() != Qt.ShortcutContext.WidgetShortcut
        kept = _ENDS + _WALKS if everywhere else _ENDS
        for key in split_keys("" if keys == entry.default_keys else keys):
            if key.removeprefix("Shift+") in kept:
                return tr("{keys} is reserved for navigation in the window; choose other keys.").format(
                    keys=native_keys(key)
                )
            if key in self._mnemonics:
                return tr("{keys} opens the menu “{menu}”; choose other keys.").format(
                    keys=native_keys(key), menu=self._mnemonics[key]
                )
        return ""

    def conflicting_entry(self, keys: str, besides: ShortcutEntry) -> ShortcutEntry | None:
        """Another action using one of the keys; None if there is none."""
        wanted = set(split_keys(keys))
        others = (entry for entry in self.entries if entry is not besides)
        return next((entry for entry in others if wanted & set(split_keys(entry.keys))), None)

    def assign_keys(self, entry: ShortcutEntry, keys: str) -> None:
        """Assign keys to an action; an action that loses them gets the old ones."""
        free = _SEVERAL.join(key for key in split_keys(entry.keys) if key not in split_keys(keys))
        entry.keys = ""
        while other := self.conflicting_entry(keys, entry):
            left = [key for key in split_keys(other.keys) if key not in split_keys(keys)]
            passed = "" if left or self.refusal(other, free) else free
            other.keys = _SEVERAL.join(left) or passed
            free = "" if passed else free
        entry.keys = keys
        self._remember()

    def reset_all(self) -> None:
        """Reset all actions to their default keys."""
        for entry in self.entries:
            if entry.is_changed:
                entry.keys = entry.default_keys
        self._remember()

    def _remember(self) -> None:
        self._memory.shortcuts = {entry.name: entry.keys for entry in self.entries if entry.is_changed}

    def _recall(self) -> None:
        """Apply the stored user-defined keys, overriding conflicting defaults."""
        chosen = self._memory.shortcuts
        changed = [entry for entry in self.entries if _can_be_read(chosen.get(entry.name))]
        for entry in changed:
            entry.keys = ""
        for entry in changed:
            keys = chosen[entry.name]
            while other := self.conflicting_entry(keys, entry):
                other.keys = _SEVERAL.join(
                    key for key in split_keys(other.keys) if key not in split_keys(keys)
                )
            entry.keys = keys


def _can_be_read(keys: str | None) -> bool:
    """True if stored keys are valid: the settings may have been edited by hand."""
    return keys is not None and all(
        QKeySequence(key, _PORTABLE).toString() == key for key in split_keys(keys)
    )


def text_with_keys(words: str, action: QAction) -> str:
    """Text followed by the current keys of an action, if any."""
    keys = native_keys(keys_of(action))
    return tr("{words} ({keys})").format(words=words, keys=keys) if keys else words


def show_shortcut_in_tooltip(widget: QWidget, action: QAction) -> None:
    """Show the current keys of an equivalent action in a widget's tooltip."""
    tip = widget.toolTip()

    def say() -> None:
        widget.setToolTip(text_with_keys(tip, action))

    action.changed.connect(say)
    say()
