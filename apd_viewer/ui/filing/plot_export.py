"""Plots on disk: the picture as PNG or SVG, the numbers as CSV."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QRect, QRectF, QSize
from PySide6.QtGui import QColor, QImage, QPaintDevice, QPainter
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QWidget

from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import tr
from apd_viewer.ui.filing import file_dialogs

_SCALE = 3  # pixels of a picture for each on the screen
_PAPER = "#ffffff"


def ask_where_to_save_plots(parent: QWidget, folder: Path, name: str, suffix: str) -> Path | None:
    """Choose a target for plots; None if cancelled."""
    return file_dialogs.ask_where_to_save(parent, tr("Save plots"), folder / f"{name}{suffix}")


def write_drawing(path: Path, size: QSize, draw: Callable[[QPainter], None]) -> None:
    """Write a drawing as SVG or PNG on white, by the suffix.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with replacing_file(path) as scratch:
        if path.suffix.lower() == ".svg":
            sheet = QSvgGenerator()
            sheet.setFileName(str(scratch))
            sheet.setSize(size)
            sheet.setViewBox(QRect(0, 0, size.width(), size.height()))
            sheet.setTitle(tr("Plots of APD Viewer"))
            _paint(sheet, size, draw)
        else:
            image = QImage(size * _SCALE, QImage.Format.Format_RGB32)
            image.setDevicePixelRatio(_SCALE)
            _paint(image, size, draw)
            if not image.save(str(scratch), "PNG"):
                raise OSError(tr("the picture could not be encoded"))


def svg_element(size: QSize, draw: Callable[[QPainter], None]) -> str:
    """SVG element of a drawing, without background."""
    content = QByteArray()
    buffer = QBuffer(content)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    sheet = QSvgGenerator()
    sheet.setOutputDevice(buffer)
    sheet.setSize(size)
    sheet.setViewBox(QRect(0, 0, size.width(), size.height()))
    _paint(sheet, size, draw, paper=None)
    text = bytes(content.data()).decode("utf-8")
    return text[text.index("<svg") :].strip()


def _paint(
    device: QPaintDevice, size: QSize, draw: Callable[[QPainter], None], paper: str | None = _PAPER
) -> None:
    painter = QPainter(device)
    if paper is not None:
        painter.fillRect(QRectF(0, 0, size.width(), size.height()), QColor(paper))
    draw(painter)
    painter.end()
