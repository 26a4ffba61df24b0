"""Rows wrapped into columns when too narrow, as for longer languages."""

from __future__ import annotations

from PySide6.QtWidgets import QBoxLayout


def arrange(row: QBoxLayout, room: float) -> bool:
    """Arrange ``row`` side by side within ``room`` pixels, else stacked.

    Returns whether it stands side by side.
    """
    row.setDirection(QBoxLayout.Direction.LeftToRight)
    row.activate()  # changes inside nested rows are ignored otherwise
    fits = row.sizeHint().width() <= room
    if not fits:
        row.setDirection(QBoxLayout.Direction.TopToBottom)
        row.activate()
    return fits
