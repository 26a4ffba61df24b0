"""Windows limited to the screen, and rows wrapped into columns."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QSize
from PySide6.QtWidgets import QBoxLayout, QWidget


def largest_on_screen(window: QWidget) -> QSize:
    """Size of a window that fills the screen with its frame."""
    return window.screen().availableGeometry().size() - (window.frameGeometry().size() - window.size())


def resize_on_screen(window: QWidget, size: QSize) -> None:
    """Resize a window within the screen, moving it as little as possible."""
    room, frame = window.screen().availableGeometry(), window.frameGeometry()
    border = frame.size() - window.size()
    window.resize(size.boundedTo(largest_on_screen(window)))
    frame.setSize(window.size() + border)
    x = max(min(frame.left(), room.right() + 1 - frame.width()), room.left())
    y = max(min(frame.top(), room.bottom() + 1 - frame.height()), room.top())
    # The place of a window not yet shown is unknown; the window manager chooses it.
    if window.isVisible() and QPoint(x, y) != frame.topLeft():
        window.move(x, y)


def arrange_row(row: QBoxLayout, available_width: float) -> bool:
    """Arrange ``row`` side by side within ``available_width`` pixels, else stacked.

    Returns whether it stands side by side.
    """
    row.setDirection(QBoxLayout.Direction.LeftToRight)
    row.activate()  # changes inside nested rows are ignored otherwise
    fits = row.sizeHint().width() <= available_width
    if not fits:
        row.setDirection(QBoxLayout.Direction.TopToBottom)
        row.activate()
    return fits
