"""Names that tell handles and regions apart."""

from __future__ import annotations

from collections.abc import Collection
from itertools import count

from apd_viewer.files.selections.selection import numbered


def next_name(kind: str, taken: Collection[str], first: int = 1) -> str:
    """The first of "kind 1", "kind 2" and so on that is not taken."""
    return next(name for k in count(first) if (name := numbered(kind, k)) not in taken)


def new_name(asked: str, present: str, taken: Collection[str]) -> str:
    """The name to have instead of the ``present`` one: that one if blank, with a number if others have it."""
    asked, others = asked.strip(), set(taken) - {present}
    if asked in others:
        return next_name(asked, others, first=2)
    return asked or present
