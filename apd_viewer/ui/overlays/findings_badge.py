"""Badge with the number of issues of the mesh check."""

from dataclasses import replace

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAction, QKeyEvent
from PySide6.QtWidgets import QToolButton

from apd_viewer.language import tr, trn
from apd_viewer.ui.preferences.shortcuts import text_with_keys
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon

ENTER_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


def issue_count_text(number: int) -> str:
    """Text with the number of issues."""
    return trn("{n} issue", "{n} issues", number).format(n=number)


class Badge(QToolButton):
    """Number of findings: a plain label, or a button to open the list."""

    def __init__(self) -> None:
        super().__init__(objectName="badge", checkable=True, iconSize=QSize(16, 16))
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._theme = LIGHT
        self._action: QAction | None = None
        self._number: int | None = None
        self.show_count(None)

    def show_count(self, number: int | None) -> None:
        """Show the number of findings; None without a mesh."""
        self._number = number
        self.setVisible(number is not None)
        self.setEnabled(bool(number))
        if not number:
            self.setText(tr("No issues"))
            self.setToolTip(tr("No issues were found when the mesh was opened"))
        else:
            self.setText(issue_count_text(number))
            tip = tr("Issues found in the mesh, and where they are")
            self.setToolTip(text_with_keys(tip, self._action) if self._action else tip)
        self.setAccessibleName(self.text())
        self._draw_symbol()

    def show_shortcut_in_tooltip(self, action: QAction) -> None:
        """Show the shortcut of the equivalent action in the tooltip."""
        self._action = action
        action.changed.connect(lambda: self.show_count(self._number))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self._theme = theme
        self._draw_symbol()

    def _draw_symbol(self) -> None:
        if self.isEnabled():
            warm = replace(self._theme, ink=self._theme.warm, on_accent=self._theme.warm)
            self.setIcon(icon("warning", warm))
        else:
            self.setIcon(icon("sound", replace(self._theme, faint=self._theme.quiet)))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Press the button on Enter too."""
        if event.key() in ENTER_KEYS:
            self.click()
        else:
            super().keyPressEvent(event)
