"""What each menu entry and control of the window is called and does, from its own texts."""

from __future__ import annotations

from PySide6.QtWidgets import QToolButton
from window_tour import widgets

from apd_viewer.ui.help.context_help import section_name
from apd_viewer.ui.help.searchable import is_control, is_section_heading, menu_entries, texts_of
from apd_viewer.ui.settings_page.settings_dialog import SETTING_PROPERTY
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
    """Section, title and tip of each control; entries and preferences have pages of their own."""
    rows = {
        (section_name(widget), *texts_of(widget)): None
        for widget in filter(is_control, widgets())
        if not is_section_heading(widget) and not widget.property(SETTING_PROPERTY)
        if not isinstance(widget, QToolButton) or widget.defaultAction() is None
    }
    return [row for row in rows if row[0]]
