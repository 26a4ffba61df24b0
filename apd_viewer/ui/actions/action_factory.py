"""Makes actions that are whole: each has a name, a tip, an icon and, if it has one, its keys."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from enum import Enum

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow

from apd_viewer.ui.preferences.shortcuts import Entry
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import Theme


class ActionMaker:
    """Makes the actions of a window, and redraws their icons.

    Parameters
    ----------
    window : QMainWindow
        Their parent.
    verbs : dict
        What to call, by name.

    Attributes
    ----------
    entries : list of Entry
        All that was made.
    """

    def __init__(self, window: QMainWindow, verbs: dict[str, Callable[..., object]]) -> None:
        self._window = window
        self._verbs = verbs
        self.entries: list[Entry] = []

    def make(
        self, text: str, image: str, tip: str, key: object = None, verb: str = "", what: object = None
    ) -> QAction:
        """An action that calls a verb, with ``what`` if that is given."""
        action = QAction(text, self._window)
        given = () if what is None else (what,)
        action.triggered.connect(lambda _checked=False: self._verbs[verb](*given))
        return self.adopt(action, image, tip, key, f"{verb}:{_word(what)}" if given else verb)

    def switch(
        self, text: str, image: str, tip: str, key: object = None, verb: str = "", on: bool = False
    ) -> QAction:
        """An action that is on or off, and calls a verb with which of both."""
        action = QAction(text, self._window, checkable=True, checked=on)
        action.toggled.connect(lambda on: self._verbs[verb](on))
        return self.adopt(action, image, tip, key, verb)

    def adopt(self, action: QAction, image: str, tip: str, key: object, name: str) -> QAction:
        """Give an action tip, icon and keys, and remember its keys by a name."""
        keys = key if isinstance(key, tuple) else () if key is None else (key,)
        action.setShortcuts([QKeySequence(one) for one in keys])
        action.setStatusTip(tip)
        title = plain(action.text())
        entry = Entry.of(action, name, title, image, tip)
        self.entries.append(entry)
        return action

    def one_of(self, actions: Iterable[QAction]) -> None:
        """Have one of the actions checked at a time."""
        group = QActionGroup(self._window)
        for action in actions:
            action.setCheckable(True)
            group.addAction(action)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        for entry in self.entries:
            entry.action.setIcon(icon(entry.image, theme))


def plain(text: str) -> str:
    """The text of an action or a menu without its mnemonic, which other scripts have behind it: 開く(&O)…."""
    return re.sub(r"\(&\w\)", "", text).replace("&", "").rstrip("…")


def _word(what: object) -> str:
    """A word for what a verb is called with."""
    return what.name if isinstance(what, Enum) else str(what).replace(" ", "")
