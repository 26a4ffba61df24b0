"""Number formats of a terminal: in ASCII, as some have no minus sign."""

from __future__ import annotations

from apd_viewer.presentation import number_format


def format_signed(value: float, decimals: int) -> str:
    """The number with its sign; no sign if it rounds to zero."""
    return number_format.format_signed(value, decimals).replace("−", "-")
