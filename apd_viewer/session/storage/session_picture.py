"""The small picture of itself in a session file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.reading import opened
from apd_viewer.session.storage.session_errors import explained

if TYPE_CHECKING:
    from pathlib import Path

PICTURE = "picture.png"
PICTURE_SIDE = 256  # pixels at most: what file managers ask for


def picture_in(path: Path) -> bytes | None:
    """Content of the PNG file in a session; None if there is none.

    Raises
    ------
    InputError
        If the file cannot be read, or is no session.
    """
    with explained(path), opened(path) as stream:
        archive = Archive(stream)
        return archive.content(PICTURE) if archive.has(PICTURE) else None
