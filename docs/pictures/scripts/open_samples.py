"""The four samples, as they are opened."""

import ink
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage
from stage import Stage

from apd_viewer.files.samples import SAMPLES

_WIDE, _HIGH = 230, 220


def draw(stage: Stage) -> QImage:
    """Take a picture of each in the view, without tools."""
    scale = 1 if stage.quick else 2
    whole = ink.blank(4 * _WIDE, _HIGH + 34, scale)
    with ink.begun(whole) as painter:
        for column, (name, sample) in enumerate(SAMPLES.items()):
            stage.open_sample(name)
            stage.look(0.5, 0.42, 0.85)
            painter.drawImage(QPointF(column * _WIDE + 15, 15), stage.scene(_WIDE - 30, _HIGH - 30))
            painter.setFont(ink.font(10.5, bold=True))
            painter.setPen(QColor(ink.INK))
            box = QRectF(column * _WIDE, _HIGH, _WIDE, 26)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, sample.title)
    return ink.carded(whole)
