"""Buttons of a painted part: hide, lock, clear."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.session.model.handles_and_regions import NO_FLAGS, PartFlags
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme


class PartButtons(QWidget):
    """Three small buttons in the row of a part.

    Attributes
    ----------
    hide_requested, lock_requested : Signal(bool)
    clear_requested : Signal()
    """

    hide_requested = Signal(bool)
    lock_requested = Signal(bool)
    clear_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._flags, self._theme = NO_FLAGS, LIGHT
        self.hide_part, self.lock_part, self.clear_part = (small_button("", "") for _ in range(3))
        row = QHBoxLayout(self, spacing=0)
        row.setContentsMargins(0, 0, 0, 0)
        for button in (self.hide_part, self.lock_part, self.clear_part):
            row.addWidget(button)
        self.hide_part.clicked.connect(lambda: self.hide_requested.emit(not self._flags.hidden))
        self.lock_part.clicked.connect(lambda: self.lock_requested.emit(not self._flags.locked))
        self.clear_part.clicked.connect(self.clear_requested)
        self._update()

    def show_flags(self, flags: PartFlags, painted: bool) -> None:
        """Show the flags; clearing needs paint and no lock."""
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
