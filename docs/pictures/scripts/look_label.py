"""A made-up label on the sample bottle: at rest, twisted, and in clear PET."""

from pathlib import Path

import ink
import numpy as np
from pairs import side_by_side
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QLinearGradient, QPainter, QPainterPath
from stage import Stage

from apd_viewer.ui.scene.surface_shading import Finish

_WIDE, _HIGH = 1600.0, 400.0  # as the band around the bottle
_DEEP, _WATER, _SAND = QColor("#0b3c5d"), QColor("#1f8fb3"), QColor("#f4ead5")


def draw(stage: Stage) -> QImage:
    """Paint the band, lay the label on it, and show it from the front."""
    stage.open_sample("bottle")
    window, session = stage.window, stage.window.session
    window.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.flatnonzero(np.abs(stage.state.document.mesh.V[:, 1] - 11.0) < 2.6), 1)
    session.painting.end_stroke("Paint")
    window.region_picture.lay(_label_file(stage.folder))
    stage.look(0.05, 0.12, 1.0)
    pictures = [stage.scene(190, 420)]
    stage.twist("60deg")
    for finish in (Finish.CLAY, Finish.PET):
        window.display_options.choose_finish(finish)
        stage.settle()
        pictures.append(stage.scene(190, 420))
    return side_by_side(pictures, ["At rest", "Twisted by 60°", "The same in PET"])


def _label_file(folder: Path) -> Path:
    """Write the label as PNG."""
    label = ink.blank(_WIDE, _HIGH, 2.0)
    with ink.begun(label) as painter:
        sky = QLinearGradient(0.0, 0.0, 0.0, _HIGH)
        sky.setColorAt(0.0, QColor("#d9f0f4"))
        sky.setColorAt(1.0, QColor("#8fd0de"))
        painter.fillRect(QRectF(0.0, 0.0, _WIDE, _HIGH), sky)
        for height, color in ((265.0, QColor("#58b3cb")), (305.0, _WATER), (345.0, _DEEP)):
            painter.fillPath(_waves(height), color)
        painter.fillRect(QRectF(0.0, 0.0, _WIDE, 14.0), _DEEP)
        for middle in (0.0, _WIDE / 2, _WIDE):
            _emblem(painter, middle)
    path = folder / "label.png"
    label.save(str(path))
    return path


def _waves(height: float) -> QPainterPath:
    """Outline of a sea that goes on across the seam."""
    x = np.linspace(0.0, _WIDE, 400)
    y = height + 13.0 * np.sin(2.0 * np.pi * (x * 5 / _WIDE + height / 90.0))
    path = QPainterPath(QPointF(0.0, _HIGH))
    for point in zip(x.tolist(), y.tolist(), strict=True):
        path.lineTo(*point)
    path.lineTo(_WIDE, _HIGH)
    return path


def _emblem(painter: QPainter, middle: float) -> None:
    """Draw the name in an oval."""
    painter.setPen(Qt.PenStyle.NoPen)
    for color, margin in ((_DEEP, 0.0), (_SAND, 9.0), (QColor("#e8743b"), 15.0)):
        painter.setBrush(color)
        painter.drawEllipse(QPointF(middle, 185.0), 205.0 - margin, 130.0 - margin)
    painter.setPen(QColor("white"))
    for text, size, place in (("RIVA", 62.0, 175.0), ("still water", 20.0, 235.0), ("0.5 l", 16.0, 265.0)):
        painter.setFont(ink.font(size, bold=size > 30.0))
        box = QRectF(middle - 200.0, place - 50.0, 400.0, 100.0)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
