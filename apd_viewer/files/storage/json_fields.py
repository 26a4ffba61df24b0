"""Validated reading of JSON from damaged or hostile files."""

from __future__ import annotations

import json
from typing import Any, TypeVar

import numpy as np

from apd_viewer.language import tr

T = TypeVar("T")

# Largest accepted number; powers of larger ones overflow.
_LARGEST = 1e60
_LONGEST = 10_000  # maximum number of characters of a text


class JsonFields:
    """Validated fields of a JSON object; unknown fields are ignored.

    All methods raise ValueError, with a phrase, if a field is missing or of another type.

    Parameters
    ----------
    value : object
        Value parsed from JSON.
    name : str
        Name of the object in error messages.
    """

    def __init__(self, value: object, name: str) -> None:
        if not isinstance(value, dict):
            raise _damage_error(name)
        self._said = value

    @classmethod
    def parse(cls, content: bytes, name: str) -> JsonFields:
        """Parse a JSON object from UTF-8 text."""
        try:
            return cls(json.loads(content.decode(), parse_constant=_refuse_constant), name)
        except (ValueError, RecursionError):
            raise _damage_error(name) from None

    @property
    def raw_object(self) -> dict[str, Any]:
        """The object as read, for writing it unchanged."""
        return self._said

    def has_value(self, key: str) -> bool:
        """True if the field ``key`` is present and not null."""
        return self._said.get(key) is not None

    def nested_fields(self, key: str) -> JsonFields:
        """Fields of the object under a key."""
        return JsonFields(self._said.get(key), key)

    def nested_list(self, key: str, max_count: int) -> list[JsonFields]:
        """List of at most ``max_count`` objects under a key."""
        return [JsonFields(each, key) for each in self._list(key, max_count)]

    def texts(self, key: str, max_count: int) -> list[str]:
        """List of at most ``max_count`` strings under a key."""
        return [self._checked_value(key, each, str) for each in self._list(key, max_count)]

    def text(self, key: str) -> str:
        """Non-empty text under a key."""
        said = self._checked_value(key, self._said.get(key), str)
        if not 0 < len(said) <= _LONGEST:
            raise _damage_error(key)
        return said

    def flag(self, key: str) -> bool:
        """Boolean under a key."""
        return self._checked_value(key, self._said.get(key), bool)

    def count(self, key: str) -> int:
        """Non-negative integer under a key."""
        return self._checked_count(key, self._said.get(key))

    def vertices(self, key: str, n: int) -> tuple[int, ...]:
        """List of vertices of a mesh with ``n`` under a key; empty if missing."""
        found = (
            tuple(self._checked_count(key, each) for each in self._list(key, n))
            if self.has_value(key)
            else ()
        )
        if any(vertex >= n for vertex in found):
            raise ValueError(tr("“{key}” in it refers to a vertex that does not exist").format(key=key))
        return found

    def number(self, key: str, least: float = -_LARGEST, most: float = _LARGEST) -> float:
        """Number under a key, within a range."""
        said = self._said.get(key)
        if not _has_shape(said, ()) or not least <= said <= most:  # type: ignore[operator]
            raise _damage_error(key)
        return float(said)  # type: ignore[arg-type]

    def array(self, key: str, *shape: int) -> np.ndarray:
        """Float array of a given shape under a key, from nested lists of numbers."""
        said = self._said.get(key)
        if not _has_shape(said, shape):
            raise _damage_error(key)
        return np.array(said, dtype=np.float64)

    def arrays(self, key: str, max_count: int, *shape: int) -> list[np.ndarray]:
        """List of at most ``max_count`` arrays of a shape; empty if the field is missing."""
        if not self.has_value(key):
            return []
        found = self._list(key, max_count)
        if not all(_has_shape(each, shape) for each in found):
            raise _damage_error(key)
        return [np.array(each, dtype=np.float64) for each in found]

    def _list(self, key: str, max_count: int) -> list[object]:
        said = self._checked_value(key, self._said.get(key), list)
        if len(said) > max_count:
            raise _damage_error(key)
        return said

    def _checked_count(self, key: str, value: object) -> int:
        number = self._checked_value(key, value, int)
        if isinstance(number, bool) or not 0 <= number < 2**53:
            raise _damage_error(key)
        return number

    @staticmethod
    def _checked_value(key: str, value: object, kind: type[T]) -> T:
        if not isinstance(value, kind):
            raise _damage_error(key)
        return value


def _damage_error(name: str) -> ValueError:
    return ValueError(tr("its “{name}” is damaged").format(name=name))


def _refuse_constant(word: str) -> object:
    """Raise ValueError for NaN and Infinity, written by Python but invalid JSON."""
    raise ValueError(tr("{word} is not a number").format(word=word))


def _has_shape(value: object, shape: tuple[int, ...]) -> bool:
    if shape:
        fits = isinstance(value, list) and len(value) == shape[0]
        return fits and all(_has_shape(each, shape[1:]) for each in value)  # type: ignore[attr-defined]
    return isinstance(value, int | float) and not isinstance(value, bool) and -_LARGEST <= value <= _LARGEST
