"""Values of an array in a text: read, and rewritten in place."""

from __future__ import annotations

import re

import numpy as np

from apd_viewer.files.formats.text import TextEdits, parse_numbers
from apd_viewer.language import tr

_WORD = re.compile(rb"\S+")


def text_values(text: bytes, kind: str) -> np.ndarray:
    """Values (k,) of a type such as ``i4``: whole, or in double precision.

    Raises
    ------
    ValueError
        If a word is no number, or none of its type.
    """
    found = parse_numbers(text.split())
    if kind[0] == "f":
        return found
    if not (np.abs(found) < 2.0**53).all() or (found != np.floor(found)).any():
        raise ValueError(tr("one of its arrays has no whole numbers"))
    return found.astype(np.int64)


def with_replaced_values(text: bytes, old: np.ndarray, new: np.ndarray) -> bytes:
    """Text with the ``new`` values (k,) where they differ from its ``old`` ones."""
    edits = TextEdits(text)
    edits.replace_numbers([word.span() for word in _WORD.finditer(text)], old, new)
    return edits.edited_content()
