"""Rows that become columns where they have no room: other languages have longer words."""

from __future__ import annotations

from PySide6.QtWidgets import QBoxLayout


def arrange(row: QBoxLayout, room: float) -> bool:
    """Have what is in ``row`` stand side by side within ``room`` pixels, or else below each other.

    Returns whether it stands side by side.
    """
    row.setDirection(QBoxLayout.Direction.LeftToRight)
    row.activate()  # what has changed within the rows in it is not looked at otherwise
    fits = row.sizeHint().width() <= room
    if not fits:
        row.setDirection(QBoxLayout.Direction.TopToBottom)
        row.activate()
    return fits
