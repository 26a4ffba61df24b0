"""Unique names of handles and regions."""

from __future__ import annotations

from collections.abc import Collection
from itertools import count

from apd_viewer.files.selections.selection import numbered


def next_name(kind: str, taken: Collection[str], first: int = 1) -> str:
    """The first free name of "kind 1", "kind 2" and so on."""
    return next(name for k in count(first) if (name := numbered(kind, k)) not in taken)


def new_name(asked: str, present: str, taken: Collection[str]) -> str:
    """New name; the ``present`` one if blank, numbered if taken."""
    asked, others = asked.strip(), set(taken) - {present}
    if asked in others:
        return next_name(asked, others, first=2)
    return asked or present
