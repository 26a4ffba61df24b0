"""Figures on white cards, scaled to the available width."""

from contextlib import suppress
from pathlib import Path

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPaintEvent, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from apd_viewer.files.storage.regular_files import read_bytes

_EDGE = 12  # px; margin around the picture
_ROUND = 8


class FigureView(QWidget):
    """Picture on a white card, scaled to the card's width.

    Parameters
    ----------
    description : str
        Description of the figure for screen readers.
    """

    def __init__(self, path: Path, description: str) -> None:
        super().__init__()
        self._picture, self._less = QPixmap(), 0
        with suppress(OSError):
            self._picture.loadFromData(read_bytes(path))
        self.setAccessibleName(description)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)
        self.setMinimumSize(320, 80)

    @property
    def has_picture(self) -> bool:
        """True if the picture could be loaded."""
        return not self._picture.isNull()

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
        painter.fillPath(card, Qt.GlobalColor.white)
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
        painter.drawPixmap(round(left), round(top), scaled)
