"""Entries of the menus, with the titles of their menus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QMenuBar

from apd_viewer.language import tr
from apd_viewer.ui.actions.action_maker import without_mnemonic


class MenuEntry(NamedTuple):
    """An entry, with the titles of its menu and of its submenu, if any."""

    menu: str
    submenu_title: str
    action: QAction

    def full_title(self, title: str) -> str:
        """Title prefixed by the submenu's, unless they repeat each other."""
        if not self.submenu_title or title.startswith(self.submenu_title):
            return title
        return tr("{menu}: {title}").format(menu=self.submenu_title, title=title)


def menu_entries(bar: QMenuBar) -> Iterator[MenuEntry]:
    """All entries of a menu bar, in its order."""
    for top in bar.actions():
        for action, within in _leaves(submenu(top)):
            yield MenuEntry(without_mnemonic(top.text()), within, action)


def submenu(action: QAction) -> QMenu:
    """Menu of an action."""
    menu = action.menu()
    assert isinstance(menu, QMenu)
    return menu


def _leaves(menu: QMenu, within: str = "") -> Iterator[tuple[QAction, str]]:
    """Actions of a menu with the titles of their submenus."""
    for action in menu.actions():
        if action.menu() is not None:
            yield from _leaves(submenu(action), without_mnemonic(action.text()))
        elif not action.isSeparator():
            yield action, within
