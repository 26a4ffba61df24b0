"""Text files: encodings, number parsing, and replacement of numbers in place."""

import codecs
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.language import in_quotes, tr

_LONGEST = 40  # maximum number of characters quoted from a file
_SAMPLE = 64  # bytes checked for UTF-16 without a byte order mark: every second byte is zero


class Encoding(NamedTuple):
    """Byte order mark of a file, and the codec of its text."""

    mark: bytes
    codec: str

    def encode(self, text: bytes) -> bytes:
        """Encode UTF-8 text in the encoding of the file."""
        return self.mark + (text if self.codec == "utf-8" else text.decode().encode(self.codec))


_MARKED = (
    Encoding(codecs.BOM_UTF8, "utf-8"),
    Encoding(codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose BOM is a prefix of UTF-32's
    Encoding(codecs.BOM_UTF32_BE, "utf-32-be"),
    Encoding(codecs.BOM_UTF16_LE, "utf-16-le"),
    Encoding(codecs.BOM_UTF16_BE, "utf-16-be"),
)


def decoded_text(content: bytes) -> tuple[bytes, Encoding | None]:
    """Text of a file as UTF-8 with its encoding; other content as is, with None."""
    encoding = next((each for each in _MARKED if content.startswith(each.mark)), None) or _utf_16(content)
    if encoding is None:
        return content, None
    body = content[len(encoding.mark) :]
    try:
        # Bytes after a UTF-8 mark are kept unchanged, even if invalid.
        text = body if encoding.codec == "utf-8" else body.decode(encoding.codec).encode()
    except UnicodeDecodeError:
        return content, None
    # Binary data may happen to start with a byte order mark.
    return (content, None) if b"\0" in text else (text, encoding)


def _utf_16(content: bytes) -> Encoding | None:
    even, odd = content[:_SAMPLE:2], content[1:_SAMPLE:2]
    if len(content) < _SAMPLE or any(even) == any(odd):
        return None
    if not all(even if any(even) else odd):
        return None
    return Encoding(b"", "utf-16-le" if any(even) else "utf-16-be")


def with_line_feeds(content: bytes) -> bytes:
    """Content with lone carriage returns as line feeds, at the same length."""
    if b"\r" not in content or content.count(b"\r") == content.count(b"\r\n"):
        return content
    return re.sub(rb"\r(?!\n)", b"\n", content)


def content_lines(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Offset and text of each non-empty line, without comments."""
    start = 0
    for line in content.split(b"\n"):
        said = line.partition(b"#")[0] if b"#" in line else line
        if said.strip():
            yield start, said
        start += len(line) + 1


def parse_numbers(words: Sequence[bytes]) -> np.ndarray:
    """Parse words as numbers (k,); raises ValueError naming the first invalid word."""
    try:
        return np.array([float(word) for word in words], dtype=np.float64)
    except ValueError:
        bad = next(word for word in words if not _names(float, word))
        raise ValueError(tr("{text} is not a number").format(text=excerpt(bad))) from None


def parse_integers(words: Sequence[bytes]) -> list[int]:
    """Parse words as integers; raises ValueError naming the first invalid word."""
    try:
        return [int(word) for word in words]
    except ValueError:
        bad = next(word for word in words if not _names(int, word))
        raise ValueError(tr("{text} is not a whole number").format(text=excerpt(bad))) from None


def excerpt(content: bytes) -> str:
    """Quoted beginning of some file content, for an error message."""
    return in_quotes(content.strip().decode(errors="replace")[:_LONGEST])


def _names(kind: Callable[[bytes], object], word: bytes) -> bool:
    try:
        kind(word)
    except ValueError:
        return False
    return True


class TextEdits:
    """Pending replacements of numbers in a text file."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._new: list[tuple[int, int, float]] = []

    def replace_numbers(self, spans: Iterable[tuple[int, int]], old: np.ndarray, new: np.ndarray) -> None:
        """Write ``new`` over the numbers at ``spans``; unchanged ones stay as written."""
        changed = ~((new == old) | (np.isnan(new) & np.isnan(old)))
        for (start, end), number, differs in zip(spans, new.tolist(), changed.tolist(), strict=True):
            if differs:
                self._new.append((start, end, number))

    def edited_content(self) -> bytes:
        """File content with all replacements applied."""
        pieces, last = [], 0
        for start, end, number in sorted(self._new):
            pieces += [self._content[last:start], b"%r" % number]
            last = end
        return b"".join([*pieces, self._content[last:]])


class Splice(NamedTuple):
    """Span of a file with its new bytes, or with an increment for its integer."""

    start: int
    end: int
    new: bytes | int


def spliced_content(content: bytes, splices: Iterable[Splice]) -> bytes:
    """Content with all splices applied; raises ValueError if two overlap.

    Several increments of one number are summed.
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
            raise ValueError(tr("two of its arrays overlap"))
        pieces += [content[last:start], new]
        last = end
    return b"".join([*pieces, content[last:]])


_WORD = re.compile(rb"\S+")


def text_values(text: bytes, kind: str) -> np.ndarray:
    """Values (k,) of a text, as int64 or float64 by a type such as ``i4``.

    Raises
    ------
    ValueError
        If a word is no number, or none of its type.
    """
    found = parse_numbers(text.split())
    if kind[0] == "f":
        return found
    if not (np.abs(found) < 2.0**53).all() or (found != np.floor(found)).any():
        raise ValueError(tr("one of its arrays has fractional numbers"))
    return found.astype(np.int64)


def with_replaced_values(text: bytes, old: np.ndarray, new: np.ndarray) -> bytes:
    """Text with its ``old`` values (k,) replaced by the ``new`` ones if different."""
    edits = TextEdits(text)
    edits.replace_numbers([word.span() for word in _WORD.finditer(text)], old, new)
    return edits.edited_content()
