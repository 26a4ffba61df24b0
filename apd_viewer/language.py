"""The words of the program in the language of its user."""

from __future__ import annotations

import gettext
from pathlib import Path

_FOLDER = Path(__file__).parent / "languages"
_catalogue = gettext.translation("apd_viewer", _FOLDER, fallback=True)


def tr(text: str) -> str:
    """The ``text``, which is English, in the language of the user; as it is where that is not known.

    Values go into it afterwards: ``tr("{name} has no area.").format(name=...)``.
    """
    return _catalogue.gettext(text)
