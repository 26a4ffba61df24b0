"""The bar over the canvas with the ways to choose vertices, while a tool is in hand that paints."""

from __future__ import annotations

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QToolBar

from apd_viewer.language import tr
from apd_viewer.ui.icons import SIZE
from apd_viewer.ui.select_actions import SelectActions
from apd_viewer.ui.shield import shield
from apd_viewer.ui.viewport import Viewport

_MARGIN = 12


class WayBar(QToolBar):
    """A column at the left edge of the canvas.

    Parameters
    ----------
    canvas : Viewport
    actions : SelectActions
    """

    def __init__(self, canvas: Viewport, actions: SelectActions) -> None:
        super().__init__(tr("Ways to choose vertices"), canvas, objectName="ways")
        shield(self)
        self.setOrientation(Qt.Orientation.Vertical)
        self.setIconSize(SIZE)
        self.addActions(list(actions.ways.values()))
        self.addSeparator()
        self.addAction(actions.through)
        self.addSeparator()
        self.addActions(actions.changes)
        self.move(QPoint(_MARGIN, _MARGIN))
        self.hide()

    def show_for(self, paints: bool) -> None:
        """Show it for a tool that paints, and only then."""
        self.setVisible(paints)
        self.adjustSize()
