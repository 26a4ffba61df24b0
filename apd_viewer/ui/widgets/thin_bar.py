"""Thin progress bar without text."""

import time

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication, QProgressBar

_SCALE = 1000
_PAUSE = 0.2  # s between two frames of the busy animation, if slowed down


class ThinBar(QProgressBar):
    """Thin progress bar without text.

    A busy bar moves, and each of its draws composes the whole window. Qt continues the animation while the
    bar is empty, although its length is then known.
    """

    def __init__(self) -> None:
        super().__init__(maximum=_SCALE, textVisible=False, objectName="thin")
        self._drawn = 0.0

    def show_fraction(self, fraction: float | None) -> None:
        """Show the completed fraction of the work; None if unknown."""
        maximum, value = (0, 0) if fraction is None else (_SCALE, round(_SCALE * fraction))
        if (maximum, value) == (self.maximum(), self.value()):
            return
        # QProgressBar draws each new value at once, and the whole window is composed once more for it.
        self.setUpdatesEnabled(False)
        self.setMaximum(maximum)
        self.setValue(value)
        self.setUpdatesEnabled(True)

    def event(self, event: QEvent) -> bool:
        """Stop the busy animation once progress is known; slow it if cursors do not blink."""
        if event.type() == QEvent.Type.StyleAnimationUpdate:
            if self.maximum():
                event.ignore()
                return True
            if not QApplication.cursorFlashTime() and time.monotonic() - self._drawn < _PAUSE:
                event.accept()
                return True
            self._drawn = time.monotonic()
        return super().event(event)
