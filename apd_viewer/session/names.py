"""Names that tell handles and regions apart."""

from __future__ import annotations

from collections.abc import Collection
from itertools import count


def next_name(kind: str, taken: Collection[str]) -> str:
    """The first of "kind 1", "kind 2" and so on that is not taken."""
    return next(name for k in count(1) if (name := f"{kind} {k}") not in taken)


def new_name(asked: str, present: str, taken: Collection[str]) -> str:
    """The name to have instead of the ``present`` one: with a number if taken, the present one if blank."""
    asked = asked.strip()
    if not asked or asked == present:
        return present
    return next_name(asked, taken) if asked in taken else asked
