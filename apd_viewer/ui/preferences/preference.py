"""A preference: name, default and allowed values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Option(Generic[T]):
    """An allowed value, how it is stored, and its title."""

    stored: str
    value: T
    title: str


@dataclass(frozen=True)
class OneOf(Generic[T]):
    """A few allowed values, in the order of a list."""

    options: tuple[Option[T], ...]

    def from_text(self, stored: str) -> T:
        """Value of a stored text; raises ValueError if there is none."""
        for option in self.options:
            if option.stored == stored:
                return option.value
        raise ValueError(stored)

    def to_text(self, value: T) -> str:
        """Text to store for a value."""
        return next(option.stored for option in self.options if option.value == value)


@dataclass(frozen=True)
class NumberRange:
    """Numbers from ``least`` to ``most``, with a suffix such as " px"."""

    least: float
    most: float
    suffix: str

    def from_text(self, stored: str) -> float:
        """Number of a stored text; raises ValueError if it is not one of them."""
        value = float(stored)
        if not self.least <= value <= self.most:  # not a number is not between them either
            raise ValueError(stored)
        return value

    def to_text(self, value: float) -> str:
        """Text to store for a number."""
        return f"{value:g}"


@dataclass(frozen=True, eq=False)
class Preference(Generic[T]):
    """A row of the Settings page.

    Parameters
    ----------
    name : str
        Under which it is stored; it never changes.
    default : T
    allowed : OneOf or NumberRange
    title, tip : str
    note : str
        Shown beside the value; empty where the title says all.
    """

    name: str
    default: T
    allowed: OneOf[T] | NumberRange
    title: str
    tip: str
    note: str = ""
