"""Rows wrapped into columns when too narrow, as for longer languages."""

from __future__ import annotations

from PySide6.QtWidgets import QBoxLayout


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
