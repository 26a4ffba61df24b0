"""Menu titles and tool bar of the first frame, in the place of the real ones."""

from __future__ import annotations

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow

from apd_viewer.language import tr
from apd_viewer.ui.actions.tool_bar import add_tool_bar
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.tools.toolbox import FIRST_TOOL, Tool
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import Theme

_MENUS = tr("&File"), tr("&Edit"), tr("&Tools"), tr("&Select"), tr("H&andle"), tr("&View"), tr("&Help")
_TOOLS = [tool.words.icon for tool in Tool]
# Icons, in groups; the tests compare them with the real tool bar.
_BAR = ["open", "export"], _TOOLS, ["undo", "redo", "reset"], ["frame"]
_NEED_A_MESH = {"export", "undo", "redo", "reset"}


class InertChrome:
    """Titles and icons without commands, apart from opening a file and quitting.

    Parameters
    ----------
    window : QMainWindow
    requests : FileRequests
    """

    def __init__(self, window: QMainWindow, requests: FileRequests) -> None:
        self._window = window
        self._open = QAction(tr("&Open…"), window, shortcut=QKeySequence.StandardKey.Open)
        self._open.triggered.connect(requests.ask)
        self._quit = QAction(tr("&Quit"), window, shortcut=QKeySequence.StandardKey.Quit)
        self._quit.triggered.connect(window.close)
        self._menus = [window.menuBar().addMenu(title) for title in _MENUS]
        self._menus[0].addActions([self._open, self._quit])
        self._buttons = {"open": self._open}
        self.bar = add_tool_bar(window, [[self._button(name) for name in group] for group in _BAR])
        self._buttons[FIRST_TOOL.words.icon].setCheckable(True)
        self._buttons[FIRST_TOOL.words.icon].setChecked(True)

    def _button(self, name: str) -> QAction:
        if name not in self._buttons:
            self._buttons[name] = QAction(self._window, enabled=name not in _NEED_A_MESH)
        return self._buttons[name]

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        for name, action in self._buttons.items():
            action.setIcon(icon(name, theme))

    def remove(self) -> None:
        """Make room for the real menus and tool bar."""
        self._window.menuBar().clear()
        self._window.removeToolBar(self.bar)
        for part in (self.bar, *self._menus, self._quit, *self._buttons.values()):
            part.deleteLater()
        self._buttons.clear()
