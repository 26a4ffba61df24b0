"""Dock panels beside the canvas: closable, movable, floating."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QDockWidget, QMainWindow, QWidget

from apd_viewer.ui.widgets.icons import icon

if TYPE_CHECKING:
    from PySide6.QtGui import QAction

    from apd_viewer.ui.widgets.theme import Theme

# The platform's own are black on a dark panel too.
_BUTTONS = {"qt_dockwidget_closebutton": "remove", "qt_dockwidget_floatbutton": "panel"}


class Docks:
    """Docks of a window, in menu order.

    Parameters
    ----------
    window : QMainWindow
    """

    def __init__(self, window: QMainWindow) -> None:
        self._window = window
        self._docks: dict[str, QDockWidget] = {}

    def add(
        self,
        name: str,
        title: str,
        content: QWidget,
        area: Qt.DockWidgetArea = Qt.DockWidgetArea.RightDockWidgetArea,
        shown: bool = True,
    ) -> QDockWidget:
        """Put ``content`` into a dock; ``name`` identifies it in the layout."""
        dock = QDockWidget(title, self._window, objectName=name)
        dock.setWidget(content)
        self._window.addDockWidget(area, dock)
        dock.setVisible(shown)
        dock.toggleViewAction().setObjectName(name)  # under which its keys are remembered
        self._docks[name] = dock
        return dock

    def __getitem__(self, name: str) -> QDockWidget:
        return self._docks[name]

    def set_theme(self, theme: Theme) -> None:
        """Redraw the buttons of the titles."""
        for dock in self._docks.values():
            for name, image in _BUTTONS.items():
                button = dock.findChild(QAbstractButton, name)
                if button is not None:
                    button.setIcon(icon(image, theme))

    @property
    def toggles(self) -> list[QAction]:
        """Actions to show and hide the docks."""
        return [dock.toggleViewAction() for dock in self._docks.values()]
