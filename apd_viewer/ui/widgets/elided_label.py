"""Label elided to its width."""

import re

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QFontMetrics, QFontMetricsF, QPainter, QPaintEvent
from PySide6.QtWidgets import QLabel

_MARGIN = 8  # px before and after an elided text
# What would be read as a number of its own, and how it goes on behind the cut.
_NUMBER_AT_END, _GOES_ON = re.compile(r"\d[\d.,]*$"), re.compile(r"[.,]?\d")


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
