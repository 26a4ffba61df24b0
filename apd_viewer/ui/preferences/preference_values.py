"""Preferences with their allowed values, stored on every change."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from PySide6.QtCore import QObject, QSettings, Signal

_LOGGER = logging.getLogger(__name__)


class PreferenceValues(QObject):
    """Current values of the preferences; unreadable ones fall back to defaults.

    Attributes
    ----------
    changed : Signal(Preference)
    """

    changed = Signal(object)

    def __init__(self, settings: QSettings) -> None:
        super().__init__()
        self._settings = settings
        self._values: dict[Preference[Any], Any] = {}
        # A list, since signal connections would keep the window of the callbacks alive forever.
        self._followers: list[tuple[Preference[Any], Callable[[Any], object]]] = []

    def __getitem__(self, preference: Preference[T]) -> T:
        if preference not in self._values:
            self._values[preference] = self._read(preference)
        value: T = self._values[preference]
        return value

    def _read(self, preference: Preference[Any]) -> Any:
        stored = self._settings.value(preference.name)
        if stored is None:
            return preference.default
        try:
            return preference.allowed.parse_text(str(stored))
        except ValueError:
            _LOGGER.warning("The setting %s cannot be %r; using the default", preference.name, stored)
            return preference.default

    def choose(self, preference: Preference[T], value: T) -> None:
        """Store a value and notify the observers."""
        self._settings.setValue(preference.name, preference.allowed.to_text(value))  # type: ignore[arg-type]
        if value != self[preference]:
            self._values[preference] = value
            for followed, use in self._followers:
                if followed is preference:
                    use(value)
            self.changed.emit(preference)

    def restore_defaults(self, preferences: Iterable[Preference[Any]]) -> None:
        """Reset preferences to their defaults."""
        for preference in preferences:
            self.choose(preference, preference.default)
            self._settings.remove(preference.name)  # the default may improve in a later version

    def apply_now_and_on_change(self, preference: Preference[T], use: Callable[[T], object]) -> None:
        """Call ``use`` with the value now and after every change."""
        self.on_change(preference, use)
        use(self[preference])

    def on_change(self, preference: Preference[T], use: Callable[[T], object]) -> None:
        """Call ``use`` with the value after every change."""
        self._followers.append((preference, use))


T = TypeVar("T")


@dataclass(frozen=True)
class Option(Generic[T]):
    """Allowed value with its stored text and its title."""

    stored: str
    value: T
    title: str


@dataclass(frozen=True)
class Choice(Generic[T]):
    """Finite set of allowed values, in display order."""

    options: tuple[Option[T], ...]

    def parse_text(self, stored: str) -> T:
        """Value for a stored text; raises ValueError if it is not allowed."""
        for option in self.options:
            if option.stored == stored:
                return option.value
        raise ValueError(stored)

    def to_text(self, value: T) -> str:
        """Stored text of a value."""
        return next(option.stored for option in self.options if option.value == value)


@dataclass(frozen=True)
class NumberRange:
    """Numbers from ``least`` to ``most``, displayed with a suffix such as " px"."""

    least: float
    most: float
    suffix: str

    def parse_text(self, stored: str) -> float:
        """Parse a stored number; raises ValueError if it is out of range."""
        value = float(stored)
        if not self.least <= value <= self.most:  # this form also rejects NaN
            raise ValueError(stored)
        return value

    def to_text(self, value: float) -> str:
        """Stored text of a number."""
        return f"{value:g}"


@dataclass(frozen=True, eq=False)
class Preference(Generic[T]):
    """Preference shown as a row of the Settings page.

    Parameters
    ----------
    name : str
        Under which it is stored; it never changes.
    default : T
    note : str
        Shown beside the value; empty where the title says all.
    """

    name: str
    default: T
    allowed: Choice[T] | NumberRange
    title: str
    tip: str
    note: str = ""
