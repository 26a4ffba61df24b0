"""The small picture of itself in a session file."""

from __future__ import annotations

from pathlib import Path

from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.regular_files import open_regular
from apd_viewer.session.storage.session_errors import explaining_errors

PICTURE_MEMBER = "picture.png"
PICTURE_SIDE = 256  # pixels at most: what file managers ask for


def session_picture(path: Path) -> bytes | None:
    """Content of the PNG file in a session; None if there is none.

    Raises
    ------
    InputError
        If the file cannot be read, or is no session.
    """
    with explaining_errors(path), open_regular(path) as stream:
        archive = Archive(stream)
        return archive.content(PICTURE_MEMBER) if archive.has_member(PICTURE_MEMBER) else None
