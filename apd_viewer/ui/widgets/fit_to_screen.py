"""Windows limited to the screen, and rows wrapped into columns."""

from PySide6.QtCore import QPoint, QSize
from PySide6.QtWidgets import QBoxLayout, QWidget


def largest_on_screen(window: QWidget) -> QSize:
    """Largest size of a window to fit the screen with its frame."""
    return window.screen().availableGeometry().size() - (window.frameGeometry().size() - window.size())


def resize_on_screen(window: QWidget, size: QSize) -> None:
    """Resize a window within the screen, moving it as little as possible."""
    room, frame = window.screen().availableGeometry(), window.frameGeometry()
    border = frame.size() - window.size()
    window.resize(size.boundedTo(largest_on_screen(window)))
    frame.setSize(window.size() + border)
    x = max(min(frame.left(), room.right() + 1 - frame.width()), room.left())
    y = max(min(frame.top(), room.bottom() + 1 - frame.height()), room.top())
    # A window not shown yet has no known position; the window manager chooses one.
    if window.isVisible() and QPoint(x, y) != frame.topLeft():
        window.move(x, y)


def arrange_row(row: QBoxLayout, available_width: float) -> bool:
    """Lay out ``row`` horizontally if it fits in ``available_width`` px, else stacked.

    Returns whether it is laid out horizontally.
    """
    row.setDirection(QBoxLayout.Direction.LeftToRight)
    row.activate()  # includes changes inside nested rows
    fits = row.sizeHint().width() <= available_width
    if not fits:
        row.setDirection(QBoxLayout.Direction.TopToBottom)
        row.activate()
    return fits
