"""Panes side by side, or on tabs if space is narrow."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QSplitter, QToolButton, QWidget

from apd_viewer.ui.widgets.box_layouts import row_layout

_WIDE = 1000  # px; smallest width for all panes in a row


class Pane(NamedTuple):
    """Widget with the title of its tab and its stretch factor."""

    title: str
    widget: QWidget
    stretch: int


class PaneSplitter(QSplitter):
    """Panes in a row, in a column, or one at a time on tabs.

    Attributes
    ----------
    tabs : QWidget
        A row of buttons, for its owner to place; hidden where all parts are shown.
    """

    def __init__(self, panes: Sequence[Pane]) -> None:
        super().__init__(childrenCollapsible=False, handleWidth=5)
        self._parts, self._chosen, self._one = panes, 0, False
        self.tabs = QWidget(visible=False)
        self.buttons = [QToolButton(text=part.title, checkable=True, objectName="choice") for part in panes]
        for k, (part, button) in enumerate(zip(panes, self.buttons, strict=True)):
            self.addWidget(part.widget)
            self.setStretchFactor(k, part.stretch)
            button.setAutoExclusive(True)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.clicked.connect(partial(self.choose, k))
        row_layout(*self.buttons, spacing=2, parent=self.tabs)
        self.buttons[0].setChecked(True)
        self._share_width()

    def _share_width(self) -> None:
        self.setSizes([_WIDE * part.stretch for part in self._parts])

    def choose(self, number: int) -> None:
        """Select the pane shown while only one fits."""
        self._chosen = number
        self._follow()

    def arrange(self, size: QSize) -> None:
        """Arrange the panes for the available size."""
        tall = size.height() > size.width()
        way = Qt.Orientation.Vertical if tall else Qt.Orientation.Horizontal
        one = not tall and size.width() < _WIDE
        if way != self.orientation() or one != self._one:
            self._one = one
            self.setOrientation(way)
            self._follow()
            self._share_width()

    def _follow(self) -> None:
        self.tabs.setVisible(self._one)
        for k, part in enumerate(self._parts):
            part.widget.setVisible(not self._one or k == self._chosen)
