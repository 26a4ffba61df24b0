"""Text in terminal columns; wide characters such as Chinese take two."""

import itertools
import re
import unicodedata

from apd_viewer.presentation import number_format

# Wide and Fullwidth characters of the Unicode Character Database, from Hangul to full-width forms.
_WIDE = "\u1100-\u115f\u2e80-\ua4cf\uac00-\ud7a3\uf900-\ufaff\ufe30-\ufe6f\uff00-\uff60\uffe0-\uffe6"
_OPENING, _CLOSING = "（“《「【", "，。、；：？！）”》」】…"
# Lines break between wide characters and at spaces, but not after opening or before closing punctuation.
_PIECE = re.compile(
    rf"\s+|[{_OPENING}]*(?:[{_WIDE}]|[^\s{_WIDE}{_OPENING}{_CLOSING}]+)[{_CLOSING}]*|[{_OPENING}{_CLOSING}]+"
)


def column_count(text: str) -> int:
    """Number of terminal columns taken by a ``text``."""
    return sum(map(_columns, text))


def _columns(sign: str) -> int:
    return 2 if unicodedata.east_asian_width(sign) in ("W", "F") else 1


def padded_text(text: str, columns: int) -> str:
    """The ``text`` padded with spaces to a number of terminal columns."""
    return text + " " * (columns - column_count(text))


def shortened_text(text: str, columns: int) -> str:
    """Beginning of a ``text``, within a number of terminal columns."""
    ends = itertools.accumulate(map(_columns, text))
    return text[: sum(end <= columns for end in ends)]


def wrapped_lines(text: str, columns: int) -> list[str]:
    """Lines of a ``text`` within a number of columns, except for longer words."""
    lines = [""]
    for piece in _PIECE.findall(text):
        if lines[-1] and column_count(lines[-1] + piece.rstrip()) > columns:
            lines.append("")
        lines[-1] += piece if lines[-1] else piece.lstrip()
    return [line.rstrip() for line in lines]


def format_signed(value: float, decimals: int) -> str:
    """The number with its sign; no sign if it rounds to zero."""
    return number_format.format_signed(value, decimals).replace("−", "-")
