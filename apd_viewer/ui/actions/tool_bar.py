"""The tool bar of the window."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QToolBar

from apd_viewer.language import tr
from apd_viewer.ui.widgets.icons import ICON_SIZE


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
