"""What each menu entry and control of the window is called and does, from its own texts."""

from __future__ import annotations

from window_tour import widgets

from apd_viewer.ui.help.manual_places import control_path, is_named
from apd_viewer.ui.help.searchable import menu_entries, texts_of
from apd_viewer.ui.workbench import Workbench


def listed(window: Workbench) -> list[tuple[str, ...]]:
    """Menu, name, title, keys and tip of each menu entry, in the order of the menus."""
    entries = {entry.action: entry for entry in window.actions_.entries}
    return [
        (found.menu, entry.name, found.full_title(entry.title), entry.keys, entry.tip)
        for found in menu_entries(window.shell.menuBar())
        if (entry := entries.get(found.action)) is not None
    ]


def described() -> list[tuple[str, str, str]]:
    """Path, title and tip of each control; those of a list or mapping have the same path."""
    rows = {}
    for widget in filter(is_named, widgets()):
        path = control_path(widget)
        title, tip = texts_of(widget)
        if path and path[0] not in _ELSEWHERE:
            rows.setdefault(("/".join(path), title), tip)
    return [(path, title, tip) for (path, title), tip in rows.items()]


# Its controls are the preferences, which have a page of their own.
_ELSEWHERE = "choice-control", "number-control"
