"""Card over the view to find commands by their purpose, and run them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import cast

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
)

from apd_viewer.language import tr
from apd_viewer.ui.help.searchable import Searchable
from apd_viewer.ui.help.word_match import meant_words, score
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.event_barrier import shield
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.icons import SIZE, icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_MARGIN, _WIDEST, _ROWS = 12, 640, 10
_MOST = 40  # entries found
_WALKS = Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown
_OF_ITEM = Qt.ItemDataRole.UserRole


class CommandSearch(QFrame):
    """Search field above a list of commands.

    Parameters
    ----------
    canvas : Viewport
    collect : callable
        Everything that can be found, as it is now.
    search_manual : callable
        Opens the search of the manual for words.

    Attributes
    ----------
    search : QLineEdit
    list : QTreeWidget
    """

    dismissed = Signal()

    def __init__(
        self,
        canvas: Viewport,
        collect: Callable[[], Iterable[Searchable]],
        search_manual: Callable[[str], object],
    ) -> None:
        super().__init__(canvas, objectName="finder", accessibleName=tr("Find a command"))
        shield(self)
        self._canvas, self._collect, self._search_manual = canvas, collect, search_manual
        self._known: list[Searchable] = []
        self._found: list[Searchable] = []
        column = self._column = QVBoxLayout(self, spacing=8)
        column.setContentsMargins(12, 8, 8, 10)
        column.addLayout(self._make_head())
        column.addWidget(self._make_list(), 1)
        self._hint = QLabel(tr("Enter runs it, F1 explains it, Esc closes"), objectName="quiet")
        column.addWidget(self._hint)
        self.hide()
        canvas.resized.connect(self._place)

    def _make_head(self) -> QHBoxLayout:
        self.search = QLineEdit(
            placeholderText=tr("What do you want to do?"),
            accessibleName=tr("Find a command"),
            toolTip=tr("Type what you want to do, such as: mirror, brush smaller, wall thickness"),
            clearButtonEnabled=True,
        )
        self.search.textChanged.connect(self._show_found)
        self.search.installEventFilter(self)
        self._close = small_button(tr("Close the search"), tr("Close (Esc)"))
        self._close.clicked.connect(self.dismissed)
        row = QHBoxLayout(spacing=8)
        row.addWidget(self.search, 1)
        row.addWidget(self._close)
        return row

    def _make_list(self) -> QTreeWidget:
        self.list = QTreeWidget(
            columnCount=3,
            headerHidden=True,
            rootIsDecorated=False,
            uniformRowHeights=True,
            iconSize=SIZE,
            accessibleName=tr("Commands found"),
            focusPolicy=Qt.FocusPolicy.NoFocus,  # the keys stay in the field
        )
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setToolTip(tr("A click runs the command, or goes to the control"))
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        for column in (1, 2):
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)
        self.list.itemClicked.connect(self._run)
        return self.list

    def open(self) -> None:
        """Begin anew, with the present state of all entries."""
        self._known = list(self._collect())
        self.search.clear()
        self._show_found("")
        self.show()
        self.raise_()
        self._place()
        self.search.setFocus(Qt.FocusReason.PopupFocusReason)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self._close.setIcon(icon("cancel", theme or LIGHT))

    # Finding

    def _show_found(self, text: str) -> None:
        wish = meant_words(text)
        ranked = [(score(wish, each.texts), each) for each in self._known] if wish else []
        ranked = [pair for pair in ranked if pair[0] > 0.0]
        ranked.sort(key=lambda pair: (-pair[0], bool(pair[1].why_not)))
        self._found = [each for _, each in ranked[:_MOST]]
        self.list.clear()
        self.list.addTopLevelItems([_item(each) for each in self._found])
        if text.strip():
            words = tr("Search the manual for “{text}”").format(text=text.strip())
            self.list.addTopLevelItem(QTreeWidgetItem([words]))
        if (first := self.list.topLevelItem(0)) is not None:
            self.list.setCurrentItem(first)
        self._place()

    def _run(self) -> None:
        """Run the marked entry, unless it is disabled."""
        row = self._row
        if row < 0:
            return
        found = self._found[row] if row < len(self._found) else None
        if found is not None and found.why_not:
            return
        text = self.search.text().strip()
        self.dismissed.emit()
        if found is None:
            self._search_manual(text)
        else:
            found.run()

    # Place and events

    def _place(self) -> None:
        if not self.isHidden():
            rows = min(self.list.topLevelItemCount(), _ROWS)
            height = max(self.list.sizeHintForRow(0), 0) * rows + 2 * self.list.frameWidth() + 2
            self.list.setFixedHeight(height if rows else 0)
            width = min(_WIDEST, self._canvas.width() - 2 * _MARGIN)
            self.setFixedWidth(width)
            self._column.activate()
            self.resize(width, self.sizeHint().height())
            self.move((self._canvas.width() - width) // 2, _MARGIN)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Let the arrow keys walk in the list while the field has the focus."""
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
    def marked(self) -> Searchable | None:
        """Marked entry, for Enter."""
        return self._found[self._row] if 0 <= self._row < len(self._found) else None

    @property
    def _row(self) -> int:
        """Number of the marked row; -1 if there is none."""
        item = self.list.currentItem()
        return -1 if item is None else self.list.indexOfTopLevelItem(item)


def _item(found: Searchable) -> QTreeWidgetItem:
    """Row of an entry, grey with its reason if it cannot be run."""
    where = found.why_not or found.where
    item = QTreeWidgetItem([found.texts.title, where, found.keys])
    if found.icon is not None:
        item.setIcon(0, found.icon)
    item.setDisabled(bool(found.why_not))
    item.setToolTip(0, found.texts.tip)
    item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    return item
