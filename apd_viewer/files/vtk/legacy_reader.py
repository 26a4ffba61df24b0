"""Words and arrays of a legacy VTK file, one after another."""

from __future__ import annotations

import re
from itertools import islice
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.text import excerpt
from apd_viewer.files.vtk.text_values import text_values
from apd_viewer.language import tr

_WORD, _WORDS = re.compile(rb"\s*(\S+)"), re.compile(rb"\S+")
_SPACE = re.compile(rb"[^\S\n]*\n?")
_METADATA_END = re.compile(rb"\n[^\S\n]*\n|\Z")
# Numbers of a binary file are big-endian; ids were written as int before there were types for them.
_TYPES = {
    "char": "i1", "signed_char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2",
    "int": "i4", "unsigned_int": "u4", "long": "i8", "unsigned_long": "u8", "float": "f4", "double": "f8",
    "vtkidtype": "i4", "vtktypeint64": "i8", "vtktypeuint64": "u8", "vtktypeint32": "i4",
    "vtktypeuint32": "u4",
}  # fmt: skip


class LegacyArray(NamedTuple):
    """Values (k,) of an array, and its place in the file.

    Attributes
    ----------
    values : array
        Of a text in double precision.
    start, end : int
    is_text : bool
    """

    values: np.ndarray
    start: int
    end: int
    is_text: bool


class LegacyReader:
    """Cursor in a legacy file; raises ValueError where it is damaged.

    Parameters
    ----------
    content : bytes
    start : int
        Where to begin.
    is_binary : bool
    """

    def __init__(self, content: bytes, start: int, is_binary: bool) -> None:
        self.content = content
        self.position = start
        self._binary = is_binary

    def peek_word(self) -> str:
        """The next word in capitals; empty at the end."""
        found = _WORD.match(self.content, self.position)
        return "" if found is None else found[1][:40].decode("ascii", "replace").upper()

    def read_word(self) -> bytes:
        """The next word."""
        found = _WORD.match(self.content, self.position)
        if found is None:
            raise ValueError(tr("it ends early"))
        self.position = found.end()
        return found[1]

    def read_count(self) -> int:
        """The next word, a whole number from 0."""
        word = self.read_word()
        if not re.fullmatch(rb"\d{1,18}", word):
            raise ValueError(tr("{text} is not a whole number").format(text=excerpt(word)))
        return int(word)

    def read_array(self, count: int, kind: bytes) -> LegacyArray:
        """The next numbers of a type."""
        name = _TYPES.get(kind.decode("ascii", "replace").lower())
        if name is None:
            raise ValueError(tr("{text} is not a type of numbers").format(text=excerpt(kind)))
        return self._bytes(count, np.dtype(">" + name)) if self._binary else self._text(count, name)

    def skip_values(self, count: int, kind: bytes) -> None:
        """Pass over the next values of a type, which may be texts or bits."""
        name = kind.lower()
        if name == b"string":
            self.position = self._behind_line()
            for _ in range(count):
                self._skip_text()
        elif name == b"bit":
            self.read_array(*((-(-count // 8), b"unsigned_char") if self._binary else (count, b"int")))
        else:
            self.read_array(count, kind)

    def _skip_text(self) -> None:
        """Pass over a line, or over bytes behind their number."""
        if self.position >= len(self.content):
            raise ValueError(tr("it ends early"))
        if not self._binary:
            self.position = self.content.find(b"\n", self.position) + 1 or len(self.content)
            return
        size = 8 >> (self.content[self.position] >> 6)  # of the number, by its first two bits
        number = int.from_bytes(self.content[self.position : self.position + size], "big")
        self.position += size + number % (1 << 8 * size - 2)

    def _behind_line(self) -> int:
        """Place behind the rest of a line without words."""
        space = _SPACE.match(self.content, self.position)
        assert space is not None  # it matches nothing, too
        return space.end()

    def _bytes(self, count: int, dtype: np.dtype) -> LegacyArray:
        start = self._behind_line()
        end = start + count * dtype.itemsize
        if end > len(self.content):
            raise ValueError(tr("it ends early"))
        self.position = end
        return LegacyArray(np.frombuffer(self.content, dtype, count, start), start, end, False)

    def _text(self, count: int, name: str) -> LegacyArray:
        if 2 * count > len(self.content) - self.position + 1:
            raise ValueError(tr("it ends early"))
        start = self.position
        if count:
            last = next(islice(_WORDS.finditer(self.content, start), count - 1, None), None)
            if last is None:
                raise ValueError(tr("it ends early"))
            self.position = last.end()
        values = text_values(self.content[start : self.position], name)
        return LegacyArray(values, start, self.position, True)

    def skip_metadata(self) -> tuple[int, int]:
        """Pass over what is said of an array; where that is."""
        if self.peek_word() != "METADATA":
            return self.position, self.position
        start = self.position
        self.read_word()
        found = _METADATA_END.search(self.content, self.position)
        assert found is not None  # the end of the file matches
        self.position = found.end()
        return start, self.position
