"""Figures along the grid of a window, as its painter writes them."""

import re

from PySide6.QtGui import QImage, QPainter


class _Pen(QPainter):
    """A painter that notes what it writes, and where."""

    def __init__(self, image):
        super().__init__(image)
        self.written = []

    def drawText(self, room, flags, text):
        self.written.append((text, room))
        super().drawText(room, flags, text)


def figures(window):
    """Value and place of each figure that is written along the grid."""
    view = window.canvas.viewport
    image = QImage(view.size(), QImage.Format.Format_ARGB32)  # which the painter does not keep
    pen = _Pen(image)
    pen.setFont(window.shell.font())
    window.display_options.ground.paint(pen)
    pen.end()
    plain = [(text.replace("−", "-").replace(",", ""), room) for text, room in pen.written]
    return [(float(text), room) for text, room in plain if re.fullmatch(r"-?[\d.]+", text)]
