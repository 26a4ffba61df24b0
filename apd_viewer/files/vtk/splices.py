"""New content for some places of a file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from apd_viewer.files.formats.text import excerpt
from apd_viewer.language import tr


class Splice(NamedTuple):
    """A place, and its new content; of a whole number there, what is added to it."""

    start: int
    end: int
    new: bytes | int


def spliced_content(content: bytes, splices: Iterable[Splice]) -> bytes:
    """Content with all splices; raises ValueError where two overlap.

    What is added to one number is summed.
    """
    sums: dict[tuple[int, int], int] = {}
    news: dict[tuple[int, int], bytes] = {}
    for start, end, new in splices:
        if isinstance(new, bytes):
            news[start, end] = new
        else:
            sums[start, end] = sums.get((start, end), 0) + new
    for span, by in sums.items():
        number = content[slice(*span)].strip()
        if not number.isdigit():
            raise ValueError(tr("{text} is not a whole number").format(text=excerpt(number)))
        news[span] = b"%d" % (int(number) + by)
    pieces, last = [], 0
    for (start, end), new in sorted(news.items()):
        if start < last:
            raise ValueError(tr("two of its arrays are at one place"))
        pieces += [content[last:start], new]
        last = end
    return b"".join([*pieces, content[last:]])
