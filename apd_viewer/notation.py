"""Notation of displayed numbers, also in translated texts, and of units of length."""

from __future__ import annotations

import re
import string
from numbers import Number
from typing import Any, NamedTuple

# Whole numbers: each ratio of two is rounded once, so that 25mm are exactly 2.5cm.
MICROMETRES = {"mm": 1e3, "cm": 1e4, "m": 1e6, "in": 25_400.0, "ft": 304_800.0}
METRES = {symbol: size / 1e6 for symbol, size in MICROMETRES.items()}
_LIKE_THOUSANDS = re.compile(r"[-+−]?[1-9]\d{0,2},\d{3}")


class Notation(NamedTuple):
    """Decimal and group separators of displayed numbers.

    Attributes
    ----------
    point, group : str
        Before the decimals, and between groups of three digits.
    """

    point: str = "."
    group: str = ","

    @classmethod
    def from_example(cls, example: str) -> Notation:
        """Notation derived from a language's spelling of the number 1234.5."""
        signs = re.fullmatch(r"1(\D?)234(\D)5", example)
        return cls(signs[2], signs[1]) if signs else cls()

    def localized_number(self, number: str) -> str:
        """Number in this notation; ``number`` is as formatted by Python."""
        return number.translate({ord(","): self.group, ord("."): self.point})

    def editable_number(self, number: str) -> str:
        """Ungrouped number in this notation, unambiguous when read back."""
        text = self.localized_number(number)
        return text + "0" if self.point == "," and _LIKE_THOUSANDS.fullmatch(text) else text


class _NumberFormatter(string.Formatter):
    """Formatter of numbers in the notation in use."""

    def format_field(self, value: Any, spec: str) -> str:
        text: str = super().format_field(value, spec)
        return localized_number(text) if isinstance(value, Number) else text


class TranslatedText(str):
    """Translated text; numbers inserted into it follow the notation in use."""

    __slots__ = ()

    def format(self, *values: object, **named: object) -> str:
        """Insert values as :meth:`str.format` does, numbers in the notation in use."""
        return _FORMATTER.vformat(self, values, named)


_FORMATTER = _NumberFormatter()
_in_use = Notation()


def use_notation(chosen: Notation) -> None:
    """Set the notation of all numbers displayed from now on."""
    global _in_use
    _in_use = chosen


def notation() -> Notation:
    """Decimal and group separators in use."""
    return _in_use


def editable_number(number: str) -> str:
    """Ungrouped number for an input field, in the notation in use."""
    return _in_use.editable_number(number)


def localized_number(number: str) -> str:
    """Number formatted by Python, converted to the notation in use."""
    return _in_use.localized_number(number)
