"""List of found commands with their places and keys."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem

from apd_viewer.language import tr
from apd_viewer.ui.help.searchable import Searchable
from apd_viewer.ui.widgets.icons import ICON_SIZE, icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_ROWS = 10  # shown without scrolling


class FoundList(QTreeWidget):
    """Rows of found entries, and a last one for the manual."""

    def __init__(self) -> None:
        super().__init__(columnCount=3, headerHidden=True, rootIsDecorated=False, iconSize=ICON_SIZE)
        self.theme = LIGHT
        self.setUniformRowHeights(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # the keys stay in the field
        self.setAccessibleName(tr("Commands found"))
        self.setToolTip(tr("A click runs the command, or goes to the control"))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        for column in (1, 2):
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)

    def show_entries(self, entries: Sequence[Searchable], text: str) -> None:
        """Show entries for a text, the first one marked."""
        self.clear()
        self.addTopLevelItems([_item(each, self.theme) for each in entries])
        if text:
            pages = QTreeWidgetItem([tr("Search the manual for “{text}”").format(text=text)])
            pages.setIcon(0, icon("manual", self.theme))
            self.addTopLevelItem(pages)
            pages.setFirstColumnSpanned(True)
        if (first := self.topLevelItem(0)) is not None:
            self.setCurrentItem(first)
        rows = min(self.topLevelItemCount(), _ROWS)
        self.setFixedHeight(rows * max(0, self.sizeHintForRow(0)) + 2 * self.frameWidth() if rows else 0)

    @property
    def row(self) -> int:
        """Number of the marked row; -1 if there is none."""
        item = self.currentItem()
        return -1 if item is None else self.indexOfTopLevelItem(item)


def _item(found: Searchable, theme: Theme) -> QTreeWidgetItem:
    """Row of an entry, grey with its reason if it is disabled."""
    item = QTreeWidgetItem([found.texts.title, found.disabled_reason or found.location, found.keys])
    item.setDisabled(bool(found.disabled_reason))
    item.setToolTip(0, found.texts.tip)
    item.setIcon(0, icon(found.image, theme))
    item.setForeground(1, QColor(theme.quiet))
    item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    return item
