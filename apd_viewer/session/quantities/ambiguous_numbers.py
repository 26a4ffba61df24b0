"""Ambiguous numbers, to be asked about and never guessed."""

from __future__ import annotations

import re

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.notation import editable_number, notation

# One thousand and more in some countries, one and a fraction in others.
_DOUBTFUL = re.compile(r"(?<![\w.,])[1-9][0-9]{0,2}([.,])[0-9]{3}(?![0-9.,eE])")


def check_unambiguous(text: str, signs: str) -> None:
    """Raise InputError on an ambiguous number with one of the ``signs``."""
    for found in _DOUBTFUL.finditer(text):
        if found[1] in signs:
            said, small = found[0], float(found[0].replace(",", "."))
            raise InputError(
                tr("“{text}” can mean {small} or {large}; write {small} or {large}.").format(
                    text=said, small=editable_number(f"{small:g}"), large=re.sub(r"[.,]", "", said)
                )
            )


def unambiguous_text(text: str) -> str:
    """A text from a field, with clear numbers; raises InputError.

    In some languages the window writes a point between groups of digits.
    """
    check_unambiguous(text, notation().group if notation().group == "." else "")
    return text
