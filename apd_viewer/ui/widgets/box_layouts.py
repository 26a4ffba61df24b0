"""Rows and columns of widgets and of other layouts."""

from typing import TypeVar

from PySide6.QtCore import Qt
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
