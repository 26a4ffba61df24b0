"""Actions of the window: name, tip, icon, shortcut and menu."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow

from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_controller import EditController
from apd_viewer.ui.actions.file_actions import FileActions
from apd_viewer.ui.actions.inert_chrome import add_tool_bar
from apd_viewer.ui.actions.pose_actions import PoseActions
from apd_viewer.ui.actions.select_actions import SelectActions
from apd_viewer.ui.actions.view_actions import DisplayActions, ViewActions
from apd_viewer.ui.measuring.measure_controller import MeasureActions
from apd_viewer.ui.obstacles.obstacle_actions import ObstacleActions
from apd_viewer.ui.preferences.action_maker import ActionMaker, without_mnemonic
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry
from apd_viewer.ui.tools.toolbox import Tool
from apd_viewer.ui.widgets.display_names import menu_text
from apd_viewer.ui.widgets.theme import Theme

_KEYS = QKeySequence.StandardKey


class Actions:
    """The actions, menus and the tool bar of a window.

    Parameters
    ----------
    window : QMainWindow
        Also their parent.
    commands : Commands

    Attributes
    ----------
    file : FileActions
    undo, redo, reset, bake, settings : QAction
    tools : dict of Tool to QAction
    measurements : MeasureActions
    select : SelectActions
    pose : PoseActions
    obstacles : ObstacleActions
    view : ViewActions
    display : DisplayActions
    help : dict of str to QAction
        By their names.
    bar : QToolBar
    """

    def __init__(self, window: QMainWindow, commands: Commands) -> None:
        self._window = window
        self._maker = ActionMaker(window)
        self.file = FileActions(self._maker, commands)
        self._make_edit(commands.edits, commands.open_settings)
        self._make_tools(commands.choose_tool)
        self.measurements = MeasureActions(self._maker, commands.measurements)
        self.select = SelectActions(self._maker, commands)
        self.pose = PoseActions(self._maker, commands)
        self.obstacles = ObstacleActions(self._maker, commands.obstacles)
        self.view = ViewActions(self._maker, commands)
        self.display = DisplayActions(self._maker, commands.display_options)
        self.help = help_actions(self._maker, commands)
        self._fill_menus()
        groups = (
            [self.file.open, self.file.export],
            list(self.tools.values()),
            [self.undo, self.redo, self.reset],
            [self.view.frame],
        )
        self.bar = add_tool_bar(window, groups)

    def _make_edit(self, editing: EditController, open_settings: Callable[[], object]) -> None:
        make = self._maker.make
        self.undo = make("undo", tr("&Undo"), "undo", tr("Undo the last step"), _KEYS.Undo, editing.undo)
        self.redo = make("redo", tr("&Redo"), "redo", tr("Redo the last step"), _KEYS.Redo, editing.redo)
        self.reset = make(
            "reset",
            tr("Re&set all handles"),
            "reset",
            tr("Reset all handles and return the mesh to its rest shape"),
            "Ctrl+R",
            editing.reset_all,
        )
        self.bake = make(
            "bake",
            tr("&Bake as rest shape"),
            "bake",
            tr("Make this shape the rest shape: its area becomes 100 %"),
            "Ctrl+Shift+R",
            editing.bake,
        )
        tip = tr("Change units, colours, language, autosave and other settings of the program")
        self.settings = make("settings", tr("Se&ttings…"), "settings", tip, "Ctrl+,", open_settings)
        self.settings.setMenuRole(QAction.MenuRole.PreferencesRole)  # where macOS has its own place

    def _make_tools(self, take: Callable[[Tool], object]) -> None:
        self.tools: dict[Tool, QAction] = {}
        for tool in Tool:
            name, words = f"take:{tool.name}", tool.words
            self.tools[tool] = self._maker.make(
                name, words.title, words.icon, words.tip, words.key, partial(take, tool)
            )
        self._maker.make_exclusive(self.tools.values())

    def _fill_menus(self) -> None:
        bar = self._window.menuBar()
        self.file.fill(bar.addMenu(tr("&File")))
        edit = bar.addMenu(tr("&Edit"))
        edit.addActions([self.undo, self.redo])
        edit.addSeparator()
        edit.addActions([self.reset, self.bake])
        edit.addSeparator()
        edit.addAction(self.settings)
        tools = bar.addMenu(tr("&Tools"))
        tools.addActions(list(self.tools.values()))
        self.measurements.fill(tools)
        self.select.fill(bar.addMenu(tr("&Select")))
        self.pose.fill(bar.addMenu(tr("H&andle")), self.obstacles)
        self.view.fill(bar.addMenu(tr("&View")), self.display)
        bar.addMenu(tr("&Help")).addActions(list(self.help.values()))

    def set_available(self, is_open: bool, is_at_rest: bool) -> None:
        """Enable the actions allowed by an open mesh, at rest or not."""
        studies = [self.pose.compare, self.pose.sweep, self.pose.study, self.pose.press]
        own = [*self.file.mesh_actions, *studies, self.pose.symmetric, *self.obstacles.mesh_actions]
        for action in (*own, *self.select.files, *self.select.changes):
            action.setEnabled(is_open)
        for action in (self.reset, self.bake):
            action.setEnabled(is_open and not is_at_rest)

    def follow(self, document: Document) -> None:
        """Offer what a document and the file of its mesh have."""
        self.file.follow(document)
        self.display.follow(document)

    def add_panels(self, actions: list[QAction]) -> None:
        """Add the switches of the panels to the View menu."""
        for action in actions:
            tip = tr("Show or hide the panel “{title}”").format(title=without_mnemonic(action.text()))
            name = f"panel:{action.objectName()}"
            self._maker.adopt(name, action, "panel", tip, tuple(action.shortcuts()))
        self.view.add_panels(actions)

    @property
    def entries(self) -> list[ShortcutEntry]:
        """All actions with their descriptions."""
        return self._maker.entries

    def show_history(self, undo: str | None, redo: str | None) -> None:
        """Name the steps to undo and redo."""
        for action, bare, verb, gesture in (
            (self.undo, tr("&Undo"), tr("&Undo “{gesture}”"), undo),
            (self.redo, tr("&Redo"), tr("&Redo “{gesture}”"), redo),
        ):
            action.setText(verb.format(gesture=menu_text(gesture)) if gesture else bare)
            action.setEnabled(gesture is not None)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._maker.set_theme(theme)


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
