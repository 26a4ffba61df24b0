"""Actions of the window: name, tooltip, icon, shortcut and menu."""

from collections.abc import Callable

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_controller import EditController
from apd_viewer.ui.actions.file_actions import FileActions
from apd_viewer.ui.actions.pose_actions import PoseActions
from apd_viewer.ui.actions.select_actions import SelectActions
from apd_viewer.ui.actions.simulate_actions import SimulateActions
from apd_viewer.ui.actions.view_actions import DisplayActions, ViewActions
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.measuring.measure_controller import MeasureActions
from apd_viewer.ui.preferences.action_maker import ActionMaker, connect_action, without_mnemonic
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry
from apd_viewer.ui.widgets.display_names import menu_text

_KEYS = QKeySequence.StandardKey


class Actions:
    """All actions of a window, in its menus.

    Attributes
    ----------
    help : dict of str to QAction
        By their names.
    """

    def __init__(self, menus: WindowMenus, commands: Commands) -> None:
        self._maker = menus.maker
        self.tools, self.bar = menus.tools, menus.bar
        self.undo, self.redo, self.reset = menus.undo, menus.redo, menus.reset
        self.file = FileActions(menus, commands)
        self._make_edit(commands.edits, commands.open_settings)
        self.measurements = MeasureActions(self._maker, commands.measurements)
        self.select = SelectActions(self._maker, commands)
        self.pose = PoseActions(self._maker, commands)
        self.simulate = SimulateActions(menus, commands)
        self.view = ViewActions(menus, commands)
        self.display = DisplayActions(self._maker, commands.display_options, commands.region_picture)
        self.help = help_actions(self._maker, commands)
        self._fill(*menus.make_empty_menus())

    def _make_edit(self, editing: EditController, open_settings: Callable[[], object]) -> None:
        make = self._maker.make
        connect_action(self.undo, editing.undo)
        connect_action(self.redo, editing.redo)
        connect_action(self.reset, editing.reset_all)
        tip = tr("Make this shape the rest shape: its area becomes 100 %")
        self.bake = make("bake", tr("&Bake as rest shape"), "bake", tip, "Ctrl+Shift+R", editing.bake)
        tip = tr("Change units, colours, language, autosave and other settings of the program")
        self.settings = make("settings", tr("Se&ttings…"), "settings", tip, "Ctrl+,", open_settings)
        self.settings.setMenuRole(QAction.MenuRole.PreferencesRole)  # in the application menu on macOS

    def _fill(
        self,
        file: QMenu,
        edit: QMenu,
        tools: QMenu,
        select: QMenu,
        handle: QMenu,
        simulate: QMenu,
        view: QMenu,
        helps: QMenu,
    ) -> None:
        self.file.add_to_menu(file)
        edit.addActions([self.undo, self.redo])
        edit.addSeparator()
        edit.addActions([self.reset, self.bake])
        edit.addSeparator()
        edit.addAction(self.settings)
        tools.addActions(list(self.tools.values()))
        self.measurements.add_to_menu(tools)
        self.select.add_to_menu(select)
        self.pose.add_to_menu(handle)
        self.simulate.add_to_menu(simulate)
        self.view.add_to_menu(view, self.display)
        helps.addActions(list(self.help.values()))

    def enable_actions(self, is_open: bool, is_at_rest: bool) -> None:
        """Enable the actions possible with an open mesh, at rest or deformed."""
        own = [*self.file.mesh_actions, *self.simulate.mesh_actions, self.pose.symmetric]
        for action in (*own, *self.select.files, *self.select.changes):
            action.setEnabled(is_open)
        for action in (self.reset, self.bake):
            action.setEnabled(is_open and not is_at_rest)

    def follow_document(self, document: Document) -> None:
        """Enable the actions applicable to a document and its mesh file."""
        self.file.follow_document(document)
        self.select.follow_document(document)
        self.display.follow_document(document)

    def add_panel_actions(self, actions: list[QAction]) -> None:
        """Add actions to show or hide the panels to the View menu."""
        for action in actions:
            tip = tr("Show or hide the panel “{title}”").format(title=without_mnemonic(action.text()))
            name = f"panel:{action.objectName()}"
            image = f"panel-{action.objectName()}"
            self._maker.adopt(name, action, image, tip, tuple(action.shortcuts()))
        self.view.add_panel_actions(actions)

    @property
    def entries(self) -> list[ShortcutEntry]:
        """All actions with their texts and default keys."""
        return self._maker.entries

    def show_history(self, undo: str | None, redo: str | None) -> None:
        """Show the names of the steps to undo and redo in the Edit menu."""
        for action, bare, verb, gesture in (
            (self.undo, tr("&Undo"), tr("&Undo “{gesture}”"), undo),
            (self.redo, tr("&Redo"), tr("&Redo “{gesture}”"), redo),
        ):
            action.setText(verb.format(gesture=menu_text(gesture)) if gesture else bare)
            action.setEnabled(gesture is not None)


def help_actions(maker: ActionMaker, commands: Commands) -> dict[str, QAction]:
    """Help actions by name, in menu order; the help controller connects some of them."""
    manual = tr("Open the manual in the browser; it needs no network")
    ask = tr("Click anything to open the manual there; by its key at once, at the mouse")
    find = tr("Type what you want to do, and run the command from there")
    keys = tr("View and change the keyboard shortcuts")
    tour = tr("Learn the program in five steps, on a bottle")
    rows: list[tuple[str, str, str, str, object]] = [
        ("manual", tr("&Manual"), "manual", manual, None),
        ("help", tr("&What is this?"), "help", ask, _KEYS.HelpContents),
        ("find_command", tr("&Find a command…"), "find", find, ("Ctrl+F", "F3")),
        ("shortcuts", tr("&Shortcuts…"), "keyboard", keys, ("Shift+F1", "?")),
        ("tour", tr("&Tour"), "tour", tour, None),
    ]
    return {row[0]: maker.make(*row) for row in rows} | _other_help(maker, commands)


def _other_help(maker: ActionMaker, commands: Commands) -> dict[str, QAction]:
    tables = tr("Reproduce the tables of Li and Hui, with figures")
    verified = tr("Run cases with exact answers, and see how far off this program is")
    copied = tr("Copy versions, graphics driver and the end of the log, for a bug report")
    about = tr("Version, licence and source of the method")
    copy = commands.reports.copy_diagnostics
    rows: list[tuple[str, str, str, str, object, Callable[[], object]]] = [
        ("paper", tr("The &paper's tables…"), "paper", tables, None, commands.runs.open_paper),
        ("verify", tr("&Verify…"), "verify", verified, None, commands.runs.open_verification),
        ("copy_diagnostics", tr("&Copy diagnostics"), "copy-diagnostics", copied, None, copy),
        ("about", tr("&About APD Viewer"), "about", about, None, commands.show_about_box),
    ]
    return {row[0]: maker.make(*row) for row in rows}
