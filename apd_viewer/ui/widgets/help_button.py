"""Help button "?" of a dialog, and its help shortcut."""

from collections.abc import Callable
from typing import ClassVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut, QShowEvent
from PySide6.QtWidgets import QToolButton, QWidget

from apd_viewer.language import tr


class HelpButton(QToolButton):
    """Opens the manual page on the button's window, like F1.

    Attributes
    ----------
    explain_widget : callable
        Opens the manual at a widget; set by the room that has the manual.
    """

    explain_widget: ClassVar[Callable[[QWidget], object]] = staticmethod(lambda _: None)

    def __init__(self) -> None:
        super().__init__(objectName="help", text="?", accessibleName=tr("Help"))
        self.setToolTip(tr("Open the manual page on this window (F1)"))
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setFixedSize(26, 26)
        self.clicked.connect(lambda: HelpButton.explain_widget(self.window()))
        self._key: QShortcut | None = None

    def showEvent(self, event: QShowEvent) -> None:
        """Add the help shortcut to the window around the button."""
        super().showEvent(event)
        if self._key is None:
            window = self.window()
            self._key = QShortcut(QKeySequence(QKeySequence.StandardKey.HelpContents), window)
            self._key.activated.connect(lambda: HelpButton.explain_widget(window.focusWidget() or window))
