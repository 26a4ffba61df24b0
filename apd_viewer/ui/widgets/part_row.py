"""List of named parts of the mesh, each with its colour; one is active."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QLabel, QWidget

from apd_viewer.language import tr
from apd_viewer.session.model.handles_and_regions import NO_FLAGS, PartFlags
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import keep_room, small_button
from apd_viewer.ui.widgets.named_rows import NamedList, NamedRow
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon


class Swatch(QWidget):
    """Square in the colour of a part on the mesh."""

    def __init__(self, color: tuple[int, int, int]) -> None:
        super().__init__()
        self.setFixedSize(14, 14)
        self._color = QColor(*color)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the square."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(self._color)
        painter.drawRoundedRect(QRectF(1, 1, 12, 12), 3, 3)


# Tooltips by kind of row: for its reading, and for its remove button.
_SAID = {
    "handle": (tr("Measurement of the handle"), tr("Remove this handle")),
    "region": (tr("Measurement of the region"), tr("Remove this region")),
    "obstacle": (tr("Load on the obstacle"), tr("Remove this obstacle")),
    "measurement": (tr("Measured value"), tr("Remove this measurement")),
}


class PartRow(NamedRow):
    """Row of a part: colour, name, reading, and details of the active one."""

    def __init__(self, kind: str, name: str, color: tuple[int, int, int], details: QWidget) -> None:
        reading, remove = _SAID[kind]
        super().__init__(name, remove)
        self.setToolTip(tr("Click to activate, double-click or F2 to rename, Delete to remove"))
        self.reading = QLabel("", objectName="quiet", accessibleName=reading)
        self.details = details
        self.buttons = PartButtons()
        keep_room(self.remove)  # the readings of all rows are aligned
        line = row_layout(Swatch(color), (self.name, 1), self.reading, self.remove)
        below = row_layout((details, 1), (self.buttons, 0, Qt.AlignmentFlag.AlignRight), spacing=4)
        column_layout(line, below, spacing=2, margins=(8, 3, 4, 3), parent=self)
        self.set_active(False)

    def set_active(self, on: bool) -> None:
        """Mark the part as active, and show or hide its details."""
        super().set_active(on)
        self.details.setVisible(on)
        self._active = on

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.buttons.set_theme(theme)

    def show_flags(self, flags: PartFlags, painted: bool) -> None:
        """Update the buttons; they are visible for an active, hidden or locked part."""
        self.buttons.show_flags(flags, painted)
        self.buttons.setVisible(self._active or flags != NO_FLAGS)


class PartButtons(QWidget):
    """Buttons to hide, lock and clear a part, in its row."""

    hide_requested = Signal(bool)
    lock_requested = Signal(bool)
    clear_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._flags, self._theme = NO_FLAGS, LIGHT
        self.hide_part, self.lock_part, self.clear_part = (small_button("", "") for _ in range(3))
        row_layout(self.hide_part, self.lock_part, self.clear_part, spacing=0, parent=self)
        self.hide_part.clicked.connect(lambda: self.hide_requested.emit(not self._flags.hidden))
        self.lock_part.clicked.connect(lambda: self.lock_requested.emit(not self._flags.locked))
        self.clear_part.clicked.connect(self.clear_requested)
        self._update()

    def show_flags(self, flags: PartFlags, painted: bool) -> None:
        """Show the flags on the buttons; only painted, unlocked parts can be cleared."""
        self.clear_part.setEnabled(painted and not flags.locked)
        if flags != self._flags:
            self._flags = flags
            self._update()

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        self._update()

    def _update(self) -> None:
        hidden, locked = self._flags.hidden, self._flags.locked
        for button, image, tip in (
            (self.hide_part, "hidden" if hidden else "view", _TIPS["show" if hidden else "hide"]),
            (self.lock_part, "locked" if locked else "unlocked", _TIPS["unlock" if locked else "lock"]),
            (self.clear_part, "erase", _TIPS["clear"]),
        ):
            button.setIcon(icon(image, self._theme))
            button.setToolTip(tip)
            button.setAccessibleName(tip)


_TIPS = {
    "hide": tr("Hide the colour of this part"),
    "show": tr("Show the colour of this part"),
    "lock": tr("Lock this part against painting"),
    "unlock": tr("Unlock this part"),
    "clear": tr("Clear the paint of this part"),
}


class PartList(NamedList[PartRow]):
    """List with one row per part.

    Parameters
    ----------
    make : callable
        Function making a row for a name and a colour.
    """

    hidden = Signal(int, bool)
    locked = Signal(int, bool)
    cleared = Signal(int)

    def __init__(
        self,
        colors: Sequence[tuple[int, int, int]],
        make: Callable[[int, str, tuple[int, int, int]], PartRow],
    ) -> None:
        super().__init__(lambda k, name: self._connect_buttons(k, make(k, name, colors[k % len(colors)])))

    def _connect_buttons(self, k: int, row: PartRow) -> PartRow:
        row.buttons.hide_requested.connect(lambda on: self.hidden.emit(k, on))
        row.buttons.lock_requested.connect(lambda on: self.locked.emit(k, on))
        row.buttons.clear_requested.connect(lambda: self.cleared.emit(k))
        return row
