"""Numbers in text files: found where they stand, and replaced without touching what is around them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

_BOM = b"\xef\xbb\xbf"


def plain(content: bytes) -> bytes:
    """The content with every byte in its place, but lines that end in a line feed, and no byte order mark."""
    if content.startswith(_BOM):
        content = b" " * len(_BOM) + content[len(_BOM) :]
    return content if b"\n" in content else content.replace(b"\r", b"\n")


def lines(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Where each line of plain content begins, and what it says, comments left out; no empty ones."""
    start = 0
    for line in content.split(b"\n"):
        said = line.partition(b"#")[0] if b"#" in line else line
        if said.strip():
            yield start, said
        start += len(line) + 1


class Edits:
    """New words for some places of a file."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._new: dict[tuple[int, int], bytes] = {}

    def numbers(self, spans: Iterable[tuple[int, int]], old: np.ndarray, new: np.ndarray) -> None:
        """Write ``new`` over the numbers at ``spans``; what is as it was stays as it stands."""
        changed = ~((new == old) | (np.isnan(new) & np.isnan(old)))
        for span, number, differs in zip(spans, new.tolist(), changed.tolist(), strict=True):
            if differs:
                self._new[span] = repr(number).encode()

    def done(self) -> bytes:
        """The file with all of them."""
        pieces, last = [], 0
        for (start, end), word in sorted(self._new.items()):
            pieces += [self._content[last:start], word]
            last = end
        return b"".join([*pieces, self._content[last:]])
