"""Entries of the menus, with the titles of their menus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QMenuBar

from apd_viewer.language import tr
from apd_viewer.ui.actions.action_factory import plain


class MenuEntry(NamedTuple):
    """An entry, with the titles of its menu and of its submenu, if any."""

    menu: str
    within: str
    action: QAction

    def full(self, title: str) -> str:
        """Title prefixed by the submenu's, unless they repeat each other."""
        if not self.within or title.startswith(self.within):
            return title
        return tr("{menu}: {title}").format(menu=self.within, title=title)


def menu_entries(bar: QMenuBar) -> Iterator[MenuEntry]:
    """All entries of a menu bar, in its order."""
    for top in bar.actions():
        for action, within in _leaves(submenu(top)):
            yield MenuEntry(plain(top.text()), within, action)


def submenu(action: QAction) -> QMenu:
    """Menu of an action."""
    menu = action.menu()
    assert isinstance(menu, QMenu)
    return menu


def _leaves(menu: QMenu, within: str = "") -> Iterator[tuple[QAction, str]]:
    """Actions of a menu with the titles of their submenus."""
    for action in menu.actions():
        if action.menu() is not None:
            yield from _leaves(submenu(action), plain(action.text()))
        elif not action.isSeparator():
            yield action, within
