"""A list of named parts of the mesh, each with its colour; one of them is active."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from apd_viewer.ui.panel.part_row import PartRow
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme


class PartList(QWidget):
    """The rows, as many as there are parts.

    Parameters
    ----------
    colors : sequence of (int, int, int)
    make : callable
        From a name and a colour to a new row.

    Attributes
    ----------
    chosen, removed : Signal(int)
    renamed : Signal(int, str)
    hidden, locked : Signal(int, bool)
    cleared : Signal(int)
    rows : list of PartRow
    """

    chosen = Signal(int)
    removed = Signal(int)
    renamed = Signal(int, str)
    hidden = Signal(int, bool)
    locked = Signal(int, bool)
    cleared = Signal(int)

    def __init__(
        self,
        colors: Sequence[tuple[int, int, int]],
        make: Callable[[int, str, tuple[int, int, int]], PartRow],
    ) -> None:
        super().__init__()
        self._colors = colors
        self._make = make
        self._theme = LIGHT
        self.rows: list[PartRow] = []
        self._column = QVBoxLayout(self, spacing=2)
        self._column.setContentsMargins(0, 0, 0, 0)

    def show_parts(self, names: Sequence[str], active: int) -> None:
        """Show a row for each name, and the active part."""
        while len(self.rows) > len(names):
            row = self.rows.pop()
            row.hide()
            row.deleteLater()  # the row may own the pressed button
        for k, name in enumerate(names):
            if k == len(self.rows):
                self._add(k, name)
            self.rows[k].name.show_name(name)
            self.rows[k].set_active(k == active)
        self.setVisible(bool(self.rows))

    def _add(self, k: int, name: str) -> None:
        row = self._make(k, name, self._colors[k % len(self._colors)])
        row.chosen.connect(lambda: self.chosen.emit(k))
        row.removed.connect(lambda: self.removed.emit(k))
        row.renamed.connect(lambda name: self.renamed.emit(k, name))
        row.stepped.connect(lambda step: self._step(k + step))
        row.buttons.hidden_asked.connect(lambda on: self.hidden.emit(k, on))
        row.buttons.locked_asked.connect(lambda on: self.locked.emit(k, on))
        row.buttons.clear_asked.connect(lambda: self.cleared.emit(k))
        row.remove.setIcon(icon("remove", self._theme))
        row.buttons.set_theme(self._theme)
        self.rows.append(row)
        self._column.addWidget(row)
        self._put_in_tab_order(row)

    def _put_in_tab_order(self, row: PartRow) -> None:
        """Insert a row into the tab order after the rows above it."""
        before = self._before
        for other in self.rows:
            for widget in filter(_takes_keys, (other, *other.findChildren(QWidget))):
                if other is row:
                    self.setTabOrder(before, widget)
                before = widget

    @property
    def _before(self) -> QWidget:
        """Widget before the list in the tab order."""
        before: QWidget | None = self.previousInFocusChain()
        while before is not None and before is not self and not _takes_keys(before):
            before = before.previousInFocusChain()
        return before or self

    def _step(self, k: int) -> None:
        if 0 <= k < len(self.rows):
            self.rows[k].setFocus()
            self.chosen.emit(k)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        for row in self.rows:
            row.remove.setIcon(icon("remove", theme))
            row.buttons.set_theme(theme)


def _takes_keys(widget: QWidget) -> bool:
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus) and widget.focusProxy() is None
