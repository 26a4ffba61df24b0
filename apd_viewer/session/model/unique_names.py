"""Unique names of handles and regions."""

from __future__ import annotations

from collections.abc import Collection
from itertools import count

from apd_viewer.files.selections.selection import default_name


def next_name(kind: str, taken: Collection[str], first: int = 1) -> str:
    """The first free name of "kind 1", "kind 2" and so on."""
    return next(name for k in count(first) if (name := default_name(kind, k)) not in taken)


def unique_name(requested: str, current: str, taken: Collection[str]) -> str:
    """New name; the ``current`` one if blank, numbered if taken."""
    requested, others = requested.strip(), set(taken) - {current}
    if requested in others:
        return next_name(requested, others, first=2)
    return requested or current
