"""Pictures side by side on a card, each with a line below it."""

from __future__ import annotations

from collections.abc import Sequence

import ink
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage

_LINE, _GAP = 19.0, 10.0


def side_by_side(pictures: Sequence[QImage], words: Sequence[str]) -> QImage:
    """A row of pictures of one height; lines below each: the first is bold, the others are quiet."""
    scale = pictures[0].devicePixelRatio()
    widths = [picture.width() / scale for picture in pictures]
    high = max(picture.height() / scale for picture in pictures)
    lines = max(text.count("\n") + 1 for text in words)
    whole = ink.blank(sum(widths) + _GAP * (len(widths) - 1), high + _LINE * lines + 10, scale)
    with ink.begun(whole) as painter:
        x = 0.0
        for picture, width, text in zip(pictures, widths, words, strict=True):
            painter.drawImage(QPointF(x, high - picture.height() / scale), picture)
            for number, line in enumerate(text.split("\n")):
                painter.setFont(ink.font(10.0 if number else 10.5, bold=not number))
                painter.setPen(QColor("#4a515d" if number else ink.INK))
                box = QRectF(x, high + 6 + _LINE * number, width, _LINE)
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, line)
            x += width + _GAP
    return ink.carded(whole)
