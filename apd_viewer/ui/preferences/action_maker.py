"""Factory of actions with a name, title, tooltip, icon and optional shortcuts."""

import re
from collections.abc import Callable, Iterable

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow

from apd_viewer.ui.preferences.shortcuts import ShortcutEntry
from apd_viewer.ui.widgets.theme import Theme, icon

NAME_PROPERTY = "actionName"  # property of an action with its name in the manual


class ActionMaker:
    """Factory of a window's actions; also redraws their icons.

    Parameters
    ----------
    window : QMainWindow
        Parent of the actions.

    Attributes
    ----------
    entries : list of ShortcutEntry
        All that was made.
    """

    def __init__(self, window: QMainWindow) -> None:
        self._window = window
        self.entries: list[ShortcutEntry] = []

    def make(
        self,
        name: str,
        title: str,
        image: str,
        tip: str,
        key: object,
        command: Callable[[], object] | None = None,
    ) -> QAction:
        """Make an action for a command; one that has none yet is disabled.

        ``name`` is its key in the settings: renaming an action would discard the shortcut chosen by the
        user.
        """
        action = QAction(title, self._window, enabled=False)
        if command is not None:
            connect_action(action, command)
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
        action = QAction(title, self._window, checkable=True, checked=on, toggled=lambda on: command(on))
        return self.adopt(name, action, image, tip, key)

    def adopt(self, name: str, action: QAction, image: str, tip: str, key: object) -> QAction:
        """Give an existing action a tooltip, icon and keys, and register its name."""
        keys = key if isinstance(key, tuple) else () if key is None else (key,)
        action.setProperty(NAME_PROPERTY, name)
        action.setShortcuts([QKeySequence(one) for one in keys])
        action.setStatusTip(tip)
        action.setIconVisibleInMenu(not action.isCheckable())  # a check mark replaces the icon
        self.entries.append(
            ShortcutEntry.from_action(action, name, without_mnemonic(action.text()), image, tip)
        )
        return action

    def make_exclusive(self, actions: Iterable[QAction]) -> None:
        """Group actions so that exactly one is checked at a time."""
        group = QActionGroup(self._window)
        for action in actions:
            action.setCheckable(True)
            action.setIconVisibleInMenu(False)
            group.addAction(action)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        for entry in self.entries:
            entry.action.setIcon(icon(entry.image, theme))


def connect_action(action: QAction, command: Callable[[], object]) -> None:
    """Enable an action to run a command, whether it is checked or not."""
    action.setEnabled(True)
    action.triggered.connect(lambda _checked=False: command())


def without_mnemonic(text: str) -> str:
    """Text of an action or menu without mnemonics such as ``&F`` or ``(&F)``."""
    return re.sub(r"&(.)", r"\1", re.sub(r"\(&\w\)", "", text)).rstrip("…")
