"""Lists of rows with names edited in place; one row may be active."""

from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QFrame, QLineEdit, QToolButton, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.box_layouts import column_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon, set_style_property


class NameField(QLineEdit):
    """Name edited in place: Enter accepts, Esc restores the previous one."""

    name_entered = Signal(str)

    def __init__(self, text: str) -> None:
        super().__init__(objectName="name", frame=False)
        self.setAccessibleName(tr("Name"))
        self.setMinimumHeight(self.fontMetrics().height() + 8)
        self._kept = text
        self.end_editing()

    def show_name(self, text: str) -> None:
        """Set the displayed name, unless it is being edited."""
        if text != self._kept:
            self._kept = text
            if self.isReadOnly():
                self.end_editing()

    def begin_editing(self) -> None:
        """Make the field editable, give it the focus and select the name."""
        self.setReadOnly(False)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents, False)
        self.setFocus()
        self.selectAll()
        self.update_style()

    def end_editing(self) -> None:
        """Make the field read-only; mouse events then reach the row."""
        self.setReadOnly(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setText(self._kept)
        self.setToolTip(self._kept)
        self.setCursorPosition(0)
        self.deselect()
        self.update_style()

    def update_style(self) -> None:
        """Reapply the style sheet after a change of ``readOnly``."""
        self.style().unpolish(self)
        self.style().polish(self)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Accept the text on Enter; restore the name on Esc."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish(self.text())
        elif event.key() == Qt.Key.Key_Escape:
            self._finish(self._kept)
        else:
            super().keyPressEvent(event)
            return
        row = self.parentWidget()
        if row is not None:
            row.setFocus()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Accept the text on loss of focus."""
        super().focusOutEvent(event)
        if event.reason() is not Qt.FocusReason.PopupFocusReason:
            self._finish(self.text())

    def _finish(self, text: str) -> None:
        if self.isReadOnly():
            return
        before = self._kept
        self.end_editing()
        if text.strip() and text.strip() != before:
            self.name_entered.emit(text.strip())


class NamedRow(QFrame):
    """Row with an editable name and a button to remove it.

    Parameters
    ----------
    remove : str
        Tooltip of the remove button.

    Attributes
    ----------
    step_requested : Signal(int)
        The arrow keys ask for the row above, -1, or below, 1.
    """

    chosen = Signal()
    removed = Signal()
    renamed = Signal(str)
    step_requested = Signal(int)

    def __init__(self, name: str, remove: str) -> None:
        super().__init__(objectName="part", focusPolicy=Qt.FocusPolicy.StrongFocus)
        self.name = NameField(name)
        self.remove: QToolButton = small_button(remove, remove)
        self.name.name_entered.connect(self.renamed)
        self.remove.clicked.connect(self._request_removal)

    def _request_removal(self) -> None:
        self.setFocus()  # what is typed in a field of the row belongs to this part, not to the next one
        self.removed.emit()

    def set_active(self, on: bool) -> None:
        """Mark the row as active or inactive."""
        self.setAccessibleName(tr("{name}, active").format(name=self.name.text()) if on else self.name.text())
        set_style_property(self, "active", on)

    def set_highlighted(self, on: bool) -> None:
        """Highlight the row if it is active, or leave it plain."""
        set_style_property(self, "resting", not on)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self.remove.setIcon(icon("remove", theme))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Request to make the row active."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.chosen.emit()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Start editing the name."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.name.begin_editing()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Select, rename or remove the row, or move to an adjacent one."""
        key = event.key()
        if key in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space):
            self.chosen.emit()
        elif key == Qt.Key.Key_F2:
            self.name.begin_editing()
        elif key == Qt.Key.Key_Delete and not self.remove.isHidden():
            self.removed.emit()
        elif key in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.step_requested.emit(-1 if key == Qt.Key.Key_Up else 1)
        else:
            super().keyPressEvent(event)


Row = TypeVar("Row", bound=NamedRow)


class NamedList(QWidget, Generic[Row]):
    """List with one row per name.

    Parameters
    ----------
    make : callable
        Function making a row for an index and a name, connected to the signals of its kind.
    """

    chosen = Signal(int)
    removed = Signal(int)
    renamed = Signal(int, str)

    def __init__(self, make: Callable[[int, str], Row]) -> None:
        super().__init__()
        self._make = make
        self._theme, self._is_highlighted = LIGHT, True
        self.rows: list[Row] = []
        self._column = column_layout(spacing=2, parent=self)

    def show_names(self, names: Sequence[str], active: int | None) -> None:
        """Show one row per name, and mark the active one, if any."""
        while len(self.rows) > len(names):
            row = self.rows.pop()
            row.name.end_editing()  # its name is gone, and would be entered as the focus leaves
            row.hide()
            row.deleteLater()  # deleted later, as the row's own button may be calling
        for k, name in enumerate(names):
            if k == len(self.rows):
                self._add(k, self._make(k, name))
            self.rows[k].name.show_name(name)
            self.rows[k].set_active(k == active)
        self.setVisible(bool(self.rows))

    def _add(self, k: int, row: Row) -> None:
        row.chosen.connect(lambda: self.chosen.emit(k))
        row.removed.connect(lambda: self.removed.emit(k))
        row.renamed.connect(lambda name: self.renamed.emit(k, name))
        row.step_requested.connect(lambda step: self._step(k + step))
        row.set_theme(self._theme)
        row.set_highlighted(self._is_highlighted)
        self.rows.append(row)
        self._column.addWidget(row)
        self._put_in_tab_order(row)

    def _put_in_tab_order(self, row: Row) -> None:
        """Insert a row into the tab order after the rows above it."""
        before = self._previous_widget
        for other in self.rows:
            widgets: list[QWidget] = [other, *other.findChildren(QWidget)]
            for widget in filter(_takes_keys, widgets):
                if other is row:
                    self.setTabOrder(before, widget)
                before = widget

    @property
    def _previous_widget(self) -> QWidget:
        """Last widget before the list in the tab order."""
        before: QWidget | None = self.previousInFocusChain()
        while before is not None and before is not self and not _takes_keys(before):
            before = before.previousInFocusChain()
        return before or self

    def _step(self, k: int) -> None:
        if 0 <= k < len(self.rows):
            self.rows[k].setFocus()
            self.chosen.emit(k)

    def set_highlighted(self, on: bool) -> None:
        """Highlight the active row, or leave it plain."""
        self._is_highlighted = on
        for row in self.rows:
            row.set_highlighted(on)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        for row in self.rows:
            row.set_theme(theme)


def _takes_keys(widget: QWidget) -> bool:
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus) and widget.focusProxy() is None
