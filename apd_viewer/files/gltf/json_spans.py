"""Byte spans of values in a JSON text, for replacement in place."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import TypeAlias

JsonPath: TypeAlias = tuple[str | int, ...]

_SPACE = re.compile(r"[ \t\r\n]*")
_DECODER = json.JSONDecoder()


def value_spans(text: str, paths: Sequence[JsonPath]) -> dict[JsonPath, tuple[int, int]]:
    """Begin and end of the values at ``paths``; missing ones are left out."""
    found: dict[JsonPath, tuple[int, int]] = {}
    _find(text, _skip(text, 0), set(paths), (), found)
    return found


def with_replaced_values(text: str, changes: Sequence[tuple[JsonPath, str]]) -> str:
    """The text with other values at the paths of ``changes``."""
    found = value_spans(text, [path for path, _ in changes])
    for path, new in sorted(changes, key=lambda change: -found[change[0]][0]):
        begin, end = found[path]
        text = text[:begin] + new + text[end:]
    return text


def _find(
    text: str, at: int, wanted: set[JsonPath], here: JsonPath, found: dict[JsonPath, tuple[int, int]]
) -> int:
    """Search the value at ``at``; return its end."""
    if not any(path[: len(here)] == here for path in wanted):
        return _DECODER.raw_decode(text, at)[1]
    if text[at] not in "{[" or here in wanted:
        end = _DECODER.raw_decode(text, at)[1]
        if here in wanted:
            found[here] = at, end
        return end
    is_object, close, place = text[at] == "{", "}" if text[at] == "{" else "]", 0
    at = _skip(text, at + 1)
    while text[at] != close:
        key: str | int = place
        if is_object:
            key, at = _DECODER.raw_decode(text, at)
            at = _skip(text, _skip(text, at) + 1)  # the colon
        at = _skip(text, _find(text, at, wanted, (*here, key), found))
        if text[at] == ",":
            at = _skip(text, at + 1)
        place += 1
    return at + 1


def _skip(text: str, at: int) -> int:
    match = _SPACE.match(text, at)
    return match.end() if match else at
