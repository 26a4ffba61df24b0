"""Figures on cards in the colours of the window, scaled to the available width."""

from contextlib import suppress
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPainterPath, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from apd_viewer.files.storage.regular_files import read_bytes

_EDGE = 12  # px; margin around the picture
_ROUND = 8


class FigureView(QWidget):
    """Picture on a card, scaled to the card's width.

    Parameters
    ----------
    description : str
        Description of the figure for screen readers.
    is_drawn : bool
        Whether it consists of lines and text on white, which dark windows show light on dark.
    """

    def __init__(self, path: Path, description: str, is_drawn: bool = True) -> None:
        super().__init__()
        self._file, self._less, self._is_drawn = QImage(), 0, is_drawn
        with suppress(OSError):
            self._file.loadFromData(read_bytes(path))
        self._apply_palette()
        self.setAccessibleName(description)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)
        self.setMinimumSize(320, 80)

    @property
    def has_picture(self) -> bool:
        """True if the picture could be loaded."""
        return not self._file.isNull()

    def _apply_palette(self) -> None:
        """Prepare the picture in the colours of the window."""
        ink, paper = self.palette().text().color(), self.palette().base().color()
        is_dark = self._is_drawn and paper.lightnessF() < ink.lightnessF()
        self._paper = paper if is_dark else QColor(Qt.GlobalColor.white)
        self._picture = _light_on_dark(self._file, ink, paper) if is_dark else self._file

    def changeEvent(self, event: QEvent) -> None:
        """Follow the colours of the window."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._apply_palette()
            self.update()

    def shrink_by(self, pixels: int) -> None:
        """Reduce the preferred height of the figure by ``pixels``."""
        self._less = pixels
        self.updateGeometry()

    def hasHeightForWidth(self) -> bool:
        """True: the picture keeps its aspect ratio."""
        return True

    def heightForWidth(self, width: int) -> int:
        """Height of the picture and its margins for a width."""
        size = self._picture.size()
        full = 2 * _EDGE + round((width - 2 * _EDGE) * size.height() / max(1, size.width()))
        return max(self.minimumHeight(), full - self._less)

    def sizeHint(self) -> QSize:
        """Preferred size in a dialog, 860 pixels wide."""
        return QSize(860, self.heightForWidth(860))

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the card and the picture."""
        painter = QPainter(self)
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        card = QPainterPath()
        card.addRoundedRect(QRectF(self.rect()), _ROUND, _ROUND)
        painter.fillPath(card, self._paper)
        if self._picture.isNull():
            return
        room = self.rect().adjusted(_EDGE, _EDGE, -_EDGE, -_EDGE)
        ratio = self.devicePixelRatioF()
        scaled = self._picture.scaled(
            room.size() * ratio,
            Qt.AspectRatioMode.KeepAspectRatio,
            Qt.TransformationMode.SmoothTransformation,
        )
        scaled.setDevicePixelRatio(ratio)
        size = scaled.deviceIndependentSize()
        left = room.left() + (room.width() - size.width()) / 2
        top = room.top() + (room.height() - size.height()) / 2
        painter.drawImage(round(left), round(top), scaled)


def _light_on_dark(picture: QImage, ink: QColor, paper: QColor) -> QImage:
    """Picture with inverted lightness, from ``paper`` for white to ``ink`` for black."""
    opaque = picture.convertToFormat(QImage.Format.Format_RGB32)
    wide, high = opaque.width(), opaque.height()
    bgra = np.asarray(opaque.constBits(), np.uint8).reshape(high, wide, 4)
    bgr = bgra[..., :3] / np.float32(255.0)
    inverted = bgr + (1.0 - bgr.max(axis=2, keepdims=True) - bgr.min(axis=2, keepdims=True))
    first, last = (np.array([color.blue(), color.green(), color.red()], np.float32) for color in (paper, ink))
    shown = np.full_like(bgra, 255)
    shown[..., :3] = np.rint(first + inverted * (last - first))
    return QImage(shown.data, wide, high, QImage.Format.Format_RGB32).copy()
