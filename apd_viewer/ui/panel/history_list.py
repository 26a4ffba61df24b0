"""Undo history as a list of steps to click."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QListWidget, QListWidgetItem

from apd_viewer.language import tr


class HistoryList(QListWidget):
    """One row a step, oldest first; undone steps are paler.

    Attributes
    ----------
    chosen : Signal(int)
        How many steps are to be done from now on, from 0.
    """

    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__(objectName="history", accessibleName=tr("History"))
        self.setToolTip(tr("Click a step to go back or forward to it"))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._shown: tuple[str, list[str], list[str]] = "", [], []
        self.itemClicked.connect(lambda item: self.chosen.emit(self.row(item)))
        self.itemActivated.connect(lambda item: self.chosen.emit(self.row(item)))

    def show_steps(self, name: str, done: list[str], undone: list[str]) -> None:
        """Show the mesh of the first step, the steps done and those to redo, in order."""
        if (name, done, undone) == self._shown:
            return
        self._shown = name, list(done), list(undone)
        self.clear()
        start = tr("Open {name}").format(name=name)
        for k, step in enumerate([start, *done, *undone]):
            item = QListWidgetItem(step)
            font = QFont(self.font())
            font.setBold(k == len(done))
            item.setFont(font)
            if k > len(done):
                item.setForeground(self.palette().placeholderText())
            self.addItem(item)
        self.setCurrentRow(len(done))
        self.scrollToItem(self.item(len(done)))
