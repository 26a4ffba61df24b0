"""Actions with a name, a title, a tip, an icon and, if they have any, keys."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow

from apd_viewer.ui.preferences.shortcuts import ShortcutEntry
from apd_viewer.ui.widgets.theme import Theme, icon

NAME_PROPERTY = "actionName"  # property of an action, by which the manual knows it


class ActionMaker:
    """Makes the actions of a window, and redraws their icons.

    Parameters
    ----------
    window : QMainWindow
        Their parent.

    Attributes
    ----------
    entries : list of ShortcutEntry
        All that was made.
    """

    def __init__(self, window: QMainWindow) -> None:
        self._window = window
        self.entries: list[ShortcutEntry] = []

    def make(
        self, name: str, title: str, image: str, tip: str, key: object, command: Callable[[], object]
    ) -> QAction:
        """Make an action for a command.

        ``name`` is what settings know it by: whoever gives it another takes away the keys that were chosen
        for it.
        """
        action = QAction(title, self._window)
        action.triggered.connect(lambda _checked=False: command())
        return self.adopt(name, action, image, tip, key)

    def make_checkable(
        self,
        name: str,
        title: str,
        image: str,
        tip: str,
        key: object,
        command: Callable[[bool], object],
        on: bool = False,
    ) -> QAction:
        """Make a checkable action for a command."""
        action = QAction(title, self._window, checkable=True, checked=on)
        action.toggled.connect(lambda on: command(on))
        return self.adopt(name, action, image, tip, key)

    def adopt(self, name: str, action: QAction, image: str, tip: str, key: object) -> QAction:
        """Give an action tip, icon and keys, and remember its keys by its name."""
        keys = key if isinstance(key, tuple) else () if key is None else (key,)
        action.setProperty(NAME_PROPERTY, name)
        action.setShortcuts([QKeySequence(one) for one in keys])
        action.setStatusTip(tip)
        action.setIconVisibleInMenu(not action.isCheckable())  # a tick stands in its place
        self.entries.append(
            ShortcutEntry.from_action(action, name, without_mnemonic(action.text()), image, tip)
        )
        return action

    def make_exclusive(self, actions: Iterable[QAction]) -> None:
        """Have one of the actions checked at a time."""
        group = QActionGroup(self._window)
        for action in actions:
            action.setCheckable(True)
            action.setIconVisibleInMenu(False)
            group.addAction(action)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        for entry in self.entries:
            entry.action.setIcon(icon(entry.image, theme))


def without_mnemonic(text: str) -> str:
    """Text of an action or menu without its mnemonic, in any script."""
    return re.sub(r"&(.)", r"\1", re.sub(r"\(&\w\)", "", text)).rstrip("…")
