"""Files known by their content, and their fate since.

Clocks may be wrong, so no time is compared with now, nor with another file's. Where a tool has written the
same again, nothing has changed.
"""

from __future__ import annotations

import os
import stat
from enum import Enum
from pathlib import Path

from apd_viewer.files.fingerprint import fingerprint


class FileState(Enum):
    """State of a known file; incomplete without another one it needs."""

    SAME = "same"
    CHANGED = "changed"
    GONE = "gone"
    INCOMPLETE = "incomplete"


class KnownFile:
    """A file with its content when it was read or written here.

    Parameters
    ----------
    path : Path
    scratch : Path or None
        What is about to be moved there; None takes what is there.

    Attributes
    ----------
    path : Path
    state : FileState
        By the last look; whoever knows its format says whether it is incomplete.
    """

    def __init__(self, path: Path, scratch: Path | None = None) -> None:
        self.path = path
        self.state = FileState.SAME
        self._stamp = None if scratch is not None else file_stamp(path)
        self._content = _content(scratch or path)

    def check_content(self) -> FileState:
        """Compare the file with the known content; on any thread."""
        stamp = file_stamp(self.path)
        if stamp is None:
            self.state = FileState.GONE
        elif stamp == self._stamp or _content(self.path) == self._content:
            self._stamp, self.state = stamp, FileState.SAME
        else:
            self.state = FileState.CHANGED
        return self.state


def _content(path: Path) -> str | None:
    """Digest of a regular file; nothing else is opened."""
    return None if file_stamp(path) is None else fingerprint(path).sha256


def file_stamp(path: Path) -> tuple[int, ...] | None:
    """Marks of a regular file; unchanged, they spare reading it.

    The time of the last change of its entry, which no tool can set, is among them.
    """
    try:
        found = os.stat(path)  # noqa: PTH116  # Path raises on names that are too long
    except (OSError, ValueError):
        return None
    if not stat.S_ISREG(found.st_mode):
        return None
    return found.st_size, found.st_mtime_ns, found.st_ctime_ns, found.st_ino, found.st_dev
