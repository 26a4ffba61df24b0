"""Detection of external changes to files by their content.

Clocks may be wrong, so no time is compared with the current time or with another file's. A file rewritten
with the same content counts as unchanged.
"""

import hashlib
import os
import stat
from enum import Enum
from pathlib import Path
from typing import NamedTuple

from apd_viewer.files.samples import resource_path
from apd_viewer.files.storage.regular_files import open_regular_file


class FileState(Enum):
    """State of a known file; incomplete if a file it depends on is missing."""

    SAME = "same"
    CHANGED = "changed"
    GONE = "gone"
    INCOMPLETE = "incomplete"


class KnownFile:
    """File with a digest of its last known content, to detect external changes.

    Parameters
    ----------
    scratch : Path or None
        Scratch file with the new content, moved to the path later; None reads the path itself.

    Attributes
    ----------
    state : FileState
        State at the last check; only a reader of the format can find it incomplete.
    """

    def __init__(self, path: Path, scratch: Path | None = None) -> None:
        self.path = path
        self.state = FileState.SAME
        self._stamp = None if scratch is not None else file_stamp(path)
        self._content = _content(scratch or path)

    def check_content(self) -> FileState:
        """Compare the file with its known content; callable from any thread."""
        stamp = file_stamp(self.path)
        if stamp is None:
            self.state = FileState.GONE
        elif stamp == self._stamp or _content(self.path) == self._content:
            self._stamp, self.state = stamp, FileState.SAME
        else:
            self.state = FileState.CHANGED
        return self.state


def _content(path: Path) -> str | None:
    """Digest of a regular file; None for anything else."""
    return None if file_stamp(path) is None else fingerprint(path).sha256


def file_stamp(path: Path) -> tuple[int, ...] | None:
    """Metadata of a regular file, for detecting changes without reading it.

    It includes the inode's change time, which no tool can set.
    """
    try:
        found = os.stat(path)  # noqa: PTH116  # Path raises on names that are too long
    except (OSError, ValueError):
        return None
    if not stat.S_ISREG(found.st_mode):
        return None
    return found.st_size, found.st_mtime_ns, found.st_ctime_ns, found.st_ino, found.st_dev


_PORTION = 1 << 20  # bytes per read


class Fingerprint(NamedTuple):
    """Path, size and SHA-256 digest of a file.

    Attributes
    ----------
    place : str
        Path for display: paths in the home folder begin with ``~``, which hides the user's name.
    size : int or None
        Size in bytes; None for an unreadable file.
    sha256 : str
        Digest in hexadecimal; empty for an unreadable file.
    """

    place: str
    size: int | None
    sha256: str


def fingerprint(path: Path) -> Fingerprint:
    """Compute the fingerprint of a file in one read."""
    digest, size = hashlib.sha256(), 0
    try:
        with open_regular_file(path) as stream:
            while portion := stream.read(_PORTION):
                digest.update(portion)
                size += len(portion)
    except OSError:
        return Fingerprint(display_path(path), None, "")
    return Fingerprint(display_path(path), size, digest.hexdigest())


def display_path(path: Path) -> str:
    """Path of a file for display, relative to the home folder if inside it."""
    if resource_path("") in path.parents:
        return path.name
    try:
        return (Path("~") / path.absolute().relative_to(Path.home())).as_posix()
    except (ValueError, RuntimeError):  # outside the home folder, or no home folder
        return str(path.absolute())
