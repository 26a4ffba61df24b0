"""Menus and tool bar of a window, as they are first shown."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from apd_viewer.language import tr
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.preferences.action_maker import ActionMaker
from apd_viewer.ui.tools.tool_modes import FIRST_TOOL, Tool
from apd_viewer.ui.widgets.tool_bar import ToolBar

_KEYS = QKeySequence.StandardKey


class WindowMenus:
    """Menus and tool bar; commands that need a session are connected later.

    Actions without a command yet are disabled.

    Parameters
    ----------
    choose_tool : callable
        Use a tool.
    frame : callable
        Zoom to the mesh.
    panels : sequence of QAction
        Show and hide the panels.
    """

    def __init__(
        self,
        window: QMainWindow,
        requests: FileRequests,
        choose_tool: Callable[[Tool], object],
        frame: Callable[[], object],
        panels: Sequence[QAction],
    ) -> None:
        self.maker = ActionMaker(window)
        self.choose_tool = choose_tool
        make = self.maker.make
        tip = tr("Open a mesh or a session")
        self.open = make("open", tr("&Open…"), "open", tip, _KEYS.Open, requests.ask_for_file)
        tip = tr("Export the deformed mesh to a file")
        self.export = make("export", tr("&Export…"), "export", tip, "Ctrl+E")
        self.undo = make("undo", tr("&Undo"), "undo", tr("Undo the last step"), _KEYS.Undo)
        self.redo = make("redo", tr("&Redo"), "redo", tr("Redo the last step"), _KEYS.Redo)
        tip = tr("Reset all handles and return the mesh to its rest shape")
        self.reset = make("reset", tr("Re&set all handles"), "reset", tip, "Ctrl+R")
        self.frame = make("frame", tr("&Frame mesh"), "frame", tr("Zoom to the whole mesh"), "F", frame)
        self.quit = make("quit", tr("&Quit"), "quit", tr("Close the window"), _KEYS.Quit, window.close)
        tip = tr("Press the mesh between two plates before your eyes, and go back to any step")
        self.press_live = make("press_live", tr("&Press"), "press-live", tip, "Shift+K")
        self.tools = {tool: self._make_tool(tool) for tool in Tool}
        self.maker.make_exclusive(self.tools.values())
        self.tools[FIRST_TOOL].setChecked(True)
        self._menus = self._make_menus(window, panels)
        self.bar = self._make_bar(window)

    def _make_tool(self, tool: Tool) -> QAction:
        name, traits = f"take:{tool.name}", tool.traits
        command = partial(self._choose_tool, tool)
        return self.maker.make(name, traits.title, traits.icon, traits.tip, traits.key, command)

    def _choose_tool(self, tool: Tool) -> None:
        self.choose_tool(tool)

    def _make_menus(self, window: QMainWindow, panels: Sequence[QAction]) -> list[QMenu]:
        more = QAction(tr("Loading…"), window, enabled=False)
        entries: dict[str, Iterable[QAction]] = {
            tr("&File"): [self.open, more, self.quit],
            tr("&Edit"): [more],
            tr("&Tools"): self.tools.values(),
            tr("&Select"): [more],
            tr("H&andle"): [more],
            tr("Si&mulate"): [more],
            tr("&View"): [self.frame, more, *panels],
            tr("&Help"): [more],
        }
        menus = [window.menuBar().addMenu(title) for title in entries]
        for menu, actions in zip(menus, entries.values(), strict=True):
            menu.addActions(list(actions))
        return menus

    def _make_bar(self, window: QMainWindow) -> ToolBar:
        steps = self.undo, self.redo, self.reset
        tools = *self.tools.values(), self.press_live
        groups = (self.open, self.export), tools, steps, (self.frame,)
        bar = ToolBar(tr("Tools"), window, "tools", groups)
        bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        window.addToolBar(Qt.ToolBarArea.LeftToolBarArea, bar)
        return bar

    def make_empty_menus(self) -> list[QMenu]:
        """The menus File, Edit, Tools, Select, Handle, Simulate, View and Help, now empty."""
        for menu in self._menus:
            menu.clear()
        return self._menus
