"""Card over the viewport to search for commands by purpose and run them."""

from collections.abc import Callable, Iterable, Sequence
from typing import cast

from PySide6 import QtWidgets
from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent

from apd_viewer.language import tr
from apd_viewer.ui.help.searchable import Searchable, SearchQuery, match_score
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.box_layouts import column_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.theme import ICON_SIZE, LIGHT, Theme, icon
from apd_viewer.ui.widgets.wheel import block_mouse_events

_MARGIN, _WIDEST = 12, 640
_MOST = 40  # largest number of entries shown
_LATER = 0.9  # score penalty of a disabled entry
_WALKS = Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown
_OF_ITEM = Qt.ItemDataRole.UserRole


class SearchRow(QtWidgets.QHBoxLayout):
    """Search field with a close button.

    Parameters
    ----------
    name, prompt : str
        Of the field.
    closing : str
        Name of the cross.
    """

    def __init__(self, name: str, prompt: str, closing: str) -> None:
        super().__init__(spacing=8)
        self.field = QtWidgets.QLineEdit(accessibleName=name, placeholderText=prompt, clearButtonEnabled=True)
        self.close_button = small_button(closing, tr("Close (Esc)"))
        self.addWidget(self.field, 1)
        self.addWidget(self.close_button)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon of the close button."""
        self.close_button.setIcon(icon("cancel", theme))


class CommandSearch(QtWidgets.QFrame):
    """Search field above a list of commands.

    Parameters
    ----------
    collect : callable
        Everything that can be found, as it is now.
    search_manual : callable
        Opens the search of the manual for words.
    """

    dismissed = Signal()

    def __init__(
        self,
        canvas: Viewport,
        collect: Callable[[], Iterable[Searchable]],
        search_manual: Callable[[str], object],
    ) -> None:
        super().__init__(canvas, objectName="finder", accessibleName=tr("Find a command"))
        block_mouse_events(self)
        self._canvas, self._collect, self._search_manual = canvas, collect, search_manual
        self._known: list[Searchable] = []
        self._found: list[Searchable] = []
        self.list = SearchResultList()
        self.list.itemClicked.connect(self._run)
        self._hint = QtWidgets.QLabel(tr("Enter runs it, F1 explains it, Esc closes"), objectName="quiet")
        self._column = column_layout(
            self._make_head(), (self.list, 1), self._hint, spacing=8, margins=(12, 8, 8, 10), parent=self
        )
        self.hide()
        canvas.resized.connect(self._place)

    def _make_head(self) -> SearchRow:
        head = SearchRow(tr("Find a command"), tr("What do you want to do?"), tr("Close the search"))
        head.close_button.clicked.connect(self.dismissed)
        self.search, self._head = head.field, head
        self.search.setToolTip(tr("Type what you want to do, such as: mirror, brush smaller, wall thickness"))
        self.search.textChanged.connect(self._show_found)
        self.search.installEventFilter(self)
        return head

    def open(self) -> None:
        """Open an empty search with the current state of all entries."""
        self._known = list(self._collect())
        self.search.clear()
        self._show_found("")
        self.show()
        self.raise_()
        self._place()
        self.search.setFocus(Qt.FocusReason.PopupFocusReason)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self.list.theme = theme
        self._head.set_theme(theme)
        if not self.isHidden():
            self._show_found(self.search.text())

    # Search and ranking

    def _show_found(self, text: str) -> None:
        wish = SearchQuery.from_text(text)
        ranked = [(match_score(wish, each.texts), each) for each in self._known]
        ranked = [pair for pair in ranked if pair[0] > 0.0]
        ranked.sort(key=lambda pair: _LATER * bool(pair[1].disabled_reason) - pair[0])
        self._found = [each for _, each in ranked[:_MOST]]
        self.list.show_entries(self._found, text.strip())
        self._place()

    def _run(self) -> None:
        """Run the selected entry, unless it is disabled."""
        row = self.list.row
        if row < 0:
            return
        found = self._found[row] if row < len(self._found) else None
        if found is not None and found.disabled_reason:
            return
        text = self.search.text().strip()
        self.dismissed.emit()
        if found is None:
            self._search_manual(text)
        else:
            found.run()

    # Placement and Qt events

    def _place(self) -> None:
        if not self.isHidden():
            width = min(_WIDEST, self._canvas.width() - 2 * _MARGIN)
            self.setFixedWidth(width)
            self._column.activate()
            self.resize(width, self.sizeHint().height())
            self.move((self._canvas.width() - width) // 2, _MARGIN)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Let the arrow keys move the selection while the search field has the focus."""
        if event.type() == QEvent.Type.KeyPress and cast(QKeyEvent, event).key() in _WALKS:
            self.list.keyPressEvent(cast(QKeyEvent, event))
            return True
        return False

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Close on Esc, run on Enter."""
        if event.key() == Qt.Key.Key_Escape:
            self.dismissed.emit()
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._run()
        else:
            super().keyPressEvent(event)

    @property
    def marked_entry(self) -> Searchable | None:
        """Selected entry, run by Enter; None if there is none."""
        return self._found[self.list.row] if 0 <= self.list.row < len(self._found) else None


_ROWS = 10  # rows visible without scrolling


class SearchResultList(QtWidgets.QTreeWidget):
    """List of matching entries, ending with one that searches the manual."""

    def __init__(self) -> None:
        super().__init__(columnCount=3, headerHidden=True, rootIsDecorated=False, iconSize=ICON_SIZE)
        self.theme = LIGHT
        self.setUniformRowHeights(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # the search field keeps the keyboard focus
        self.setAccessibleName(tr("Commands found"))
        self.setToolTip(tr("A click runs the command, or goes to the control"))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QtWidgets.QHeaderView.ResizeMode.Stretch)
        for column in (1, 2):
            header.setSectionResizeMode(column, QtWidgets.QHeaderView.ResizeMode.ResizeToContents)

    def show_entries(self, entries: Sequence[Searchable], text: str) -> None:
        """Show the entries matching a text, and select the first one."""
        self.clear()
        self.addTopLevelItems([_item(each, self.theme) for each in entries])
        if text:
            pages = QtWidgets.QTreeWidgetItem([tr("Search the manual for “{text}”").format(text=text)])
            pages.setIcon(0, icon("manual", self.theme))
            self.addTopLevelItem(pages)
            pages.setFirstColumnSpanned(True)
        if (first := self.topLevelItem(0)) is not None:
            self.setCurrentItem(first)
        rows = min(self.topLevelItemCount(), _ROWS)
        self.setFixedHeight(rows * max(0, self.sizeHintForRow(0)) + 2 * self.frameWidth() if rows else 0)

    @property
    def row(self) -> int:
        """Number of the selected row; -1 if there is none."""
        item = self.currentItem()
        return -1 if item is None else self.indexOfTopLevelItem(item)


def _item(found: Searchable, theme: Theme) -> QtWidgets.QTreeWidgetItem:
    """Row of an entry; a disabled one is grey and shows the reason."""
    item = QtWidgets.QTreeWidgetItem([found.texts.title, found.disabled_reason or found.location, found.keys])
    item.setDisabled(bool(found.disabled_reason))
    item.setToolTip(0, found.texts.tip)
    item.setIcon(0, icon(found.image, theme))
    item.setForeground(1, QColor(theme.quiet))
    item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    return item
