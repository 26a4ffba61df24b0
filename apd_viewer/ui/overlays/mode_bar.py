"""Bar of the modes of a tool, shown while it is in the hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QToolBar, QToolButton

from apd_viewer.language import tr
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.icons import ICON_SIZE, icon
from apd_viewer.ui.widgets.theme import Theme
from apd_viewer.ui.widgets.wheel import shield

_MARGIN = 12


class ModeBar(QToolBar):
    """A column at the left edge of the canvas.

    Parameters
    ----------
    canvas : Viewport
    title : str
    groups : sequence of sequences of QAction
        Parted by lines.
    """

    def __init__(self, canvas: Viewport, title: str, groups: Sequence[Sequence[QAction]]) -> None:
        super().__init__(title, canvas, objectName="ways")
        shield(self)
        self._canvas = canvas
        self.setOrientation(Qt.Orientation.Vertical)
        self.setIconSize(ICON_SIZE)
        for group in groups:
            if self.actions():
                self.addSeparator()
            self.addActions(list(group))
        self.move(QPoint(_MARGIN, _MARGIN))
        self.hide()
        canvas.resized.connect(self._fit)

    def show_for(self, on: bool) -> None:
        """Show the bar for its tools only."""
        self.setVisible(on)
        self._fit()

    def set_theme(self, theme: Theme) -> None:
        """Redraw the menu's chevron, black on any ground in the style."""
        more = cast(QToolButton, self.findChild(QToolButton, "qt_toolbar_ext_button"))
        more.setIcon(icon("unfolded", theme))
        more.setToolTip(tr("More"))

    def _fit(self) -> None:
        """Shrink to the canvas, moving the last modes to a menu."""
        room = self._canvas.height() - 2 * _MARGIN
        self.resize(self.sizeHint().width(), min(self.sizeHint().height(), room))
