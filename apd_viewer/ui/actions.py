"""The window's actions: each with a name, a tip, an icon, a shortcut and a place in a menu."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar

from apd_viewer.files.samples import SAMPLES
from apd_viewer.language import tr
from apd_viewer.ui.action_maker import ActionMaker
from apd_viewer.ui.icons import SIZE
from apd_viewer.ui.pose_actions import PoseActions
from apd_viewer.ui.select_actions import SelectActions
from apd_viewer.ui.shortcuts import Entry
from apd_viewer.ui.theme import Theme
from apd_viewer.ui.toolbox import Tool

_VIEWS = {"Front": ("front", "1"), "Right": ("side", "3"), "Top": ("top", "7")}
_OPPOSITES = {"Back": ("-front", "Ctrl+1"), "Left": ("-side", "Ctrl+3"), "Bottom": ("-top", "Ctrl+7")}
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
        self.select = SelectActions(window, self._maker)
        self.pose = PoseActions(window, self._maker)
        self._make_view()
        self.help = [
            self._maker.make(
                "&Shortcuts…", "keyboard", "List all keys, and change them", ("F1", "?"), "shortcuts"
            ),
            self._maker.make("&Tour", "tour", "Show the program in five steps, on a bottle", None, "tour"),
        ]
        self.about = self._maker.make(
            "&About APD Viewer", "about", "Versions, licence and source of the method", None, "about"
        )
        self._fill_menus()
        self.bar = self._make_bar()

    def _make_file(self) -> None:
        make = self._maker.make
        self.open = make("&Open…", "open", "Open a mesh or a session", _KEYS.Open, "open")
        self.export = make("&Export…", "export", "Write the deformed mesh to a file", "Ctrl+E", "export")
        self.save = make("&Save session", "save", "Save what was said and the shape", _KEYS.Save, "save")
        self.save_as = make(
            "Save session &as…", "save", "Save the session to another file", "Ctrl+Shift+S", "save_as"
        )
        self.quit = make("&Quit", "quit", "Close the window", _KEYS.Quit, "quit")
        self.recent = QMenu("Open &recent", self._window)
        self.samples = QMenu("Open &sample", self._window)
        for name, title in SAMPLES.items():
            tip = f"Open the {title.lower()}, painted"
            self.samples.addAction(make(title, "sample", tip, None, "open_sample", name))

    def _make_edit(self) -> None:
        make = self._maker.make
        self.undo = make("&Undo", "undo", "Take the last step back", _KEYS.Undo, "undo")
        self.redo = make("&Redo", "redo", "Do again what was taken back", _KEYS.Redo, "redo")
        self.reset = make(
            "Re&set handles",
            "reset",
            "Put all handles back, and the mesh in its rest shape",
            "Ctrl+R",
            "reset",
        )
        self.bake = make(
            tr("&Bake as new rest"),
            "bake",
            tr("Take this shape for the rest shape: its area becomes the 100 % of all that follows"),
            "Ctrl+Shift+R",
            "bake",
        )

    def _make_tools(self) -> None:
        group = QActionGroup(self._window)
        for tool in Tool:
            words = tool.words
            action = self._maker.make(words.title, words.icon, words.tip, words.key, "take", tool)
            action.setCheckable(True)
            group.addAction(action)
            self.tools[tool] = action

    def _make_view(self) -> None:
        make, switch = self._maker.make, self._maker.switch
        self.frame = make("&Frame the mesh", "frame", "Show the whole mesh", "F", "frame")
        self.findings = make(
            "Fi&ndings",
            "warning",
            "List what is unusual about the mesh, and show where",
            "Ctrl+I",
            "findings",
        )
        self.views = [
            make(title, "view", f"Look at the mesh from the {title.lower()}", key, "look", axis)
            for title, (axis, key) in (_VIEWS | _OPPOSITES).items()
        ]
        self.edges = switch("&Edges", "edges", "Show the edges of the triangles", "W", "edges")
        self.smooth = switch("&Smooth shading", "smooth", "Shade over the edges", None, "smooth", True)
        self.schemes = self._make_schemes()

    def _make_schemes(self) -> QMenu:
        menu = QMenu("&Appearance", self._window)
        group = QActionGroup(menu)
        for title, scheme, tip in (
            ("As the &system", Qt.ColorScheme.Unknown, "Light or dark as the system is"),
            ("&Light", Qt.ColorScheme.Light, "Dark letters on light panels"),
            ("&Dark", Qt.ColorScheme.Dark, "Light letters on dark panels"),
        ):
            action = self._maker.make(title, "scheme", tip, None, "scheme", scheme)
            action.setCheckable(True)
            action.setData(scheme.value)
            menu.addAction(action)
            group.addAction(action)
        return menu

    def _fill_menus(self) -> None:
        bar = self._window.menuBar()
        file = bar.addMenu("&File")
        file.addAction(self.open)
        file.addMenu(self.recent)
        file.addMenu(self.samples)
        file.addSeparator()
        file.addActions([self.save, self.save_as, self.export])
        file.addSeparator()
        file.addAction(self.quit)
        edit = bar.addMenu("&Edit")
        edit.addActions([self.undo, self.redo])
        edit.addSeparator()
        edit.addActions([self.reset, self.bake])
        tools = bar.addMenu("&Tools")
        tools.addActions(list(self.tools.values()))
        self.select.fill(bar.addMenu("&Select"))
        self.pose.fill(bar.addMenu("&Handle"))
        self._view_menu = bar.addMenu("&View")
        self._view_menu.addAction(self.frame)
        self._view_menu.addActions(self.views)
        self._view_menu.addSeparator()
        self._view_menu.addActions([self.edges, self.smooth, self.findings])
        self._view_menu.addSeparator()
        self._view_menu.addMenu(self.schemes)
        bar.addMenu("&Help").addActions([*self.help, self.about])

    @property
    def of_a_mesh(self) -> list[QAction]:
        """What can only be done while a mesh is open."""
        return [self.save, self.save_as, self.export, *self.select.files, *self.select.changes]

    def _make_bar(self) -> QToolBar:
        bar = QToolBar("Tools", self._window, objectName="tools", movable=False)
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
            title, keys = action.text().replace("&", "").lower(), tuple(action.shortcuts())
            self._maker.adopt(action, "panel", f"Show or hide the {title}", keys, f"panel:{title}")
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
        for action, verb, gesture in ((self.undo, "&Undo", undo), (self.redo, "&Redo", redo)):
            action.setText(f"{verb} “{gesture}”" if gesture else verb)
            action.setEnabled(gesture is not None)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._maker.set_theme(theme)
