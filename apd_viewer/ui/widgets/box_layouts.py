"""Rows and columns of widgets and of other layouts, and windows within the screen."""

from typing import TypeVar

from PySide6.QtCore import QEvent, QPoint, QSize, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QLayout, QVBoxLayout, QWidget

STRETCH = None  # stretch taking the remaining room
Part = QWidget | QLayout | int | None | tuple[QWidget | QLayout, int] | tuple[QWidget, int, Qt.AlignmentFlag]
Margins = tuple[int, int, int, int]
_Box = TypeVar("_Box", bound=QBoxLayout)


def row_layout(
    *parts: Part, spacing: int = 8, margins: Margins | None = (0, 0, 0, 0), parent: QWidget | None = None
) -> QHBoxLayout:
    """Row of parts, from left to right; see :func:`column_layout`."""
    return _fill(QHBoxLayout(parent, spacing=spacing), margins, parts)


def column_layout(
    *parts: Part, spacing: int = 4, margins: Margins | None = (0, 0, 0, 0), parent: QWidget | None = None
) -> QVBoxLayout:
    """Column of parts, from top to bottom.

    Parameters
    ----------
    parts
        Of :func:`add_parts`.
    spacing : int
        Between the parts, px; -1 is that of the style.
    margins : tuple of int or None
        Left, top, right and bottom, px; None for those of the style.
    """
    return _fill(QVBoxLayout(parent, spacing=spacing), margins, parts)


def _fill(box: _Box, margins: Margins | None, parts: tuple[Part, ...]) -> _Box:
    if margins is not None:
        box.setContentsMargins(*margins)
    add_parts(box, *parts)
    return box


def add_parts(box: QBoxLayout, *parts: Part) -> None:
    """Add parts at the end of a row or column.

    A part is a widget or layout, optionally with its stretch, a widget with stretch and alignment, a space in
    px, or STRETCH.
    """
    for part in parts:
        if part is STRETCH:
            box.addStretch(1)
        elif isinstance(part, int):
            box.addSpacing(part)
        else:
            given = part if isinstance(part, tuple) else (part,)
            add = box.addWidget if isinstance(given[0], QWidget) else box.addLayout
            add(*given)


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


class LayoutBoundary(QWidget):
    """Frame of one widget, which tells its parent of new size hints alone.

    In Qt a label with another text of the same size has every layout around it made anew, that of the main
    window last. It repaints the separators, and so the whole window is composed once more for each text.
    """

    def __init__(self, content: QWidget) -> None:
        super().__init__()
        content.setParent(self)
        self.setFocusProxy(content)
        self.setSizePolicy(content.sizePolicy())
        self.setMinimumSize(content.minimumSize())
        self._content = content
        self._told = self._hints

    @property
    def _hints(self) -> tuple[QSize, QSize]:
        return self._content.sizeHint(), self._content.minimumSizeHint()

    def sizeHint(self) -> QSize:
        """Size hint of the content."""
        return self._content.sizeHint()

    def minimumSizeHint(self) -> QSize:
        """Minimum size hint of the content."""
        return self._content.minimumSizeHint()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fill the frame."""
        super().resizeEvent(event)
        self._content.setGeometry(self.rect())

    def event(self, event: QEvent) -> bool:
        """Tell the parent of new size hints."""
        if event.type() == QEvent.Type.LayoutRequest and self._hints != self._told:
            self._told = self._hints
            self.updateGeometry()
        return super().event(event)
