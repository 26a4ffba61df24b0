"""Thin progress bar, and label elided to its width."""

import re
import time

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import QFontMetrics, QFontMetricsF, QPainter, QPaintEvent
from PySide6.QtWidgets import QApplication, QLabel, QProgressBar

_SCALE = 1000
_MARGIN = 8  # px before and after an elided text
# What would be read as a number of its own, and how it goes on behind the cut.
_NUMBER_AT_END, _GOES_ON = re.compile(r"\d[\d.,]*$"), re.compile(r"[.,]?\d")
_PAUSE = 0.2  # s between two frames of the busy animation, if slowed down


class ElidedLabel(QLabel):
    """Label elided to its width, with the full text in its tooltip."""

    def setText(self, text: str) -> None:
        """Show ``text`` elided to the width, with the whole of it as tooltip."""
        super().setText(text)
        self.setToolTip(text)

    def sizeHint(self) -> QSize:
        """Room for the whole text."""
        usual = super().sizeHint()
        return usual.expandedTo(QSize(self.room_for(self.text()), usual.height()))

    def room_for(self, text: str) -> int:
        """Width with room for a text."""
        return self.fontMetrics().horizontalAdvance(text) + 2 * _MARGIN

    def minimumSizeHint(self) -> QSize:
        """Zero width, so that other widgets get the space first."""
        return QSize(0, super().minimumSizeHint().height())

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the text, elided on the right."""
        room = self.rect().adjusted(_MARGIN, 0, -_MARGIN, 0)
        painter = QPainter(self)
        painter.setPen(self.palette().windowText().color())
        painter.drawText(
            room, Qt.AlignmentFlag.AlignVCenter, elided_text(self.text(), self.fontMetrics(), room.width())
        )


def elided_text(text: str, metrics: QFontMetrics | QFontMetricsF, width: float) -> str:
    """Text elided on the right to a width in pixels, without part of a number."""
    elided = metrics.elidedText(text, Qt.TextElideMode.ElideRight, int(width))
    kept = elided.removesuffix("…")
    number = _NUMBER_AT_END.search(kept)
    if elided == text or number is None or not _GOES_ON.match(text, len(kept)):
        return elided
    return kept[: number.start()].rstrip() + "…"


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
