"""Tool bar with groups of actions and an overflow button in the theme's colours."""

from collections.abc import Sequence
from typing import cast

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QToolBar, QToolButton, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.theme import ICON_SIZE, Theme, icon


class ToolBar(QToolBar):
    """Tool bar of actions.

    Parameters
    ----------
    groups : sequence of sequences of QAction
        Parted by lines.
    """

    def __init__(self, title: str, parent: QWidget, name: str, groups: Sequence[Sequence[QAction]]) -> None:
        super().__init__(title, parent, objectName=name, movable=False, iconSize=ICON_SIZE)
        for group in groups:
            if self.actions():
                self.addSeparator()
            self.addActions(list(group))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the chevron of the overflow menu, black by default on any background."""
        more = cast(QToolButton, self.findChild(QToolButton, "qt_toolbar_ext_button"))
        more.setIcon(icon("unfolded", theme))
        more.setToolTip(tr("More"))
