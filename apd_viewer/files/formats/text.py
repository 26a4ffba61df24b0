"""Numbers in text files: found by place and replaced in place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from apd_viewer.language import tr

_BOM = b"\xef\xbb\xbf"
_LONGEST = 40  # characters quoted from a file


def plain(content: bytes) -> bytes:
    """Content without byte order mark, every line end a line feed; same length."""
    if content.startswith(_BOM):
        content = b" " * len(_BOM) + content[len(_BOM) :]
    return content if b"\n" in content else content.replace(b"\r", b"\n")


def lines(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Spans and words of the non-empty lines, without comments."""
    start = 0
    for line in content.split(b"\n"):
        said = line.partition(b"#")[0] if b"#" in line else line
        if said.strip():
            yield start, said
        start += len(line) + 1


def numbers(words: Sequence[bytes]) -> np.ndarray:
    """Numbers (k,) of words; raises ValueError naming the first bad one."""
    try:
        return np.array([float(word) for word in words], dtype=np.float64)
    except ValueError:
        bad = next(word for word in words if not _names(float, word))
        raise ValueError(tr("{text} is not a number").format(text=shown(bad))) from None


def whole_numbers(words: Sequence[bytes]) -> list[int]:
    """Whole numbers of words; raises ValueError naming the first bad one."""
    try:
        return [int(word) for word in words]
    except ValueError:
        bad = next(word for word in words if not _names(int, word))
        raise ValueError(tr("{text} is not a whole number").format(text=shown(bad))) from None


def shown(said: bytes) -> str:
    """The beginning of a part of a file, within a sentence."""
    return "“" + said.strip().decode(errors="replace")[:_LONGEST] + "”"


def _names(kind: Callable[[bytes], object], word: bytes) -> bool:
    try:
        kind(word)
    except ValueError:
        return False
    return True


class Edits:
    """New words for some places of a file."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._new: list[tuple[int, int, float]] = []

    def numbers(self, spans: Iterable[tuple[int, int]], old: np.ndarray, new: np.ndarray) -> None:
        """Write ``new`` over the numbers at ``spans``; unchanged ones stay as written."""
        changed = ~((new == old) | (np.isnan(new) & np.isnan(old)))
        for (start, end), number, differs in zip(spans, new.tolist(), changed.tolist(), strict=True):
            if differs:
                self._new.append((start, end, number))

    def done(self) -> bytes:
        """The file with all of them."""
        pieces, last = [], 0
        for start, end, number in sorted(self._new):
            pieces += [self._content[last:start], b"%r" % number]
            last = end
        return b"".join([*pieces, self._content[last:]])
