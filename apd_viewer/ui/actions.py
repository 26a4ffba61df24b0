"""The window's actions: each with a name, a tip, an icon, a shortcut and a place in a menu."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar

from apd_viewer.files.samples import SAMPLES
from apd_viewer.ui.icons import SIZE, icon
from apd_viewer.ui.theme import Theme
from apd_viewer.ui.toolbox import Tool

_VIEWS = {"Front": ("front", "1"), "Right": ("side", "3"), "Top": ("top", "7")}
_OPPOSITES = {"Back": ("-front", "Ctrl+1"), "Left": ("-side", "Ctrl+3"), "Bottom": ("-top", "Ctrl+7")}


class Actions:
    """Builds actions, menus and the tool bar of a window; what they do is given by the window.

    Parameters
    ----------
    window : QMainWindow
        Also their parent.
    verbs : dict
        What to call for each name that is used below, such as "open" or "undo".
    """

    def __init__(self, window: QMainWindow, verbs: dict[str, Callable[..., object]]) -> None:
        self._window = window
        self._verbs = verbs
        self._icons: list[tuple[QAction, str]] = []
        self.tools: dict[Tool, QAction] = {}
        self._make_file()
        self._make_edit()
        self._make_tools()
        self._make_view()
        self._make_help()
        self._fill_menus()
        self.bar = self._make_bar()

    def _make(self, text: str, verb: str, key: object = None, image: str = "", tip: str = "") -> QAction:
        action = QAction(text, self._window)
        action.triggered.connect(lambda _checked=False: self._verbs[verb]())
        if key is not None:
            action.setShortcut(QKeySequence(key))
        keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        said = tip or text.replace("&", "").rstrip("…")
        action.setToolTip(f"{said} ({keys})" if keys else said)
        action.setStatusTip(said)
        if image:
            self._icons.append((action, image))
        return action

    def _make_file(self) -> None:
        keys = QKeySequence.StandardKey
        self.open = self._make("&Open…", "open", keys.Open, "open", "Open a mesh")
        self.export = self._make(
            "&Export…", "export", "Ctrl+E", "export", "Write the deformed mesh to a file"
        )
        self.quit = self._make("&Quit", "quit", keys.Quit)
        self.recent = QMenu("Open &recent", self._window)
        self.samples = QMenu("Open &sample", self._window)
        for name, title in SAMPLES.items():
            action = self.samples.addAction(title)
            action.triggered.connect(lambda _checked=False, name=name: self._verbs["open_sample"](name))
            self._icons.append((action, "sample"))

    def _make_edit(self) -> None:
        keys = QKeySequence.StandardKey
        self.undo = self._make("&Undo", "undo", keys.Undo, "undo", "Take the last step back")
        self.redo = self._make("&Redo", "redo", keys.Redo, "redo", "Do again what was taken back")
        self.reset = self._make(
            "Re&set handles",
            "reset",
            "Ctrl+R",
            "reset",
            "Put all handles back, and the mesh in its rest shape",
        )
        self.larger = self._make("&Larger brush", "larger", "]", tip="Enlarge the brush")
        self.smaller = self._make("S&maller brush", "smaller", "[", tip="Make the brush smaller")
        self.parts = [
            self._make(
                "&Add handle", "add_handle", "Shift+H", "add", "Add one more part to be moved by itself"
            ),
            self._make(
                "&Next handle", "next_handle", "N", "next-handle", "Take the next handle into the hand"
            ),
            self._make(
                "Add &region", "add_region", "Shift+R", "add", "Add one more part whose area is measured"
            ),
        ]

    def _make_tools(self) -> None:
        self._group = QActionGroup(self._window)
        for tool in Tool:
            words = tool.words
            action = QAction(f"{words.title}", self._window, checkable=True)
            action.setShortcut(QKeySequence(words.key))
            action.setToolTip(f"<b>{words.title}</b> ({words.key})<br>{words.tip}")
            action.setStatusTip(words.tip)
            action.triggered.connect(lambda _checked=False, tool=tool: self._verbs["take"](tool))
            self._group.addAction(action)
            self._icons.append((action, words.icon))
            self.tools[tool] = action

    def _make_view(self) -> None:
        self.frame = self._make("&Frame the mesh", "frame", "F", "frame", "Show the whole mesh")
        self.findings = self._make(
            "Fi&ndings", "findings", "Ctrl+I", tip="List what is unusual about the mesh, and show where"
        )
        self.views = []
        for title, (axis, key) in (_VIEWS | _OPPOSITES).items():
            action = QAction(title, self._window)
            action.setShortcut(QKeySequence(key))
            action.setStatusTip(f"Look at the mesh from the {title.lower()}")
            action.triggered.connect(lambda _checked=False, axis=axis: self._verbs["look"](axis))
            self.views.append(action)
        self.edges = self._make_switch("&Edges", "edges", "W", "Show the edges of the triangles", False)
        self.smooth = self._make_switch("&Smooth shading", "smooth", None, "Shade over the edges", True)
        self.local = self._make_switch(
            "&Gizmo along the handle's axes", "local", "L", "Let arrows and rings turn with the handle", False
        )
        self.schemes = self._make_schemes()

    def _make_switch(self, text: str, verb: str, key: str | None, tip: str, on: bool) -> QAction:
        action = QAction(text, self._window, checkable=True, checked=on)
        if key:
            action.setShortcut(QKeySequence(key))
        action.setStatusTip(tip)
        action.toggled.connect(lambda on: self._verbs[verb](on))
        return action

    def _make_schemes(self) -> QMenu:
        menu = QMenu("&Appearance", self._window)
        group = QActionGroup(menu)
        for title, scheme in (
            ("As the &system", Qt.ColorScheme.Unknown),
            ("&Light", Qt.ColorScheme.Light),
            ("&Dark", Qt.ColorScheme.Dark),
        ):
            action = menu.addAction(title)
            action.setCheckable(True)
            action.setData(scheme.value)
            action.triggered.connect(lambda _checked=False, scheme=scheme: self._verbs["scheme"](scheme))
            group.addAction(action)
        return menu

    def _make_help(self) -> None:
        self.about = self._make("&About APD Viewer", "about", image="about")

    def _fill_menus(self) -> None:
        bar = self._window.menuBar()
        file = bar.addMenu("&File")
        file.addAction(self.open)
        file.addMenu(self.recent)
        file.addMenu(self.samples)
        file.addSeparator()
        file.addActions([self.export])
        file.addSeparator()
        file.addAction(self.quit)
        edit = bar.addMenu("&Edit")
        edit.addActions([self.undo, self.redo])
        edit.addSeparator()
        edit.addAction(self.reset)
        select = bar.addMenu("&Tools")
        select.addActions(list(self.tools.values()))
        select.addSeparator()
        select.addActions([self.larger, self.smaller])
        select.addSeparator()
        select.addActions(self.parts)
        select.addSeparator()
        select.addAction(self.local)
        self._view_menu = bar.addMenu("&View")
        self._view_menu.addAction(self.frame)
        self._view_menu.addActions(self.views)
        self._view_menu.addSeparator()
        self._view_menu.addActions([self.edges, self.smooth, self.findings])
        self._view_menu.addSeparator()
        self._view_menu.addMenu(self.schemes)
        bar.addMenu("&Help").addAction(self.about)

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
        self._view_menu.insertActions(self.schemes.menuAction(), actions)
        self._view_menu.insertSeparator(self.schemes.menuAction())

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
        for action, name in self._icons:
            action.setIcon(icon(name, theme))
