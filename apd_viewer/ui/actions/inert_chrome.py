"""Menus and tool bar of the first frame, in the place of the real menus."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QToolBar

from apd_viewer.language import tr
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.tools.toolbox import FIRST_TOOL, Tool
from apd_viewer.ui.widgets.theme import ICON_SIZE, Theme, icon

_TOOLS = [tool.words.icon for tool in Tool]
# Icons, in groups; the tests compare them with the real tool bar.
_BAR = ["open", "export"], _TOOLS, ["undo", "redo", "reset"], ["frame"]
_NEED_A_MESH = "export", "undo", "redo", "reset"


class InertChrome:
    """Window actions before a session exists; those needing one are disabled.

    Parameters
    ----------
    window : QMainWindow
    requests : FileRequests
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
        self._window = window
        self._buttons = {name: QAction(window, enabled=False) for name in _NEED_A_MESH}
        self._add("open", tr("&Open…"), QKeySequence.StandardKey.Open, requests.ask_for_file)
        self._add("frame", tr("&Frame mesh"), "F", frame)
        self._add_tools(choose_tool)
        self._quit = QAction(tr("&Quit"), window, shortcut=QKeySequence.StandardKey.Quit)
        self._quit.triggered.connect(window.close)
        self._loading = QAction(tr("Loading…"), window, enabled=False)
        self._fill_menus(panels)
        self.bar = add_tool_bar(window, [[self._buttons[name] for name in group] for group in _BAR])

    def _add(self, name: str, title: str, key: object, command: Callable[[], object]) -> QAction:
        action = self._buttons[name] = QAction(title, self._window, shortcut=QKeySequence(key))
        action.triggered.connect(lambda _checked=False: command())
        return action

    def _add_tools(self, take: Callable[[Tool], object]) -> None:
        self._group = QActionGroup(self._window)
        for tool in Tool:
            words = tool.words
            action = self._add(words.icon, words.title, words.key, partial(take, tool))
            action.setCheckable(True)
            action.setChecked(tool is FIRST_TOOL)
            self._group.addAction(action)

    def _fill_menus(self, panels: Sequence[QAction]) -> None:
        more = [self._loading]
        entries: dict[str, Iterable[QAction]] = {
            tr("&File"): [self._buttons["open"], *more, self._quit],
            tr("&Edit"): more,
            tr("&Tools"): self._group.actions(),
            tr("&Select"): more,
            tr("H&andle"): more,
            tr("&View"): [self._buttons["frame"], *more, *panels],
            tr("&Help"): more,
        }
        self._menus = [self._window.menuBar().addMenu(title) for title in entries]
        for menu, actions in zip(self._menus, entries.values(), strict=True):
            menu.addActions(list(actions))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        for name, action in self._buttons.items():
            action.setIcon(icon(name, theme))

    def remove(self) -> None:
        """Make room for the real menus and tool bar, and reopen an open menu."""
        bar = self._window.menuBar()
        for place, menu in enumerate(self._menus):
            if menu.isVisible():
                menu.close()
                # By then the real menus have taken the places of these.
                QTimer.singleShot(
                    0, self._window, lambda place=place: bar.setActiveAction(bar.actions()[place])
                )
        bar.clear()
        self._window.removeToolBar(self.bar)
        for part in (self.bar, *self._menus, self._group, self._loading, self._quit, *self._buttons.values()):
            part.deleteLater()
        self._buttons.clear()


def add_tool_bar(window: QMainWindow, groups: Sequence[Sequence[QAction]]) -> QToolBar:
    """Add a tool bar at the left of a window, with separators between the groups."""
    bar = QToolBar(tr("Tools"), window, objectName="tools", movable=False)
    bar.setIconSize(ICON_SIZE)
    bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
    for group in groups:
        if bar.actions():
            bar.addSeparator()
        bar.addActions(list(group))
    window.addToolBar(Qt.ToolBarArea.LeftToolBarArea, bar)
    return bar
