"""Actions of the menu Help."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QAction, QKeySequence

from apd_viewer.language import tr
from apd_viewer.ui.actions.action_maker import ActionMaker
from apd_viewer.ui.actions.commands import Commands

# Name, title, icon, tip, keys and command.
_Row = tuple[str, str, str, str, object, "Callable[[], object]"]


def help_actions(maker: ActionMaker, commands: Commands) -> dict[str, QAction]:
    """Actions by their names, in menu order."""
    return {row[0]: maker.make(*row) for row in (*_of_the_manual(commands), *_others(commands))}


def _of_the_manual(commands: Commands) -> list[_Row]:
    helps = commands.help  # called later: it is made of the actions
    manual = tr("Open the manual in the browser; it needs no network")
    ask = tr("Click anything to open the manual there; by its key at once, at the mouse")
    find = tr("Type what you want to do, and run the command from there")
    keys = tr("View and change the keyboard shortcuts")
    tour = tr("Learn the program in five steps, on a bottle")
    help_key, find_keys = QKeySequence.StandardKey.HelpContents, ("Ctrl+F", "F3")
    return [
        ("manual", tr("&Manual"), "manual", manual, None, lambda: helps().open_manual()),
        ("help", tr("&What is this?"), "help", ask, help_key, lambda: helps().explain_next_click()),
        ("find_command", tr("&Find a command…"), "find", find, find_keys, lambda: helps().open_search()),
        ("shortcuts", tr("&Shortcuts…"), "keyboard", keys, ("Shift+F1", "?"), lambda: helps().open_sheet()),
        ("tour", tr("&Tour"), "tour", tour, None, lambda: helps().begin_tour()),
    ]


def _others(commands: Commands) -> list[_Row]:
    tables = tr("Reproduce the tables of Li and Hui, with figures")
    copied = tr("Copy versions, graphics driver and the end of the log, for a bug report")
    about = tr("Version, licence and source of the method")
    copy = commands.reports.copy_diagnostics
    return [
        ("paper", tr("The &paper's tables…"), "tables", tables, None, commands.runs.open_paper),
        ("copy_diagnostics", tr("&Copy diagnostics"), "copy", copied, None, copy),
        ("about", tr("&About APD Viewer"), "about", about, None, commands.show_about_box),
    ]
