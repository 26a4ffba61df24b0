"""The window's actions: each with a name, a tip, an icon, a shortcut and a place in a menu."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar

from apd_viewer.files.samples import SAMPLES
from apd_viewer.language import tr, trc
from apd_viewer.ui.actions.action_factory import ActionMaker, plain
from apd_viewer.ui.actions.display_actions import LookActions
from apd_viewer.ui.actions.pose_actions import PoseActions
from apd_viewer.ui.actions.select_actions import SelectActions
from apd_viewer.ui.preferences.shortcuts import Entry
from apd_viewer.ui.tools.toolbox import Tool
from apd_viewer.ui.widgets.icons import SIZE
from apd_viewer.ui.widgets.theme import Theme

_VIEWS = (
    (trc("view", "Front"), tr("View the mesh from the front"), "1", "front"),
    (trc("view", "Right"), tr("View the mesh from the right"), "3", "side"),
    (trc("view", "Top"), tr("View the mesh from the top"), "7", "top"),
    (trc("view", "Back"), tr("View the mesh from the back"), "Ctrl+1", "-front"),
    (trc("view", "Left"), tr("View the mesh from the left"), "Ctrl+3", "-side"),
    (trc("view", "Bottom"), tr("View the mesh from the bottom"), "Ctrl+7", "-top"),
)
_OPEN_SAMPLE = {
    "bottle": tr("Open the PET bottle, with base and handle painted"),
    "duck": tr("Open the rubber duck, with base and handle painted"),
}
_KEYS = QKeySequence.StandardKey


class Actions:
    """Builds actions, menus and the tool bar of a window; what they do is given by the window.

    Parameters
    ----------
    window : QMainWindow
        Also their parent.
    verbs : dict
        What to call for each name that is used below, such as "open" or "undo".

    Attributes
    ----------
    tools : dict of Tool to QAction
    select : SelectActions
    """

    def __init__(self, window: QMainWindow, verbs: dict[str, Callable[..., object]]) -> None:
        self._window = window
        self._maker = ActionMaker(window, verbs)
        self._verbs = verbs
        self.tools: dict[Tool, QAction] = {}
        self._make_file()
        self._make_edit()
        self._make_tools()
        self.select = SelectActions(self._maker)
        self.pose = PoseActions(self._maker)
        self._make_view()
        self.help = self._make_help()
        self._fill_menus()
        self.bar = self._make_bar()

    def _make_file(self) -> None:
        make = self._maker.make
        self.open = make(tr("&Open…"), "open", tr("Open a mesh or a session"), _KEYS.Open, "open")
        self.export = make(
            tr("&Export…"), "export", tr("Export the deformed mesh to a file"), "Ctrl+E", "export"
        )
        self.save = make(
            tr("&Save session"), "save", tr("Save paint, handles, settings and shape"), _KEYS.Save, "save"
        )
        self.save_as = make(
            tr("Save session &as…"), "save", tr("Save the session to another file"), "Ctrl+Shift+S", "save_as"
        )
        self.report = make(
            tr("&Report…"),
            "report",
            tr("Save pictures, measurements and settings as an HTML page"),
            "Ctrl+Shift+E",
            "report",
        )
        self.picture = make(
            tr("Save &picture…"),
            "picture",
            tr("Save the view as a picture of any size, with or without background"),
            "Ctrl+Shift+P",
            "save_picture",
        )
        self.copy_picture = make(
            tr("&Copy picture"), "copy", tr("Copy the view to the clipboard"), "Ctrl+Shift+C", "copy_picture"
        )
        self.quit = make(tr("&Quit"), "quit", tr("Close the window"), _KEYS.Quit, "quit")
        self.recent = QMenu(tr("Open &recent"), self._window)
        self.samples = QMenu(tr("Open &sample"), self._window)
        for name, title in SAMPLES.items():
            tip = _OPEN_SAMPLE[name]
            self.samples.addAction(make(title, "sample", tip, None, "open_sample", name))

    def _make_edit(self) -> None:
        make = self._maker.make
        self.undo = make(tr("&Undo"), "undo", tr("Undo the last step"), _KEYS.Undo, "undo")
        self.redo = make(tr("&Redo"), "redo", tr("Redo the last step"), _KEYS.Redo, "redo")
        self.reset = make(
            tr("Re&set all handles"),
            "reset",
            tr("Reset all handles and return the mesh to its rest shape"),
            "Ctrl+R",
            "reset",
        )
        self.bake = make(
            tr("&Bake as rest shape"),
            "bake",
            tr("Make this shape the rest shape: its area becomes 100 %"),
            "Ctrl+Shift+R",
            "bake",
        )

    def _make_tools(self) -> None:
        for tool in Tool:
            words = tool.words
            self.tools[tool] = self._maker.make(words.title, words.icon, words.tip, words.key, "take", tool)
        self._maker.one_of(self.tools.values())

    def _make_view(self) -> None:
        make, switch = self._maker.make, self._maker.switch
        self.frame = make(tr("&Frame mesh"), "frame", tr("Zoom to the whole mesh"), "F", "frame")
        self.findings = make(
            tr("Mesh &check"),
            "warning",
            tr("List the issues found in the mesh and show where they are"),
            "Ctrl+I",
            "findings",
        )
        self.views = [make(title, "view", tip, key, "look", axis) for title, tip, key, axis in _VIEWS]
        self.edges = switch(tr("&Edges"), "edges", tr("Show the triangle edges"), "W", "edges")
        self.smooth = switch(
            tr("&Smooth shading"), "smooth", tr("Shade smoothly across edges"), None, "smooth", True
        )
        self.looks = LookActions(self._maker)
        self.schemes = self._make_schemes()

    def _make_schemes(self) -> QMenu:
        menu = QMenu(tr("&Appearance"), self._window)
        for title, scheme, tip in (
            (
                tr("&System default"),
                Qt.ColorScheme.Unknown,
                tr("Follow the light or dark mode of the system"),
            ),
            (tr("&Light"), Qt.ColorScheme.Light, tr("Use the light theme")),
            (tr("&Dark"), Qt.ColorScheme.Dark, tr("Use the dark theme")),
        ):
            action = self._maker.make(title, "scheme", tip, None, "scheme", scheme)
            action.setData(scheme.value)
            menu.addAction(action)
        self._maker.one_of(menu.actions())
        return menu

    def _make_help(self) -> list[QAction]:
        make = self._maker.make
        keys = tr("View and change the keyboard shortcuts")
        tour = tr("Learn the program in five steps, on a bottle")
        tables = tr("Reproduce the tables of Li and Hui, with figures")
        diagnostics = tr("Copy versions, graphics driver and the end of the log, for a report of a defect")
        about = tr("Version, licence and source of the method")
        return [
            make(tr("&Shortcuts…"), "keyboard", keys, ("F1", "?"), "shortcuts"),
            make(tr("&Tour"), "tour", tour, None, "tour"),
            make(tr("The &paper's tables…"), "tables", tables, None, "paper"),
            make(tr("&Copy diagnostics"), "copy", diagnostics, None, "copy_diagnostics"),
            make(tr("&About APD Viewer"), "about", about, None, "about"),
        ]

    def _fill_menus(self) -> None:
        bar = self._window.menuBar()
        file = bar.addMenu(tr("&File"))
        file.addAction(self.open)
        file.addMenu(self.recent)
        file.addMenu(self.samples)
        file.addSeparator()
        file.addActions([self.save, self.save_as, self.export])
        file.addSeparator()
        file.addActions(self._handouts)
        file.addSeparator()
        file.addAction(self.quit)
        edit = bar.addMenu(tr("&Edit"))
        edit.addActions([self.undo, self.redo])
        edit.addSeparator()
        edit.addActions([self.reset, self.bake])
        tools = bar.addMenu(tr("&Tools"))
        tools.addActions(list(self.tools.values()))
        self.select.fill(bar.addMenu(tr("&Select")))
        self.pose.fill(bar.addMenu(tr("&Handle")))
        self._view_menu = bar.addMenu(tr("&View"))
        self._view_menu.addAction(self.frame)
        self._view_menu.addActions(self.views)
        self._view_menu.addSeparator()
        self.looks.fill(self._view_menu)
        self._view_menu.addSeparator()
        self._view_menu.addActions([self.edges, self.smooth, self.findings])
        self._view_menu.addSeparator()
        self._view_menu.addMenu(self.schemes)
        bar.addMenu(tr("&Help")).addActions(self.help)

    @property
    def _handouts(self) -> list[QAction]:
        """What others can be given to look at."""
        return [self.report, self.picture, self.copy_picture]

    @property
    def of_a_mesh(self) -> list[QAction]:
        """What can only be done while a mesh is open."""
        own = [self.save, self.save_as, self.export, *self._handouts]
        return [*own, self.pose.compare, self.pose.sweep, *self.select.files, *self.select.changes]

    def _make_bar(self) -> QToolBar:
        bar = QToolBar(tr("Tools"), self._window, objectName="tools", movable=False)
        bar.setIconSize(SIZE)
        bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        bar.addActions([self.open, self.export])
        bar.addSeparator()
        bar.addActions(list(self.tools.values()))
        bar.addSeparator()
        bar.addActions([self.undo, self.redo, self.reset])
        bar.addSeparator()
        bar.addAction(self.frame)
        self._window.addToolBar(Qt.ToolBarArea.LeftToolBarArea, bar)
        return bar

    def add_panels(self, actions: list[QAction]) -> None:
        """Offer panels that can be hidden in the View menu."""
        for action in actions:
            tip = tr("Show or hide the panel “{title}”").format(title=plain(action.text()))
            self._maker.adopt(action, "panel", tip, tuple(action.shortcuts()), f"panel:{action.objectName()}")
        self._view_menu.insertActions(self.schemes.menuAction(), actions)
        self._view_menu.insertSeparator(self.schemes.menuAction())

    @property
    def entries(self) -> list[Entry]:
        """All actions, with what is said of them."""
        return self._maker.entries

    def fill_recent(self, paths: list[Path]) -> None:
        """List the files that were opened last."""
        self.recent.clear()
        for path in paths:
            action = self.recent.addAction(path.name)
            action.setStatusTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._verbs["open_path"](path))
        self.recent.setEnabled(bool(paths))

    def show_history(self, undo: str | None, redo: str | None) -> None:
        """Name what undo and redo would do."""
        for action, bare, verb, gesture in (
            (self.undo, tr("&Undo"), tr("&Undo “{gesture}”"), undo),
            (self.redo, tr("&Redo"), tr("&Redo “{gesture}”"), redo),
        ):
            action.setText(verb.format(gesture=gesture) if gesture else bare)
            action.setEnabled(gesture is not None)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._maker.set_theme(theme)
