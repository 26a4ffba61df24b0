"""Sheet over the viewport with all actions and their editable shortcuts."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.help.command_search import SearchRow
from apd_viewer.ui.help.shortcut_rows import ActionRow, ShortcutGroup
from apd_viewer.ui.preferences.shortcuts import Shortcuts, native_keys, split_keys
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.box_layouts import STRETCH, arrange_row, column_layout, row_layout
from apd_viewer.ui.widgets.theme import LIGHT, Theme, set_style_property
from apd_viewer.ui.widgets.wheel import block_mouse_events

_MARGIN, _WIDEST, _NARROWEST = 12, 560, 160
_HINT = tr("Click a shortcut to change it.")
_WAITING = tr("Press new keys; Delete removes the shortcut, Esc cancels.")


class ShortcutSheet(QFrame):
    """Search field, list of shortcuts, and status line.

    Parameters
    ----------
    groups : callable
        Makes the groups of rows anew, in the widget that it is given.

    Attributes
    ----------
    dismissed : Signal()
        Esc, or the cross.
    rows : dict of str to ActionRow
        By the names of the entries, while it is open.
    no_results : QLabel
        Said where nothing is found.
    """

    dismissed = Signal()

    def __init__(
        self, canvas: Viewport, shortcuts: Shortcuts, groups: Callable[[QWidget], list[ShortcutGroup]]
    ) -> None:
        super().__init__(canvas, objectName="sheet", accessibleName=tr("Shortcuts"))
        block_mouse_events(self)
        self._canvas = canvas
        self._shortcuts = shortcuts
        self._make_groups = groups
        self.groups: list[ShortcutGroup] = []
        self._theme = LIGHT
        self._wish: tuple[ActionRow, str] | None = None
        self.rows: dict[str, ActionRow] = {}
        head, rows, foot = self._make_head(), self._make_list(), self._make_foot()
        column_layout(head, (rows, 1), foot, spacing=8, margins=(12, 8, 8, 12), parent=self)
        self.hide()
        canvas.resized.connect(self._place)

    def _make_head(self) -> SearchRow:
        prompt = tr("Search for an action, a shortcut or a gesture")
        head = SearchRow(tr("Search shortcuts"), prompt, tr("Close shortcuts"))
        head.close_button.clicked.connect(self.dismissed)
        self.search, self.head = head.field, head
        self.search.textChanged.connect(self._filter)
        return head

    def _make_list(self) -> QScrollArea:
        self._scroll = QScrollArea(widgetResizable=True, focusPolicy=Qt.FocusPolicy.NoFocus)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        return self._scroll

    def _make_foot(self) -> QHBoxLayout:
        self.status = QLabel(wordWrap=True, accessibleName=tr("Status"))
        self.status.setMinimumHeight(2 * self.status.fontMetrics().lineSpacing())
        self.swap = QPushButton(tr("Swap"), objectName="primary", clicked=self._swap)
        self.restore_all = QPushButton(tr("Restore all defaults"))
        self.restore_all.setToolTip(tr("Restore the default keys of all actions"))
        self.restore_all.clicked.connect(self._reset_all)
        self._foot = row_layout((self.status, 1), self.swap, self.restore_all, margins=(8, 0, 4, 0))
        return self._foot

    def open(self) -> None:
        """Open the sheet with all rows and an empty search."""
        body = QWidget(objectName="rows")
        self.groups = self._make_groups(body)
        self.no_results = QLabel(alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True, objectName="quiet")
        column_layout(*self.groups, self.no_results, STRETCH, margins=(0, 0, 4, 0), parent=body)
        rows = [row for group in self.groups for row in group.rows if isinstance(row, ActionRow)]
        self.rows = {row.entry.name: row for row in rows}
        for row in rows:
            self._connect(row)
        self._scroll.setWidget(body)
        self.search.clear()
        self._filter("")
        self._say(_HINT)
        self.restore_all.setEnabled(self._shortcuts.has_changes)
        self.set_theme(self._theme)
        self.show()
        self.raise_()
        self._place()
        self.search.setFocus(Qt.FocusReason.PopupFocusReason)

    def _connect(self, row: ActionRow) -> None:
        row.keys.keys_chosen.connect(partial(self._request_keys, row))
        row.keys.recording_changed.connect(self._say_waiting)
        row.keys.step_requested.connect(partial(self._step, row))
        row.back.clicked.connect(lambda: self._request_keys(row, row.entry.default_keys))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        self.head.set_theme(theme)
        for group in self.groups:
            for row in group.rows:
                row.set_theme(theme)

    # Search and navigation

    def _filter(self, text: str) -> None:
        found = sum(group.filter_rows(text.casefold().split()) for group in self.groups)
        if self.groups:
            self.no_results.setVisible(not found)
            self.no_results.setText(tr("No results for “{text}”.").format(text=text.strip()))

    @property
    def _visible_rows(self) -> list[ActionRow]:
        return [row for row in self.rows.values() if row.isVisible()]

    def _step(self, row: ActionRow, step: int) -> None:
        """Focus an adjacent visible row, or the search field above the first."""
        shown = self._visible_rows
        k = shown.index(row) + step
        if 0 <= k < len(shown):
            shown[k].keys.setFocus(Qt.FocusReason.TabFocusReason)
            self._scroll.ensureWidgetVisible(shown[k], 0, 24)
        elif k < 0:
            self.search.setFocus()

    # Changes of shortcuts

    def _request_keys(self, row: ActionRow, keys: str) -> None:
        """Assign keys to an action, unless they are reserved or in use."""
        other = self._shortcuts.conflicting_entry(keys, row.entry)
        if reason := self._shortcuts.refusal(row.entry, keys):
            self._say(reason, warn=True)
        elif other is not None:
            self._offer_swap(row, keys, other.title)
        else:
            self._assign_keys(row, keys)

    def _offer_swap(self, row: ActionRow, keys: str, other: str) -> None:
        taken = next(key for key in split_keys(keys) if self._shortcuts.conflicting_entry(key, row.entry))
        self._say(
            tr("{keys} is already used by “{action}”.").format(keys=native_keys(taken), action=other),
            warn=True,
        )
        self._wish = row, keys
        self.swap.setText(tr("Swap") if row.entry.keys else tr("Reassign"))
        instead = native_keys(row.entry.keys) or tr("no keys")
        self.swap.setToolTip(
            tr("“{action}” gets {keys} instead (Esc cancels)").format(action=other, keys=instead)
        )
        self.swap.setAccessibleDescription(self.status.text())
        self.swap.show()
        self.restore_all.hide()
        self.swap.setFocus()

    def _swap(self) -> None:
        if self._wish is not None:
            self._assign_keys(*self._wish)

    def _assign_keys(self, row: ActionRow, keys: str) -> None:
        self._shortcuts.assign_keys(row.entry, keys)
        self._say(
            tr("“{action}” now has {keys}.").format(
                action=row.entry.title, keys=native_keys(keys) or tr("no keys")
            )
        )
        self._show_keys()
        row.keys.setFocus()

    def _reset_all(self) -> None:
        self._shortcuts.reset_all()
        self._say(tr("All actions have their default keys."))
        self._show_keys()
        self.search.setFocus()

    def _show_keys(self) -> None:
        for row in self.rows.values():
            row.show_keys()
        self.restore_all.setEnabled(self._shortcuts.has_changes)

    def _say_waiting(self, waits: bool) -> None:
        self._say(_WAITING if waits else _HINT)

    def _say(self, sentence: str, warn: bool = False) -> None:
        """Show a status message and decline a pending swap of keys."""
        self._wish = None
        self.swap.hide()
        self.restore_all.show()
        self.status.setText(sentence)
        set_style_property(self.status, "warn", warn)

    # Placement and Qt events

    def _place(self) -> None:
        if not self.isHidden():
            width = min(_WIDEST, self._canvas.width() - 2 * _MARGIN)
            left = (self._canvas.width() - width) // 2
            self.status.setMinimumWidth(_NARROWEST)
            arrange_row(self._foot, width - 24)
            self.setGeometry(left, _MARGIN, width, self._canvas.height() - 2 * _MARGIN)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Decline a swap or close on Esc; move from the search to the list on Down."""
        shown = self._visible_rows
        if event.key() == Qt.Key.Key_Escape and self._wish is not None:
            self._wish[0].keys.setFocus()
            self._say(_HINT)
        elif event.key() == Qt.Key.Key_Escape:
            self.dismissed.emit()
        elif event.key() == Qt.Key.Key_Down and self.search.hasFocus() and shown:
            shown[0].keys.setFocus(Qt.FocusReason.TabFocusReason)
        else:
            super().keyPressEvent(event)
